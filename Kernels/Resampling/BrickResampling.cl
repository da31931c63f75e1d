// SPDX-License-Identifier: BSD-3-Clause
// Mapping and resampling in one kernel, for CPUs. A work-item takes a brick of cells. LANES cells of a row are in the
// lanes of vector registers. The result has the same voxels as that of Resampling.cl. Cells, or samples of large
// cells, that floats and 32-bit integers do not decide are handed to ResampleCell.
//
// Design: compilers do not vectorize kernels with data-dependent loops over candidates, so the lanes are written out.
// Vertices are mapped plane by plane as cells need them, and stay in the inner caches: two planes of a brick with 17
// rows each. A plane is mapped completely before the cells below it are resampled: neighboring rows use the same
// tetrahedra, which are then still in the innermost cache. A row is split into even and odd vertices. Cells of equal
// parity, every second one of a row, form a packet, so that all lanes have the same 5T split. Each lane visits its own
// candidates, until all lanes are finished.
//
// Data: links 16 bytes per voxel (or runs, or a field), state 1 byte, the arrays in their own types; rows of vertices
// from BrickMapping.cl. This text comes after PacketResampling.cl.
//
// The host defines before this text, in addition to the macros of Resampling.cl:
//   ROWS_ARE_GLOBAL      1 if ROW_MEMORY (PacketVertices.cl) is __global, else 0

// Removes the cells of a packet that have a value that IS_SPECIAL from Simple and WithCandidates, so that ResampleCell takes them.
// The values are tested again because a flag of a row is for eight vertices, and depends on where the mapped part of
// the row begins and ends.
static COLD void ExcludeSpecials(PacketCandidates* c)
{
  const Packet* const packet = &c->Cells;
  INTS special = 0;
#define FIND_SPECIALS(index, TYPE, BITS, SLOT)                                                     \
  for (int v = 0; BITS == 32 && v < 8; ++v)                                                        \
  {                                                                                                \
    const INTS bits = AS_INTS(VERTEX(v, 3 + SLOT));                                                \
    special |= IS_SPECIAL(bits);                                                                   \
  }
  LANE_ARRAYS(FIND_SPECIALS)
  const uint others = ~LaneBits(special);
  c->Simple &= others;
  c->WithCandidates &= others;
}

// Resamples a packet of a row, of which the cells from beginX to endX are wanted. special: whether vertices of the
// packet, or near it, may have values that are IS_SPECIAL.
static __attribute__((always_inline)) void ResampleCells(PacketCandidates* c, int special,
  int beginX, int endX, const SamplingMesh* mesh, Output* output, Found* found,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  if (c->Skip)
  {
    return;
  }
  if (special)
  {
    ExcludeSpecials(c);
  }
  UndecidedSamples undecidedSamples;
  const Outcome outcome = ResampleByFloats(c, mesh, output, found, &undecidedSamples, p ARRAY_ARGUMENTS);
  uint needsInt64 = outcome.NeedsInt64;
  if (outcome.SamplesNeedInt64)
  {
    ResampleUndecided(c, &undecidedSamples, outcome.SamplesNeedInt64, beginX, endX, mesh, output, p ARRAY_ARGUMENTS);
  }
  if (outcome.NeedsInt32)
  {
    needsInt64 |= ResampleByIntegers(c, outcome.NeedsInt32, mesh, output, found, p ARRAY_ARGUMENTS);
  }
  if (needsInt64)
  {
    // The cells in needsInt64 write all of their samples again, which must come after the samples found before.
    StoreFound(found, &c->Cells, output, p ARRAY_ARGUMENTS);
  }
  const Candidates all = AllCandidates(p);
  FOR_EACH_LANE(lane, needsInt64)
  {
    const int cell = c->Cells.X + 2 * lane;
    if (cell >= beginX && cell < endX)
    {
      Neighbors near;
      const SamplingMesh keeping = KeepNeighbors(mesh, cell, c->Cells.Y, c->Cells.Z, &near);
      ResampleCell(&keeping, cell, c->Cells.Y, c->Cells.Z, &all, output, p ARRAY_ARGUMENTS);
    }
  }
}

