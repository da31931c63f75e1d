// SPDX-License-Identifier: BSD-3-Clause
// Mapping and resampling in one kernel, for devices whose work-items are lanes, such as GPUs. The result has the same
// voxels as that of the CPU kernels (BrickResampling.cl).
//
// A work-group handles a section of a brick layer by layer; each work-item takes columns of cells. Local memory has
// two planes of vertices, and a third one, so that some items can map the next plane while others still read these
// two. Neighbors along x mostly write neighboring voxels. Most cells have one sample or none. Aligned cells, for
// example where nothing is deformed, own all samples within their bounds.
//
// Work that few cells need would take registers from all others and keep most of a group waiting. So cells are
// deferred if floats do not decide one of their samples, if they have very many samples, or if they are aligned cells
// at the border of the sampling mesh. ResampleDeferredInt32 handles these. Cells that are bent or large, that a cut
// divides, or that may lack tetrahedra are deferred to ResampleDeferredInt64 (DeferredResampling.cl), as are cells that
// ResampleDeferredInt32 cannot finish.
//
// The work-group does not handle undecided samples itself after each layer: about eight of 256 cells have one, and
// one warp would handle all of them while the others wait.

// A cell with more candidates is deferred: all lanes would wait for it.
#define MAXIMUM_CANDIDATES_IN_COLUMN 64

// Adds the counts of a work-item to those of its group.
static void AddToGroup(const Output* output, __local uint* counts)
{
  const uint mine[DEFORMVOLUME_COUNTERS] = COUNTS_OF(output);
  UNROLLED
  for (int i = 0; i < DEFORMVOLUME_COUNTERS; ++i)
  {
    if (mine[i])
    {
      atomic_add(counts + i, mine[i]);
    }
  }
}

// Returns the brick of a work-group; for padding of the launch, a brick without sections to resample. Values that
// follow from the group's number are computed again to save registers.
static uint BrickOfGroup(__global const uint* bricks, const KernelParameters* p)
{
  const int index = p->ListBegin + (int)(get_group_id(0) / DEFORMVOLUME_SPANS);
  return index < p->ListEnd ? bricks[index] : 0;
}

static size_t SectionOfGroup(uint brick)
{
  return DEFORMVOLUME_SECTIONS * (size_t)(brick & ((1u << DEFORMVOLUME_BRICK_BITS) - 1)) +
    (get_group_id(2) * 2 + get_group_id(1)) * DEFORMVOLUME_SPANS +
    get_group_id(0) % DEFORMVOLUME_SPANS;
}

static int3 FirstInBrick()
{
  return (int3)((int)(get_group_id(0) % DEFORMVOLUME_SPANS) * ROW_CELLS,
    (int)get_group_id(1) * CELL_ROWS, (int)get_group_id(2) * CELL_LAYERS);
}

// Returns the number of a cell of a group among the cells of the launch. cell: its index in the layer.
static uint NumberInLaunch(int cell, int layer)
{
  const int3 first = FirstInBrick();
  return get_group_id(0) / DEFORMVOLUME_SPANS * CELLS_OF_BRICK +
    ((first.z + layer) * DEFORMVOLUME_BRICK_Y + first.y + cell / ROW_CELLS) * DEFORMVOLUME_BRICK_X +
    first.x + cell % ROW_CELLS;
}

// Adds a cell to the list of deferred cells. step: the next step of the exactness chain for this cell.
static void Defer(__global uint* deferred, uint cell, int step, const KernelParameters* p)
{
  const uint entry = MakeEntry(cell, step);
  if (step == DEFERRED_INT32 || (step == DEFERRED_FLOATS && !p->HasState))
  {
    ENTRY_INT32(deferred, atomic_inc(deferred + 1), p) = entry;
  }
  else
  {
    ENTRIES_INT64(deferred)[atomic_inc(deferred)] = entry;
  }
}

// Returns whether floats can be tried for a cell (SORT_BY_FLOATS), or else the next step. any: the flags of all of
// its vertices. lowest: the flags of its lowest vertex.
#define SORT_BY_FLOATS -2

static int SortCell(uint any, uint lowest)
{
  if (any & FLAG_OUTSIDE)
  {
    return CELL_DONE;
  }
  if (any & FLAG_SPECIAL)
  {
    return DEFERRED_CELL_INT64;
  }
  return any & FLAG_SPLIT || (any & FLAG_BORDER && !(lowest & FLAG_WHOLE)) ? DEFERRED_FLOATS
                                                                           : SORT_BY_FLOATS;
}

