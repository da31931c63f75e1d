// SPDX-License-Identifier: BSD-3-Clause
// Mapping and resampling in one, for devices whose work-items are lanes, such as graphics cards. It gives the same
// voxels as the kernels for processors (BrickResampling.cl), whose decisions by floats and by integers of 32 bits it
// shares, a cell a work-item.
//
// A work-group takes a section of a brick, layer by layer, an item a column of cells of it. Two planes of vertices are
// in local memory; all items map the next one together. Neighbours along x write voxels that mostly lie side by side.
// What few cells need would keep registers from all others, and most of a group waiting: cells on the border of
// the mesh, bent or large ones and those that a cut divides go into a queue, which ResampleQueued takes after that.
// Most cells have a sample or none. Cells that are boxes, as where nothing is deformed, own what is within their bounds.
// Samples that floats do not decide are put into a list in local memory, and when all cells of a layer have been
// seen, the group takes what is in that, a sample an item: so no item waits for another one's integers, and neither
// kind of arithmetic has registers where the other one works.
//
// What the host puts in front of this text:
//   HAS_COLUMN_KERNEL  1 for ResampleColumns, 0 for ResampleQueued
//   PASS_IS_DIRECT     1 where the pass of ResampleColumns is known to be the direct one, which costs fewer registers
//
// Data: as BrickResampling.cl. It comes after GroupWalk.cl. queue: the number of entries, then the entries
// (QUEUE_...). rows: ROW floats for each row of two planes.

#define PLANE_VERTICES ((ROW_CELLS + 1) * ROWS)
#define FLAG_BORDER 1  // a vertex that is not interior
#define FLAG_SPECIAL 2 // one with a value that sums of products do not give back bit for bit
#define FLAG_APART 4   // one that lies elsewhere as seen from the other side of a smooth cut
#define FLAG_OUTSIDE 8 // a place beyond the volume

// Of cells with more candidates each takes all lanes as long as the longest of them: they go into the queue.
#define MOST_CANDIDATES_IN_COLUMN 64

// An entry of the queue: the place in the launch's part of the list of bricks, times the cells of a brick, plus the
// cell in the brick, and above that what is to be done.
#define CELLS_OF_BRICK (DEFORMVOLUME_BRICK_X * DEFORMVOLUME_BRICK_Y * DEFORMVOLUME_BRICK_Z)
#define QUEUE_BITS 30
#define QUEUE_FLOATS 0 // the cell is resampled as a group is
#define QUEUE_DOUBTS 1 // it has been, but for samples that floats do not decide: these, by ResampleSamples
#define QUEUE_UNSURE 2 // by ResampleCell
#define QUEUE_INTEGERS 3 // as with QUEUE_DOUBTS, but by integers of 32 bits: there was no room in the list

// Samples that floats have not decided, of a layer of a group: the cell, and above LISTED_BITS the number of the candidate.
#define MOST_LISTED 1024
#define LISTED_BITS 8
#define NONE_LISTED 0xffff

// What becomes of a cell whose samples floats and integers of 32 bits have taken.
#define CELL_DONE -1

static void Enqueue(__global uint* queue, uint cell, int what)
{
  queue[1 + atomic_inc(queue)] = cell | (uint)what << QUEUE_BITS;
}