// Resamples the packets of a row of cells, from slot `begin` to before slot `end`. beginX, endX: the wanted cells.
// specials: as in RowFlags. outputs: one for each span of the brick.
static void ResampleRow(const RowOfCells* row, int begin, int end, int beginX, int endX,
  uint specials, const SamplingMesh* mesh, Output* outputs, Found* found,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  PacketCandidates candidates[2][2]; // of this slot and of the next packets
  Bounds even;
  BoundQuads(row->Rows, begin, &even);
  FindPairCandidates(row, begin, &even, mesh, OUTPUT_OF_SPAN(outputs, begin), candidates[0],
    p ARRAY_ARGUMENTS);
  for (int k = begin, buffer = 0; k < end; k += LANES, buffer ^= 1)
  {
    Output* const output = OUTPUT_OF_SPAN(outputs, k);
    const int special = (specials & PACKET_FLAGS(k)) != 0;
    PacketCandidates* const here = candidates[buffer];
    FetchOutput(here + 1, output ARRAY_ARGUMENTS);
    ResampleCells(here, special, beginX, endX, mesh, output, found, p ARRAY_ARGUMENTS);
    const int next = k + LANES;
    if (next < end)
    {
      FindPairCandidates(row, next, &even, mesh, OUTPUT_OF_SPAN(outputs, next), candidates[!buffer],
        p ARRAY_ARGUMENTS);
      FetchOutput(candidates[!buffer], output ARRAY_ARGUMENTS);
    }
    ResampleCells(here + 1, special, beginX, endX, mesh, output, found, p ARRAY_ARGUMENTS);
  }
}

// The range of cells of a brick on y or z: it begins at 0 or in the middle, and ends in the middle or at the end.
// halves: index of the bit of the lower half.
static int BeginIn(uint item, int halves, int cells)
{
  return item >> halves & 1 ? 0 : cells / 2;
}

static int EndIn(uint item, int halves, int cells)
{
  return item >> halves & 2 ? cells : cells / 2;
}

// A brick, or some of its sections.
typedef struct
{
  int X, Y, Z; // index of the brick's first cell, which may lie before the volume
  // The cells to resample.
  int BeginX, BeginY, BeginZ;
  int EndX, EndY, EndZ;
} BrickCells;

// item: the brick and its sections (DEFORMVOLUME_BRICK_BITS).
static void FindCells(uint item, BrickCells* cells, const KernelParameters* p)
{
  const int3 first = FirstOfBrick(item, p);
  const int x = first.x;
  const int y = first.y;
  const int z = first.z;
  const uint spans = item >> DEFORMVOLUME_BRICK_BITS & ((1u << DEFORMVOLUME_SPANS) - 1);
  const int firstSpan = 31 - clz(spans & -spans);
  const int endSpan = 32 - clz(spans);
  const int halvesY = DEFORMVOLUME_BRICK_BITS + DEFORMVOLUME_SPANS;
  const int halvesZ = halvesY + 2;
  cells->X = x;
  cells->Y = y;
  cells->Z = z;
  cells->BeginX = max(x + firstSpan * DEFORMVOLUME_SPAN, 0);
  cells->EndX = min(x + endSpan * DEFORMVOLUME_SPAN, p->Size[0] - 1);
  cells->BeginY = max(y + BeginIn(item, halvesY, DEFORMVOLUME_BRICK_Y), 0);
  cells->EndY = min(y + EndIn(item, halvesY, DEFORMVOLUME_BRICK_Y), p->Size[1] - 1);
  cells->BeginZ = max(z + BeginIn(item, halvesZ, DEFORMVOLUME_BRICK_Z), p->LayersBegin);
  cells->EndZ = min(z + EndIn(item, halvesZ, DEFORMVOLUME_BRICK_Z), p->LayersEnd);
}

// The memory of a work-item for the rows of a brick.
typedef struct
{
  // The part of the rest positions that depends on x, for even, then for odd vertices (REST_ODD).
  ROW_MEMORY float* RestX;
  ROW_MEMORY float* Displaced; // used by BeginRow
  ROW_MEMORY float* Planes; // two planes of vertices, used alternately
  RowFlags (*Flags)[ROWS];  // of the rows of these planes
} BrickMemory;

