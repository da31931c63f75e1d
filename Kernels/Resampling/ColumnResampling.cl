// SPDX-License-Identifier: BSD-3-Clause
// Mapping and resampling in one, for devices whose work-items are lanes, such as graphics cards. It gives the same
// voxels as the kernels for processors (BrickResampling.cl).
//
// A work-group takes a section of a brick, layer by layer, an item a column of cells of it. Two planes of vertices are
// in local memory, and a third one, so that some items may map the next plane while others still read these. Neighbours
// along x write voxels that mostly lie side by side. Most cells have a sample or none. Cells that are boxes, as where
// nothing is deformed, own what is within their bounds.
// What few cells need would keep registers from all others, and most of a group waiting: so cells are left for later
// that have samples which floats do not decide, or very many, and boxes on the border of the mesh. ResampleLeft takes
// these. Cells that are bent or large, that a cut divides, or of which tetrahedra may be missing, go into a queue for
// ResampleQueued (QueuedResampling.cl), as does what ResampleLeft cannot do.
//
// Why samples that floats do not decide do not go into a list that the group takes after each layer: some eight of 256 cells have one,
// one warp has all of them, and the others wait.

// Of cells with more candidates each takes all lanes as long as the longest of them: they are left for later.
#define MOST_CANDIDATES_IN_COLUMN 64

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

// The section of a brick that a group takes, or one of a brick that has none to be run, for a group that only fills the
// launch. What can be found from the number of the group is not kept in registers.
static uint BrickOfGroup(__global const uint* bricks, const KernelParameters* p)
{
  const int place = p->ListBegin + (int)(get_group_id(0) / DEFORMVOLUME_SPANS);
  return place < p->ListEnd ? bricks[place] : 0;
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

// A cell of a group as the queue numbers it. cell: its place in a layer.
static uint NumberInLaunch(int cell, int layer)
{
  const int3 first = FirstInBrick();
  return get_group_id(0) / DEFORMVOLUME_SPANS * CELLS_OF_BRICK +
    ((first.z + layer) * DEFORMVOLUME_BRICK_Y + first.y + cell / ROW_CELLS) * DEFORMVOLUME_BRICK_X +
    first.x + cell % ROW_CELLS;
}

// left: what is still to be done with a cell that columns have looked at, or that they must not.
static void LeaveForLater(__global uint* queue, uint cell, int left, const KernelParameters* p)
{
  const uint entry = MakeEntry(cell, left);
  if (left == QUEUE_INTEGERS || (left == QUEUE_FLOATS && !p->HasState))
  {
    LEFT_ENTRY(queue, atomic_inc(queue + 1), p) = entry;
  }
  else
  {
    QUEUE_ENTRIES(queue)[atomic_inc(queue)] = entry;
  }
}

// Whether floats can tell something of a cell, and what is to be done with it else. any: the flags of all its vertices;
// lowest: of the one that it begins at.
#define SORT_BY_FLOATS -2

static int SortCell(uint any, uint lowest)
{
  if (any & FLAG_OUTSIDE)
  {
    return CELL_DONE;
  }
  if (any & FLAG_SPECIAL)
  {
    return QUEUE_UNSURE;
  }
  return any & FLAG_APART || (any & FLAG_BORDER && !(lowest & FLAG_WHOLE)) ? QUEUE_FLOATS
                                                                           : SORT_BY_FLOATS;
}

// Bricks of a list from p.ListBegin to p.ListEnd, a group a section: on x the spans of one brick after the other, on y
// and z the halves.
__kernel void ResampleColumns(GIVEN_PARAMETERS, __global const uint* bricks, __global uint* queue,
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
  const int endZ = IsSectionRun(brick, SectionOfGroup(brick)) && beginZ < p.LayersEnd
    ? min(first.z + CELL_LAYERS, p.LayersEnd)
    : beginZ - 1;
  const SamplingMesh mesh = GIVEN_MESH;
  Output output = GIVEN_OUTPUT;
  for (int i = get_local_id(0); i < DEFORMVOLUME_COUNTERS; i += get_local_size(0))
  {
    counts[i] = 0;
  }
  int low = 2, high = 0; // where the last plane and the next one lie
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
    // The vertices of a cell have their numbers by the parity of their structured indices.
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
      int left = SortCell(any, f[0]);
      if (left == SORT_BY_FLOATS)
      {
        GroupCandidates c;
        MakeCellGroup(rows + (even * ROWS + inY + (inY & 1)) * ROW + (inX >> 1),
          inY & 1 ? -ROW : ROW, toOdd, inX & 1, first.x + inX, first.y + inY, z - 1, any, &c.Cells,
          &p);
        GroupFrame frame;
        left = ResampleColumnCell(
          &c, MOST_CANDIDATES_IN_COLUMN, 0, &frame, 0, 0, &output, &p ARRAY_ARGUMENTS);
      }
      if (left != CELL_DONE)
      {
        LeaveForLater(queue, NumberInLaunch(i, z - 1 - first.z), left, &p);
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

// What columns leave of cells that are not for ResampleQueued, a cell a work-item. The host does not know how many there
// are.
__kernel void ResampleLeft(GIVEN_PARAMETERS, __global const uint* bricks, __global uint* queue,
  __local float* rows, const KernelParameters parameters ARRAY_PARAMETERS)
{
  KernelParameters p = parameters;
#if PASS_IS_DIRECT
  p.Pass = DEFORMVOLUME_PASS_DIRECT;
#endif
  const SamplingMesh mesh = GIVEN_MESH;
  const uint entries = queue[1];
  for (uint i = get_global_id(0); i < entries; i += get_global_size(0))
  {
    const uint entry = LEFT_ENTRY(queue, i, &p);
    const int3 cell = CellOfEntry(entry, bricks, &p);
    GroupCandidates c;
    MapCell(&mesh, cell.x, cell.y, cell.z, PlaceOfItem(rows), &c.Cells, &p ARRAY_ARGUMENTS);
    Output output = GIVEN_OUTPUT;
    GroupFrame frame;
    const int left = ResampleColumnCell(&c, MAXIMUM_CANDIDATES, 0, &frame, 1,
      entry >> QUEUE_BITS == QUEUE_INTEGERS, &output, &p ARRAY_ARGUMENTS);
    LEFT_ENTRY(queue, i, &p) =
      MakeEntry(CellOf(entry), left == CELL_DONE ? QUEUE_INTEGERS : left);
    AddCounts(&output, SectionOf(cell.x, cell.y, cell.z, &p), counters, &p);
  }
}