// Maps a vertex into a place of the rows, with the values of the arrays. Returns its flags. The operations are those
// of MapOne (BrickMapping.cl), in their order.
static uint MapVertex(const SamplingMesh* mesh, int x, int y, int z, ROW_MEMORY float* place,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const int state = StateOf(mesh->State, x, y, z, p);
  float4 position = (float4)(NO_SOURCE, 0.0f, 0.0f, 0.0f);
  if (state & DEFORMVOLUME_VERTEX_SOURCE)
  {
    const RestPosition rx = mesh->Map.Rest[x];
    const RestPosition ry = mesh->Map.Rest[p->Size[0] + y];
    const RestPosition rz = mesh->Map.Rest[p->Size[0] + p->Size[1] + z];
    const float4 moved = Displacement(&mesh->Map, x, y, z, p) +
      (float4)(rx.Fraction * STEP, ry.Fraction * STEP, rz.Fraction * STEP, 0.0f);
    position = RoundSteps_float4(moved, STEP) +
      (float4)((rx.Whole - p->OutputFirst[0] * 256) * STEP,
        (ry.Whole - p->OutputFirst[1] * 256) * STEP, (rz.Whole - p->OutputFirst[2] * 256) * STEP,
        0.0f);
  }
  place[0] = position.x;
  place[HALF_ROW] = position.y;
  place[2 * HALF_ROW] = position.z;
  uint flags = state & DEFORMVOLUME_VERTEX_INTERIOR ? 0 : FLAG_BORDER;
#if HAS_CUT
  flags |= state & DEFORMVOLUME_VERTEX_TOGETHER ? 0 : FLAG_APART;
#endif
#define PUT_COLUMN_VALUE(index, TYPE, BITS, SLOT)                                                  \
  {                                                                                                \
    const float value = (float)source##index[VertexInChunk(x, y, z, p)];                           \
    place[(3 + SLOT) * HALF_ROW] = value;                                                          \
    flags |= BITS == 32 && IS_SPECIAL(as_int(value)) ? FLAG_SPECIAL : 0;                           \
  }
  LANE_ARRAYS(PUT_COLUMN_VALUE)
  return flags;
}