// Prepares a brick: sets the rest positions that depend on x, and marks all slots as NO_VERTEX. x: index of the brick's
// first cell.
static void ClearBrick(
  const SamplingMesh* mesh, int x, const BrickMemory* memory, const KernelParameters* p)
{
  for (int i = 0; i < 2 * HALF_ROW; ++i)
  {
    const int vertex = clamp(x + i, 0, p->Size[0] - 1);
    ROW_MEMORY float* rest = memory->RestX + (i >> 1) + (i & 1 ? REST_ODD : 0);
#if HAS_TURNED_AXES
    for (int axis = 0; axis < 3; ++axis)
    {
      ((ROW_MEMORY int*)rest)[2 * axis * HALF_ROW] =
        mesh->Map.Rest[vertex].Whole[axis] - p->OutputFirst[axis] * 256;
      rest[(2 * axis + 1) * HALF_ROW] = mesh->Map.Rest[vertex].Fraction[axis] * STEP;
    }
#else
    rest[0] = (mesh->Map.Rest[vertex].Whole - p->OutputFirst[0] * 256) * STEP;
    rest[HALF_ROW] = mesh->Map.Rest[vertex].Fraction * STEP;
#endif
  }
  for (int row = 0; row < 2 * ROWS; ++row)
  {
    for (int i = 0; i < HALF_ROW; ++i)
    {
      memory->Planes[row * ROW + i] = NO_VERTEX;
      memory->Planes[row * ROW + ODD + i] = NO_VERTEX;
    }
  }
}

// Maps the vertices of a brick's cells in a plane.
static void MapPlane(const SamplingMesh* mesh, const BrickCells* cells, int z,
  const BrickMemory* memory, const KernelParameters* p ARRAY_PARAMETERS)
{
  const int plane = (p->First[2] + z) & 1;
  for (int y = cells->BeginY; y <= cells->EndY; ++y)
  {
    const int row = y - cells->Y;
    memory->Flags[plane][row] = MapRow(mesh, cells->BeginX, cells->EndX + 1,
      cells->BeginX - cells->X, y, z, memory->Planes + (plane * ROWS + row) * ROW, memory->RestX,
      memory->Displaced, p ARRAY_ARGUMENTS);
  }
}

// Resamples the cells of a brick above a plane. outputs: one for each section of the brick.
static void ResampleLayer(const SamplingMesh* mesh, const BrickCells* cells, int z,
  const BrickMemory* memory, Output* outputs, Found* found,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const int begin = (cells->BeginX - cells->X) >> 1 & ~(LANES - 1);
  const int end = (cells->EndX - cells->X + 1) >> 1;
  // Rows and planes are stored by the parity of their structured y and z.
  for (int y = cells->BeginY; y < cells->EndY; ++y)
  {
    const int low = y - cells->Y;
    const RowFlags* const f[4] = { memory->Flags[0] + low, memory->Flags[0] + low + 1,
      memory->Flags[1] + low, memory->Flags[1] + low + 1 };
    RowOfCells row;
    for (int r = 0; r < 4; ++r)
    {
      const int vertexRow = r >> 1 ? low + 1 - (low & 1) : low + (low & 1);
      row.Rows[r] = memory->Planes + ((r & 1) * ROWS + vertexRow) * ROW;
    }
    row.X = cells->X;
    row.Y = y;
    row.Z = z;
    row.Parity = (p->First[1] + y + p->First[2] + z + p->IsMirrored) & 1;
    row.Borders = f[0]->Border | f[1]->Border | f[2]->Border | f[3]->Border;
#if HAS_CUT
    row.Split = f[0]->Split | f[1]->Split | f[2]->Split | f[3]->Split;
#else
    row.Split = 0;
#endif
    const uint specials = f[0]->Special | f[1]->Special | f[2]->Special | f[3]->Special;
    const int quarter =
      (low >= DEFORMVOLUME_BRICK_Y / 2) + 2 * (z - cells->Z >= DEFORMVOLUME_BRICK_Z / 2);
    ResampleRow(&row, begin, end, cells->BeginX, cells->EndX, specials, mesh,
      outputs + quarter * DEFORMVOLUME_SPANS, found, p ARRAY_ARGUMENTS);
  }
}