// Resamples the bricks of a list from p.ListBegin to p.ListEnd, one section for each work-group. Groups on x are the
// spans of all bricks; groups on y and z are the halves.
__kernel void ResampleColumns(GIVEN_PARAMETERS, __global const uint* bricks, __global uint* deferred,
  __local float* rows, const KernelParameters parameters ARRAY_PARAMETERS)
{
  KernelParameters p = parameters;
#if PASS_IS_DIRECT
  p.Pass = DEFORMVOLUME_PASS_DIRECT;
#endif
  __local uchar flags[3 * PLANE_VERTICES];
  __local uint counts[DEFORMVOLUME_COUNTERS];
  const uint brick = BrickOfGroup(bricks, &p);
  const int3 first = FirstOfBrick(brick, &p) + FirstInBrick();
  const int beginZ = max(first.z, p.LayersBegin);
  const int endZ = IsSectionResampled(brick, SectionOfGroup(brick)) && beginZ < p.LayersEnd
    ? min(first.z + CELL_LAYERS, p.LayersEnd)
    : beginZ - 1;
  const SamplingMesh mesh = GIVEN_MESH;
  Output output = GIVEN_OUTPUT;
  for (int i = get_local_id(0); i < DEFORMVOLUME_COUNTERS; i += get_local_size(0))
  {
    counts[i] = 0;
  }
  int low = 2, high = 0; // indices of the last plane and of the next one
  for (int z = beginZ; z <= endZ; ++z)
  {
    for (int i = get_local_id(0); i < PLANE_VERTICES; i += get_local_size(0))
    {
      const int inX = i % (ROW_CELLS + 1), inY = i / (ROW_CELLS + 1);
      const int x = first.x + inX, y = first.y + inY;
      flags[high * PLANE_VERTICES + i] = x >= 0 && y >= 0 && x < p.Size[0] && y < p.Size[1]
        ? MapVertex(&mesh, x, y, z,
            rows + (high * ROWS + inY) * ROW + (inX >> 1) + (inX & 1 ? ODD : 0), &p ARRAY_ARGUMENTS)
        : FLAG_OUTSIDE;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    // Vertices of a cell are numbered by the parity of their structured indices.
    const int isLowOdd = (p.First[2] + z - 1) & 1;
    const int even = isLowOdd ? high : low;
    const int toOdd = (isLowOdd ? low - high : high - low) * (ROWS * ROW);
    for (int i = get_local_id(0); i < (z > beginZ ? ROW_CELLS * CELL_ROWS : 0);
         i += get_local_size(0))
    {
      const int inX = i % ROW_CELLS, inY = i / ROW_CELLS;
      __local const uchar* const f = flags + low * PLANE_VERTICES + inY * (ROW_CELLS + 1) + inX;
      __local const uchar* const g = f + (high - low) * PLANE_VERTICES;
      const int up = ROW_CELLS + 1;
      const uint any = f[0] | f[1] | f[up] | f[up + 1] | g[0] | g[1] | g[up] | g[up + 1];
      int step = SortCell(any, f[0]);
      if (step == SORT_BY_FLOATS)
      {
        PacketCandidates c;
        MakeCellPacket(rows + (even * ROWS + inY + (inY & 1)) * ROW + (inX >> 1),
          inY & 1 ? -ROW : ROW, toOdd, inX & 1, first.x + inX, first.y + inY, z - 1, any, &c.Cells,
          &p);
        PacketFrame frame;
        step = ResampleColumnCell(
          &c, MAXIMUM_CANDIDATES_IN_COLUMN, 0, &frame, 0, 0, &output, &p ARRAY_ARGUMENTS);
      }
      if (step != CELL_DONE)
      {
        Defer(deferred, NumberInLaunch(i, z - 1 - first.z), step, &p);
      }
    }
    low = high;
    high = high == 2 ? 0 : high + 1;
  }
  AddToGroup(&output, counts);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = get_local_id(0); i < DEFORMVOLUME_COUNTERS; i += get_local_size(0))
  {
    AddCount(i, counts[i], SectionOfGroup(BrickOfGroup(bricks, &p)), counters, &p);
  }
}

// Resamples the deferred cells that are not for ResampleDeferredInt64, one for each work-item. The host does not know
// their number.
__kernel void ResampleDeferredInt32(GIVEN_PARAMETERS, __global const uint* bricks, __global uint* deferred,
  __local float* rows, const KernelParameters parameters ARRAY_PARAMETERS)
{
  KernelParameters p = parameters;
#if PASS_IS_DIRECT
  p.Pass = DEFORMVOLUME_PASS_DIRECT;
#endif
  const SamplingMesh mesh = GIVEN_MESH;
  const uint entries = deferred[1];
  for (uint i = get_global_id(0); i < entries; i += get_global_size(0))
  {
    const uint entry = ENTRY_INT32(deferred, i, &p);
    const int3 cell = CellOfEntry(entry, bricks, &p);
    PacketCandidates c;
    MapCell(&mesh, cell.x, cell.y, cell.z, SlotOfItem(rows), &c.Cells, &p ARRAY_ARGUMENTS);
    Output output = GIVEN_OUTPUT;
    PacketFrame frame;
    const int step = ResampleColumnCell(&c, MAXIMUM_CANDIDATES, 0, &frame, 1,
      entry >> DEFERRED_BITS == DEFERRED_INT32, &output, &p ARRAY_ARGUMENTS);
    ENTRY_INT32(deferred, i, &p) =
      MakeEntry(CellOf(entry), step == CELL_DONE ? DEFERRED_INT32 : step);
    AddCounts(&output, SectionOf(cell.x, cell.y, cell.z, &p), counters, &p);
  }
}