static __attribute__((always_inline)) void BoundCell(const Group* group, Bounds* b)
{
  LOAD_VERTICES
#define BOUND_CELL(C)                                                                              \
  b->Low##C = Least(Least(Least(C##0, C##1), Least(C##2, C##3)),                                   \
    Least(Least(C##4, C##5), Least(C##6, C##7)));                                                  \
  b->High##C = Most(Most(Most(C##0, C##1), Most(C##2, C##3)),                                      \
    Most(Most(C##4, C##5), Most(C##6, C##7)));
  BOUND_CELL(X)
  BOUND_CELL(Y)
  BOUND_CELL(Z)
}

// A sample that the cell owns.
static __attribute__((always_inline)) void StoreSample(const Group* group, int place, int inverted,
  const SampleWeights* weights, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  if (p->Pass != DEFORMVOLUME_PASS_DIRECT &&
    !TakesPlace(output, place, MakeKey(group->X, group->Y, group->Z, inverted, p), p))
  {
    return;
  }
  Cover(output, place);
#define STORE_COLUMN_VALUE(index, TYPE, BITS, SLOT)                                                \
  {                                                                                                \
    INTERPOLATE_LANES(v, TYPE, BITS, SLOT)                                                         \
    target##index[place] = LANE_CONVERT_##BITS(TYPE, as_int(v));                                   \
  }
  LANE_ARRAYS(STORE_COLUMN_VALUE)
#if HAS_OTHER_ARRAYS
  StoreOtherArrays(group, 0, place, p ARRAY_ARGUMENTS);
#endif
}

// What a weight has to exceed for a sample to be inside. Boxes take all their candidates, whatever the second smallest
// weight is, from which that is told.
static float DecisiveWeight(const GroupCandidates* c, const GroupFrame* frame)
{
  return c->HasBoxes && c->Box ? -INFINITY : frame->Bound;
}

// A candidate by its number: where it is, its weights, and whether floats leave it undecided. Returns whether the cell
// holds it, as far as they decide.
static __attribute__((always_inline)) uint WeighCandidate(const GroupCandidates* c,
  const GroupFrame* frame, const GroupScales* scales, int candidate, Walk* at,
  SampleWeights* weights, uint* undecided, const KernelParameters* p)
{
  GoTo(c, frame, candidate, at, p);
  WeighSamples(frame, scales, at->X, at->Y, at->Z, weights);
  return DecideByFloats(weights, 1, DecisiveWeight(c, frame), frame->Bound, undecided);
}

// Whether a box beside what is missing has its samples on vertices decided by DecideOnVertices: where others are
// undecided, too, integers decide all of them, as they do for groups (GroupResampling.cl).
static int IsDecidedOnVertices(const GroupCandidates* c, const GroupFrame* frame,
  const GroupScales* scales, const KernelParameters* p)
{
  int decided = c->HasBeside && c->Beside;
  for (int i = 0; i < c->Number && decided && c->Extent < MAXIMUM_EXACT_EXTENT; ++i)
  {
    Walk at;
    SampleWeights weights;
    uint undecided;
    WeighCandidate(c, frame, scales, i, &at, &weights, &undecided, p);
    decided = !undecided || IsOnVertex(frame, &at);
  }
  return decided;
}

// The samples of a cell whose frame is nice. mesh: where the cell may be on the border. undecidedOnes: takes the numbers,
// as bits, of candidates that floats do not decide and integers of 32 bits are to; null: these do so here.
// onlyUndecided: of all samples those only. Returns what is still to be done: CELL_DONE or QUEUE_...
static __attribute__((always_inline)) int TakeSamples(const GroupCandidates* c,
  const GroupFrame* frame, const SamplingMesh* mesh, ulong* undecidedOnes, int onlyUndecided,
  Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  const Group* const group = &c->Cells;
  const int box = c->HasBoxes && c->Box;
  // Integers of 32 bits decide who owns a sample.
  const int isExact =
    c->Extent < MAXIMUM_EXACT_EXTENT && !DEFORMVOLUME_IS_CLOSED(p->Pass);
  GroupState state;
  if (mesh && group->Border)
  {
    StatesOfGroup(mesh, group->X, group->Y, group->Z, &state, p);
  }
  GroupScales scales;
  FindScales(frame, &scales);
  // The only vertex that may be among the candidates of a box inside the mesh is its lowest one, the first candidate; but
  // not so in passes for all cells that hold a voxel.
  Walk first;
  GoTo(c, frame, 0, &first, p);
  const int mayReachEnds = mesh || DEFORMVOLUME_IS_CLOSED(p->Pass);
  const int beginsOnVertex = box && IsOnVertex(frame, &first);
  const int beside = mesh && IsDecidedOnVertices(c, frame, &scales, p);
  uint writes = 0;
  uint left = 0;      // whether floats have left samples undecided
  uint ambiguous = 0; // whether integers have
  for (int i = 0; i < c->Number; ++i)
  {
    Walk at;
    SampleWeights weights;
    uint undecided;
    uint held = WeighCandidate(c, frame, &scales, i, &at, &weights, &undecided, p);
    int onVertex = i == 0 ? beginsOnVertex : mayReachEnds && box && IsOnVertex(frame, &at);
    if (beside && IsOnVertex(frame, &at))
    {
      undecided = 0;
      held = DecideOnVertices(group, 1, VerticesAt(frame, &at), &c->State, at.X + frame->X0,
        at.Y + frame->Y0, at.Z + frame->Z0, mesh, output, p);
      onVertex = 1;
    }
    held = onlyUndecided ? 0 : held;
    if (undecided && isExact && undecidedOnes)
    {
      *undecidedOnes |= 1ul << i;
    }
    else if (undecided && isExact)
    {
      const float sample[3] = { at.X, at.Y, at.Z };
      int isVertex;
      held = DecideByIntegers(
        group, 1, sample, frame->Inverted, &state, &isVertex, &ambiguous, output, p);
      onVertex |= isVertex;
    }
    else
    {
      left |= undecided;
    }
    if (p->IsPart)
    {
      held &= InOutput(at.X + frame->X0, at.Y + frame->Y0, at.Z + frame->Z0, p);
    }
    *(undecidedOnes ? &output->Writes : &writes) += held;
    if (held)
    {
      if (onVertex)
      {
        SnapWeights(1, frame, &weights);
      }
      StoreSample(group, at.Place, frame->Inverted, &weights, output, p ARRAY_ARGUMENTS);
    }
  }
  // Cells too large for these integers leave the samples in question only: they have many, and hardly one is.
  const int again = left && c->Extent < MAXIMUM_EXACT_EXTENT ? 1 : (int)ambiguous;
  if (again)
  {
    return QUEUE_UNSURE; // and what it has written must not count twice
  }
  output->Writes += writes;
  output->Inverted += frame->Inverted && !onlyUndecided ? 5 : 0;
  return left ? QUEUE_DOUBTS : CELL_DONE;
}

// A cell, as far as floats and integers of 32 bits take it. most: of its candidates. All else is as for TakeSamples.
static __attribute__((always_inline)) int ResampleColumnCell(GroupCandidates* c, int most,
  const SamplingMesh* mesh, GroupFrame* frame, ulong* undecidedOnes, int onlyUndecided,
  Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  Bounds bounds;
  BoundCell(&c->Cells, &bounds);
  FindGroupCandidates(&bounds, mesh, output, c, p ARRAY_ARGUMENTS);
  if (!c->There || c->Skip)
  {
    return CELL_DONE;
  }
  if (c->Some && c->Number > most)
  {
    return QUEUE_FLOATS;
  }
  MakeGroupFrame(c, c->Fit, frame);
  if (!frame->Nice)
  {
    return QUEUE_UNSURE;
  }
  if (!c->Some)
  {
    output->Inverted += frame->Inverted ? 5 : 0;
    return CELL_DONE;
  }
  return TakeSamples(c, frame, mesh, undecidedOnes, onlyUndecided, output, p ARRAY_ARGUMENTS);
}

// A cell whose vertices lie in rows. row: the place of its vertices in the row of even y and z.
static __attribute__((always_inline)) void MakeCellGroup(LocalRow row, int oddY, int side, int x,
  int y, int z, uint flags, Group* cell, const KernelParameters* p)
{
  cell->Row = row;
  cell->OddY = oddY;
  cell->Side = side;
  cell->X = x;
  cell->Y = y;
  cell->Z = z;
  cell->Odd = (p->First[0] + x + p->First[1] + y + p->First[2] + z) & 1;
  cell->Border = (flags & FLAG_BORDER) != 0;
  cell->Apart = (flags & FLAG_APART) != 0;
}

#if HAS_COLUMN_KERNEL
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

// The cell of a group at a place of its layer, inside the mesh. z: of the cell.
static __attribute__((always_inline)) void MakeColumnCell(__local const float* rows, int3 first,
  int inX, int inY, int z, Group* cell, const KernelParameters* p)
{
  MakeCellGroup(rows + (inY + (inY & 1)) * ROW + (inX >> 1), inY & 1 ? -ROW : ROW, inX & 1,
    first.x + inX, first.y + inY, z, 0, cell, p);
}

// Lists samples of a cell, by the numbers of the candidates, as bits. Returns whether there was room.
static int List(ulong candidates, int cell, __local ushort* list, __local uint* listed)
{
  const uint number = popcount(candidates);
  uint place = atomic_add(listed, number);
  const int fits = place + number <= MOST_LISTED;
  for (; candidates && place < MOST_LISTED; candidates &= candidates - 1, ++place)
  {
    const int candidate = 63 - clz(candidates & -candidates);
    list[place] = fits ? candidate << LISTED_BITS | cell : NONE_LISTED;
  }
  return fits;
}

// A sample of the list. Its cell is neither a box nor on the border, and its frame is nice.
static __attribute__((always_inline)) void TakeListed(
  const Group* group, int candidate, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  GroupFrame frame;
  FindNormals(group, &frame);
  TurnInverted(1, &frame);
  // As it was found to be a candidate.
  const float toEnd = p->Pass != DEFORMVOLUME_PASS_DIRECT ? 1.0f : ALMOST_ONE;
  const ToEnds toEnds = { toEnd, toEnd, toEnd };
  Bounds bounds;
  BoundCell(group, &bounds);
  GroupCandidates c;
  SetCandidates(&bounds, &toEnds, &c, p);
  Walk at;
  GoTo(&c, &frame, candidate, &at, p);
  const float sample[3] = { at.X, at.Y, at.Z };
  int onVertex;
  uint none = 0;
  GroupState unused;
  uint held =
    DecideByIntegers(group, 1, sample, frame.Inverted, &unused, &onVertex, &none, output, p);
  if (p->IsPart)
  {
    held &= InOutput(at.X + frame.X0, at.Y + frame.Y0, at.Z + frame.Z0, p);
  }
  if (!held)
  {
    return;
  }
  output->Writes++;
  FindCoordinates(group, &frame);
  GroupScales scales;
  FindScales(&frame, &scales);
  SampleWeights weights;
  WeighSamples(&frame, &scales, at.X, at.Y, at.Z, &weights);
  SnapWeights(onVertex, &frame, &weights);
  StoreSample(group, at.Place, frame.Inverted, &weights, output, p ARRAY_ARGUMENTS);
}

// The section of a brick that a group takes, or one of a brick that has none to be run, for a group that only fills the
// launch. What can be found from the number of the group is not kept in registers.
static uint BrickOfGroup(__global const uint* bricks, const KernelParameters* p)
{
  const int place = p->ListBegin + (int)(get_group_id(0) / DEFORMVOLUME_COLUMNS);
  return place < p->ListEnd ? bricks[place] : 0;
}

static size_t SectionOfGroup(uint brick)
{
  return DEFORMVOLUME_SECTIONS * (size_t)(brick & ((1u << DEFORMVOLUME_BRICK_BITS) - 1)) +
    (get_group_id(2) * 2 + get_group_id(1)) * DEFORMVOLUME_COLUMNS +
    get_group_id(0) % DEFORMVOLUME_COLUMNS;
}

static int3 FirstInBrick()
{
  return (int3)((int)(get_group_id(0) % DEFORMVOLUME_COLUMNS) * ROW_CELLS,
    (int)get_group_id(1) * CELL_ROWS, (int)get_group_id(2) * CELL_LAYERS);
}

// A cell of a group as the queue numbers it. cell: its place in a layer.
static uint NumberInLaunch(int cell, int layer)
{
  const int3 first = FirstInBrick();
  return get_group_id(0) / DEFORMVOLUME_COLUMNS * CELLS_OF_BRICK +
    ((first.z + layer) * DEFORMVOLUME_BRICK_Y + first.y + cell / ROW_CELLS) * DEFORMVOLUME_BRICK_X +
    first.x + cell % ROW_CELLS;
}

// Bricks of a list from p.ListBegin to p.ListEnd, a group a section: on x the columns of one brick after the other, on y
// and z the halves.
__kernel void ResampleColumns(MAPPING_PARAMETERS, __global const uchar* state,
  __global const uchar* active, __global const float* distances, __global char* coverage,
  __global KEY* winners, __global char* patches, __global uint* largeCells,
  __global uint* counters CUT_PARAMETERS, __global const uint* bricks, __global uint* queue,
  __local float* rows, const KernelParameters parameters ARRAY_PARAMETERS)
{
  KernelParameters p = parameters;
#if PASS_IS_DIRECT
  p.Pass = DEFORMVOLUME_PASS_DIRECT;
#endif
  __local uchar flags[2 * PLANE_VERTICES];
  __local ushort list[MOST_LISTED];
  __local uint listed;
  __local uint counts[DEFORMVOLUME_COUNTERS];
  const uint brick = BrickOfGroup(bricks, &p);
  const int3 first = FirstOfBrick(brick, &p) + FirstInBrick();
  const int beginZ = max(first.z, p.LayersBegin);
  const int endZ = IsSectionRun(brick, SectionOfGroup(brick)) && beginZ < p.LayersEnd
    ? min(first.z + CELL_LAYERS, p.LayersEnd)
    : beginZ - 1;
  const SamplingMesh mesh = { MAPPING_ARGUMENTS, state, active, distances CUT_ARGUMENTS, 0, { 0, 0, 0 } };
  Output output = NEW_OUTPUT(coverage, winners, patches, largeCells);
  for (int i = get_local_id(0); i < DEFORMVOLUME_COUNTERS; i += get_local_size(0))
  {
    counts[i] = 0;
  }
  for (int z = beginZ; z <= endZ; ++z)
  {
    // Rows of even and of odd structured y, and planes, lie by their parity.
    const int plane = (p.First[2] + z) & 1;
    for (int i = get_local_id(0); i < PLANE_VERTICES; i += get_local_size(0))
    {
      const int inX = i % (ROW_CELLS + 1), inY = i / (ROW_CELLS + 1);
      const int x = first.x + inX, y = first.y + inY;
      flags[plane * PLANE_VERTICES + i] = x >= 0 && y >= 0 && x < p.Size[0] && y < p.Size[1]
        ? MapVertex(&mesh, x, y, z,
            rows + (plane * ROWS + inY) * ROW + (inX >> 1) + (inX & 1 ? ODD : 0), &p ARRAY_ARGUMENTS)
        : FLAG_OUTSIDE;
    }
    if (get_local_id(0) == 0)
    {
      listed = 0;
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (int i = get_local_id(0); i < (z > beginZ ? ROW_CELLS * CELL_ROWS : 0);
         i += get_local_size(0))
    {
      const int inX = i % ROW_CELLS, inY = i / ROW_CELLS;
      __local const uchar* const f = flags + inY * (ROW_CELLS + 1) + inX;
      const int other = PLANE_VERTICES, up = ROW_CELLS + 1;
      const uint any =
        f[0] | f[1] | f[up] | f[up + 1] | f[other] | f[other + 1] | f[other + up] | f[other + up + 1];
      int left = any & FLAG_OUTSIDE ? CELL_DONE : any & FLAG_SPECIAL ? QUEUE_UNSURE : QUEUE_FLOATS;
      if (any == 0)
      {
        GroupCandidates c;
        MakeColumnCell(rows, first, inX, inY, z - 1, &c.Cells, &p);
        GroupFrame frame;
        ulong undecided = 0;
        left = ResampleColumnCell(&c, MOST_CANDIDATES_IN_COLUMN, 0, &frame, &undecided, 0, &output,
          &p ARRAY_ARGUMENTS);
        if (undecided && !List(undecided, i, list, &listed))
        {
          left = QUEUE_INTEGERS;
        }
      }
      if (left != CELL_DONE)
      {
        Enqueue(queue, NumberInLaunch(i, z - 1 - first.z), left);
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = get_local_id(0); i < min(listed, (uint)MOST_LISTED); i += get_local_size(0))
    {
      const uint entry = list[i];
      if (entry != NONE_LISTED)
      {
        const int cell = entry & ((1 << LISTED_BITS) - 1);
        Group group;
        MakeColumnCell(rows, first, cell % ROW_CELLS, cell / ROW_CELLS, z - 1, &group, &p);
        TakeListed(&group, entry >> LISTED_BITS, &output, &p ARRAY_ARGUMENTS);
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  AddToGroup(&output, counts);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int i = get_local_id(0); i < DEFORMVOLUME_COUNTERS; i += get_local_size(0))
  {
    AddCount(i, counts[i], SectionOfGroup(BrickOfGroup(bricks, &p)), counters, &p);
  }
}

#else

// The samples of a cell that floats do not decide.
static void ResampleDoubts(const GroupCandidates* c, const GroupFrame* frame,
  const SamplingMesh* mesh, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  const Group* const group = &c->Cells;
  const Candidates all = AllCandidates(p);
  Neighbours near;
  const SamplingMesh keeping = KeepNeighbours(mesh, group->X, group->Y, group->Z, &near);
  Cell cell;
  int isMade = -1; // -1: not known
  // It is counted already whether the cell is inverted.
  const uint inverted = output->Inverted;
  GroupScales scales;
  FindScales(frame, &scales);
  for (int i = 0; i < c->Number; ++i)
  {
    Walk at;
    SampleWeights weights;
    uint undecided;
    WeighCandidate(c, frame, &scales, i, &at, &weights, &undecided, p);
    const float x = at.X + frame->X0, y = at.Y + frame->Y0, z = at.Z + frame->Z0;
    if (!undecided || !InOutput(x, y, z, p) ||
      (c->HasBeside && c->Beside && IsOnVertex(frame, &at)))
    {
      continue;
    }
    const Vector voxel = { (int)x + p->OutputFirst[0], (int)y + p->OutputFirst[1],
      (int)z + p->OutputFirst[2] };
    const Candidates only = { voxel, voxel };
    // In the closed passes the sample decides whether the cell is looked at.
    if (isMade < 0 || DEFORMVOLUME_IS_CLOSED(p->Pass))
    {
      // No whole cell is divided: there are no views of it.
      isMade = MakeCell(&keeping, group->X, group->Y, group->Z,
                 DEFORMVOLUME_IS_CLOSED(p->Pass) ? &only : &all, &cell, 0, output, p) &&
        !IsPutOff(&cell, &only, output, p);
    }
    if (isMade)
    {
      ResampleSamples(&keeping, &cell, &only, output, p ARRAY_ARGUMENTS);
    }
  }
  output->Inverted = inverted;
}

// A cell of the queue by itself, with its vertices in places of the rows that are this work-item's.
static void ResampleQueuedCell(const SamplingMesh* mesh, int x, int y, int z, int what,
  ROW_MEMORY float* place, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  if (what != QUEUE_UNSURE)
  {
    const int mirror = Mirror(x, y, z, p);
    uint flags = 0;
    for (int v = 0; v < 8; ++v)
    {
      const int o = v ^ mirror;
      flags |= MapVertex(mesh, x + (o & 1), y + (o >> 2), z + (o >> 1 & 1),
        place + (v >> 1 & 1) * (ROWS * ROW) + (v >> 2) * ROW + (v & 1 ? ODD : 0), p ARRAY_ARGUMENTS);
    }
    GroupCandidates c;
    GroupFrame frame;
    MakeCellGroup(place, ROW, 0, x, y, z, flags, &c.Cells, p);
    what = ResampleColumnCell(
      &c, MAXIMUM_CANDIDATES, mesh, &frame, 0, what != QUEUE_FLOATS, output, p ARRAY_ARGUMENTS);
    if (what == QUEUE_DOUBTS)
    {
      ResampleDoubts(&c, &frame, mesh, output, p ARRAY_ARGUMENTS);
      return;
    }
    if (what == CELL_DONE)
    {
      return;
    }
  }
  const Candidates all = AllCandidates(p);
  Neighbours near;
  const SamplingMesh keeping = KeepNeighbours(mesh, x, y, z, &near);
  ResampleCell(&keeping, x, y, z, &all, output, p ARRAY_ARGUMENTS);
}

// What is in the queue, an entry a work-item. Groups have at most as many items as there are places for the vertices of
// cells with rows of their own, two in each plane.
__kernel void ResampleQueued(MAPPING_PARAMETERS, __global const uchar* state,
  __global const uchar* active, __global const float* distances, __global char* coverage,
  __global KEY* winners, __global char* patches, __global uint* largeCells,
  __global uint* counters CUT_PARAMETERS, __global const uint* bricks, __global uint* queue,
  __local float* rows, const KernelParameters p ARRAY_PARAMETERS)
{
  const SamplingMesh mesh = { MAPPING_ARGUMENTS, state, active, distances CUT_ARGUMENTS, 0, { 0, 0, 0 } };
  const int item = get_local_id(0);
  ROW_MEMORY float* const place =
    rows + item / (ROW_CELLS / 2) * 2 * ROW + item % (ROW_CELLS / 2);
  const uint entries = queue[0];
  for (uint i = get_global_id(0); i < entries; i += get_global_size(0))
  {
    const uint entry = queue[1 + i];
    const uint cell = entry & ((1u << QUEUE_BITS) - 1);
    const uint inBrick = cell % CELLS_OF_BRICK;
    const int3 first = FirstOfBrick(bricks[p.ListBegin + cell / CELLS_OF_BRICK], &p);
    const int x = first.x + (int)(inBrick % DEFORMVOLUME_BRICK_X);
    const int y = first.y + (int)(inBrick / DEFORMVOLUME_BRICK_X % DEFORMVOLUME_BRICK_Y);
    const int z = first.z + (int)(inBrick / DEFORMVOLUME_BRICK_X / DEFORMVOLUME_BRICK_Y);
    Output output = NEW_OUTPUT(coverage, winners, patches, largeCells);
    ResampleQueuedCell(
      &mesh, x, y, z, entry >> QUEUE_BITS, place, &output, &p ARRAY_ARGUMENTS);
    AddCounts(&output, SectionOf(x, y, z, &p), counters, &p);
  }
}
#endif