// Resamples a brick of cells, or some of its sections. item: as for FindCells. isAbove: whether this is the whole
// brick directly above the previous one, so that memory already has its first plane of vertices and flags. (Lists
// have no bricks without cells.) empty: an output with counts of 0.
static void ResampleBrick(const SamplingMesh* mesh, uint item, int isAbove, const Output* empty,
  __global uint* counters, const BrickMemory* memory, const KernelParameters* p ARRAY_PARAMETERS)
{
  BrickCells cells;
  FindCells(item, &cells, p);
  if (cells.BeginX >= cells.EndX || cells.BeginY >= cells.EndY || cells.BeginZ >= cells.EndZ)
  {
    return;
  }
  Output outputs[DEFORMVOLUME_SECTIONS];
  for (int section = 0; section < DEFORMVOLUME_SECTIONS; ++section)
  {
    outputs[section] = *empty;
  }
  Found found;
  found.Count = 0;
  if (!isAbove)
  {
    ClearBrick(mesh, cells.X, memory, p);
  }
  // Compilers inline MapPlane if there is a single call. That saves one percent of all instructions.
  for (int z = isAbove ? cells.BeginZ + 1 : cells.BeginZ; z <= cells.EndZ; ++z)
  {
    MapPlane(mesh, &cells, z, memory, p ARRAY_ARGUMENTS);
    if (z > cells.BeginZ)
    {
      ResampleLayer(mesh, &cells, z - 1, memory, outputs, &found, p ARRAY_ARGUMENTS);
    }
  }
  StoreFound(&found, 0, outputs, p ARRAY_ARGUMENTS);
  const uint brick = item & ((1u << DEFORMVOLUME_BRICK_BITS) - 1);
  for (int section = 0; section < DEFORMVOLUME_SECTIONS; ++section)
  {
    AddCounts(outputs + section, DEFORMVOLUME_SECTIONS * (size_t)brick + section, counters, p);
  }
}

// As GetBrickMemory (ResamplingProgram.cxx); change both.
#define BRICK_FLOATS (2 * REST_ODD + 3 * ROW_SLOTS + 2 * ROWS * ROW)

// Resamples the bricks of a list from p.ListBegin to p.ListEnd. taken: the number of bricks that work-items have
// taken so far; initially 0. rows: BRICK_FLOATS floats; in global memory, for each work-item.
//
// Each work-item takes a few bricks at a time (p.Portion). If drivers distributed the bricks, a thread would get many
// at once, and a thread that was interrupted, or that has more work, would delay the end of the launch.
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void ResampleBricks(GIVEN_PARAMETERS,
  __global const uint* bricks, __global uint* taken, ROW_MEMORY float* rows, const KernelParameters p ARRAY_PARAMETERS)
{
#if ROWS_ARE_GLOBAL
  rows += get_global_id(0) * BRICK_FLOATS;
#endif
  const SamplingMesh mesh = GIVEN_MESH;
  const Output empty = GIVEN_OUTPUT;
  RowFlags flags[2][ROWS];
  ROW_MEMORY float* const displaced = rows + 2 * REST_ODD;
  const BrickMemory memory = { rows, displaced, displaced + 3 * ROW_SLOTS, flags };
  for (uint begin = p.ListBegin + atomic_add(taken, p.Portion); begin < p.ListEnd;
       begin = p.ListBegin + atomic_add(taken, p.Portion))
  {
    const uint end = min(begin + p.Portion, (uint)p.ListEnd);
    for (uint i = begin; i < end; ++i)
    {
      const uint above = i > begin ? bricks[i - 1] + p.BrickCount[0] * p.BrickCount[1] : 0;
      const int isAbove =
        bricks[i] == above && above >> DEFORMVOLUME_BRICK_BITS == DEFORMVOLUME_WHOLE_BRICK;
      ResampleBrick(&mesh, bricks[i], isAbove, &empty, counters, &memory, &p ARRAY_ARGUMENTS);
    }
  }
}
