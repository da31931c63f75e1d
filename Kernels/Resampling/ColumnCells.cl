// SPDX-License-Identifier: BSD-3-Clause
// One cell for each work-item, for devices whose work-items are lanes, such as GPUs: code that ColumnResampling.cl
// and DeferredResampling.cl share. Decisions by floats and by 32-bit integers are those of the CPU kernels
// (BrickResampling.cl).
//
// The host defines before this text:
//   HAS_COLUMN_KERNEL  1 for ResampleColumns and ResampleDeferredInt32, 0 for ResampleDeferredInt64
//   PASS_IS_DIRECT     1 if these two kernels are compiled for the direct pass only, which needs fewer registers
//
// Data: as in BrickResampling.cl. This text comes after PacketWalk.cl. rows: ROW floats for each row of three planes,
// or of two planes in the kernels for deferred cells. deferred: the number of cells for ResampleDeferredInt64, the
// number for ResampleDeferredInt32, then entries for all cells of the launch. Cells for ResampleDeferredInt64 are
// added from the front, the others from the back.

#define PLANE_VERTICES ((ROW_CELLS + 1) * ROWS)
#define FLAG_BORDER 1  // the vertex is not interior
#define FLAG_SPECIAL 2 // the vertex has a value that IS_SPECIAL
#define FLAG_SPLIT 4   // the vertex has different positions for the two sides of a smooth cut
#define FLAG_OUTSIDE 8 // the slot has no vertex: it is outside the volume
#define FLAG_WHOLE 16  // the cell whose lowest vertex this is has all of its tetrahedra

// An entry of a deferred cell: the index in the launch's part of the list of bricks times CELLS_OF_BRICK, plus the
// cell in the brick; and in the highest bits the next step of the exactness chain.
#define CELLS_OF_BRICK (DEFORMVOLUME_BRICK_X * DEFORMVOLUME_BRICK_Y * DEFORMVOLUME_BRICK_Z)
#define DEFERRED_BITS 30
#define DEFERRED_FLOATS 0        // resample the cell like a packet
#define DEFERRED_INT32 1         // resample the samples that floats do not decide, by 32-bit integers; all other
                                 // samples are finished. ResampleDeferredInt64 skips entries with this step.
#define DEFERRED_SAMPLES_INT64 2 // resample the samples that floats do not decide, by ResampleSamples
#define DEFERRED_CELL_INT64 3    // resample the cell by ResampleCell
// There is no further step.
#define CELL_DONE -1

// Maps a vertex to a slot of the rows, with the values of the arrays. Returns its flags. The operations and their order
// are those of MapOne (BrickMapping.cl).
static uint MapVertex(const SamplingMesh* mesh, int x, int y, int z, ROW_MEMORY float* slot,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const int state = StateOf(mesh->State, x, y, z, p);
  float4 position = (float4)(NO_SOURCE, 0.0f, 0.0f, 0.0f);
  if (state & DEFORMVOLUME_VERTEX_SOURCE)
  {
    const Rest rest = RestOf(&mesh->Map, x, y, z, p);
    const int4 first = (int4)(p->OutputFirst[0], p->OutputFirst[1], p->OutputFirst[2], 0);
    const float4 moved = Displacement(&mesh->Map, x, y, z, p) + rest.Fraction * STEP;
    position =
      RoundSteps_float4(moved, STEP) + convert_float4(rest.Whole - first * 256) * STEP;
  }
  slot[0] = position.x;
  slot[HALF_ROW] = position.y;
  slot[2 * HALF_ROW] = position.z;
  uint flags = state & DEFORMVOLUME_VERTEX_INTERIOR ? 0 : FLAG_BORDER;
  flags |= state & DEFORMVOLUME_CELL_WHOLE ? FLAG_WHOLE : 0;
#if HAS_CUT
  flags |= state & DEFORMVOLUME_VERTEX_UNSPLIT ? 0 : FLAG_SPLIT;
#endif
#define PUT_COLUMN_VALUE(index, TYPE, BITS, SLOT)                                                  \
  {                                                                                                \
    const float value = (float)source##index[VertexInChunk(x, y, z, p)];                           \
    slot[(3 + SLOT) * HALF_ROW] = value;                                                          \
    flags |= BITS == 32 && IS_SPECIAL(as_int(value)) ? FLAG_SPECIAL : 0;                           \
  }
  LANE_ARRAYS(PUT_COLUMN_VALUE)
  return flags;
}

static __attribute__((always_inline)) void BoundCell(const Packet* packet, Bounds* b)
{
  LOAD_VERTICES
#define BOUND_CELL(C)                                                                              \
  b->Low##C = Min(Min(Min(C##0, C##1), Min(C##2, C##3)),                                   \
    Min(Min(C##4, C##5), Min(C##6, C##7)));                                                  \
  b->High##C = Max(Max(Max(C##0, C##1), Max(C##2, C##3)),                                      \
    Max(Max(C##4, C##5), Max(C##6, C##7)));
  BOUND_CELL(X)
  BOUND_CELL(Y)
  BOUND_CELL(Z)
}

// Stores a sample that the cell owns.
static __attribute__((always_inline)) void StoreSample(const Packet* packet, uint voxel, int inverted,
  const SampleWeights* weights, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  if (p->Pass != DEFORMVOLUME_PASS_DIRECT &&
    !WinsVoxel(output, voxel, MakeKey(packet->X, packet->Y, packet->Z, inverted, p), p))
  {
    return;
  }
  Cover(output, voxel);
#define STORE_COLUMN_VALUE(index, TYPE, BITS, SLOT)                                                \
  {                                                                                                \
    INTERPOLATE_LANES(v, TYPE, BITS, SLOT)                                                         \
    target##index[voxel] = LANE_CONVERT_##BITS(TYPE, as_int(v));                                   \
  }
  LANE_ARRAYS(STORE_COLUMN_VALUE)
#if HAS_OTHER_ARRAYS
  StoreOtherArrays(packet, 0, voxel, p ARRAY_ARGUMENTS);
#endif
}

// The weight above which a sample counts as inside. Aligned cells own all of their candidates, whatever the second
// smallest weight.
static float HoldingWeight(const PacketCandidates* c, const PacketFrame* frame)
{
  return c->HasAligned && c->Aligned ? -INFINITY : frame->Bound;
}

// Finds the weights of a sample. Returns whether the cell holds it, as far as floats decide this.
static __attribute__((always_inline)) uint WeighCandidate(const PacketCandidates* c,
  const PacketFrame* frame, const PacketScales* scales, const Walk* at, SampleWeights* weights,
  uint* undecidedByFloats)
{
  WeighSamples(frame, scales, at->X, at->Y, at->Z, weights);
  return DecideByFloats(weights, 1, HoldingWeight(c, frame), frame->Bound, undecidedByFloats);
}

// Whether DecideOnVertices decides the samples on vertices of an aligned cell next to missing cells. If floats leave
// other samples undecided, integers decide all of them, as for packets (PacketResampling.cl).
static int IsDecidedOnVertices(const PacketCandidates* c, const PacketFrame* frame,
  const PacketScales* scales, const KernelParameters* p)
{
  int decided = c->HasNextToMissing && c->NextToMissing;
  Walk at;
  BeginWalk(c, frame, &at, p);
  for (int i = 0; i < c->Number && decided && c->Extent < MAXIMUM_EXACT_EXTENT; ++i)
  {
    SampleWeights weights;
    uint undecidedByFloats;
    WeighCandidate(c, frame, scales, &at, &weights, &undecidedByFloats);
    decided = !undecidedByFloats || IsOnVertex(frame, &at);
    Advance(&at);
  }
  return decided;
}

// Resamples the samples of a cell whose frame is nice. mesh, isComplete, onlyUndecidedByFloats: as for
// ResampleColumnCell. Returns the next step: CELL_DONE or DEFERRED_...
static __attribute__((always_inline)) int VisitCellCandidates(const PacketCandidates* c,
  const PacketFrame* frame, const SamplingMesh* mesh, int isComplete, int onlyUndecidedByFloats,
  Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  const Packet* const packet = &c->Cells;
  const int aligned = c->HasAligned && c->Aligned;
  const int isSmall = c->Extent < MAXIMUM_EXACT_EXTENT; // 32-bit integers can decide who owns a sample
  PacketState state;
  if (isComplete && packet->Border)
  {
    StatesOfPacket(mesh, packet->X, packet->Y, packet->Z, &state, p);
  }
  PacketScales scales;
  FindScales(frame, &scales);
  Walk at;
  BeginWalk(c, frame, &at, p);
  // Inside the mesh, the only vertex among the candidates of an aligned cell is its lowest one, the first candidate.
  // This does not hold in passes that visit all cells which hold a voxel.
  const int mayHoldEnds = isComplete || DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass);
  const int beginsOnVertex = aligned && IsOnVertex(frame, &at);
  const int isOnGap = mesh && IsDecidedOnVertices(c, frame, &scales, p);
  uint writes = 0;
  uint isUndecided = 0; // whether floats leave a sample undecided, and 32-bit integers were not used
  uint needsInt64 = 0;  // whether 32-bit integers leave a sample undecided
  for (int i = 0; i < c->Number; ++i)
  {
    SampleWeights weights;
    uint undecidedByFloats;
    uint held = WeighCandidate(c, frame, &scales, &at, &weights, &undecidedByFloats);
    int onVertex = i == 0 ? beginsOnVertex : mayHoldEnds && aligned && IsOnVertex(frame, &at);
    if (isOnGap && IsOnVertex(frame, &at))
    {
      undecidedByFloats = 0;
      held = DecideOnVertices(packet, 1, VerticesAt(frame, &at), &c->State, at.X + frame->X0,
        at.Y + frame->Y0, at.Z + frame->Z0, mesh, output, p);
      onVertex = 1;
    }
    held = onlyUndecidedByFloats ? 0 : held;
    if (isComplete && undecidedByFloats && isSmall && !DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass))
    {
      const float sample[3] = { at.X, at.Y, at.Z };
      int isVertex;
      held = DecideByIntegers(
        packet, 1, sample, frame->Inverted, &state, &isVertex, &needsInt64, output, p);
      onVertex |= isVertex;
    }
    else
    {
      isUndecided |= undecidedByFloats;
    }
    if (c->ExceedsPart)
    {
      held &= InOutput(at.X + frame->X0, at.Y + frame->Y0, at.Z + frame->Z0, p);
    }
    writes += held;
    if (held)
    {
      if (onVertex)
      {
        SnapWeights(1, frame, &weights);
      }
      StoreSample(packet, at.Voxel, frame->Inverted, &weights, output, p ARRAY_ARGUMENTS);
    }
    Advance(&at);
  }
  // A cell that is resampled again must not be counted twice. Cells too large for 32-bit integers only defer their
  // undecided samples: they have many samples, and floats decide nearly all of them.
  if (isUndecided && !isComplete && packet->Border)
  {
    return DEFERRED_FLOATS;
  }
  if ((isUndecided && isSmall && DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass)) || needsInt64)
  {
    return DEFERRED_CELL_INT64;
  }
  output->Writes += writes;
  output->Inverted += frame->Inverted && !onlyUndecidedByFloats ? 5 : 0;
  return !isUndecided ? CELL_DONE : isSmall ? DEFERRED_INT32 : DEFERRED_SAMPLES_INT64;
}

// Resamples a cell by floats and by 32-bit integers. mesh: null if vertices have no state, or it is not needed.
// isComplete: whether 32-bit integers decide at once the samples that floats leave undecided, and cells at the border
// are recognized; otherwise cells must be whole. onlyUndecidedByFloats: resample only these samples. most: largest
// number of candidates. Returns the next step: CELL_DONE or DEFERRED_...
static __attribute__((always_inline)) int ResampleColumnCell(PacketCandidates* c, int most,
  const SamplingMesh* mesh, PacketFrame* frame, int isComplete, int onlyUndecidedByFloats, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  Bounds bounds;
  BoundCell(&c->Cells, &bounds);
  FindPacketCandidates(&bounds, mesh, isComplete, output, c, p ARRAY_ARGUMENTS);
  if (!c->Existing || c->Skip)
  {
    return CELL_DONE;
  }
  // Aligned cells at the border own samples depending on the surrounding cells.
  if ((c->WithCandidates && c->Number > most) || (!isComplete && c->Cells.Border && c->HasAligned))
  {
    return DEFERRED_FLOATS;
  }
  MakePacketFrame(c, c->Simple, frame);
  if (!frame->Decidable)
  {
    return DEFERRED_CELL_INT64;
  }
  if (!c->WithCandidates)
  {
    output->Inverted += frame->Inverted && !onlyUndecidedByFloats ? 5 : 0;
    return CELL_DONE;
  }
  return VisitCellCandidates(
    c, frame, mesh, isComplete, onlyUndecidedByFloats, output, p ARRAY_ARGUMENTS);
}

// Makes a packet of a cell whose vertices are in rows. row: the slot of its vertices in the row of even y and z.
static __attribute__((always_inline)) void MakeCellPacket(LocalRow row, int oddY, int oddZ, int side,
  int x, int y, int z, uint flags, Packet* cell, const KernelParameters* p)
{
  cell->Row = row;
  cell->OddY = oddY;
  cell->OddZ = oddZ;
  cell->Side = side;
  cell->X = x;
  cell->Y = y;
  cell->Z = z;
  cell->Parity = IsTurned(x, y, z, p);
  cell->Border = (flags & FLAG_BORDER) != 0;
  cell->Split = (flags & FLAG_SPLIT) != 0;
}

// Returns the slot in which a work-item keeps the vertices of a deferred cell. A cell takes this slot in two rows of
// each of two planes. Work-groups have at most as many work-items as there are such slots.
static ROW_MEMORY float* SlotOfItem(ROW_MEMORY float* rows)
{
  const int item = get_local_id(0);
  return rows + item / (ROW_CELLS / 2) * 2 * ROW + item % (ROW_CELLS / 2);
}

static void MapCell(const SamplingMesh* mesh, int x, int y, int z, ROW_MEMORY float* slot,
  Packet* cell, const KernelParameters* p ARRAY_PARAMETERS)
{
  const int mirror = Mirror(x, y, z, p);
  uint flags = 0;
#if HAS_COLUMN_KERNEL
  UNROLLED // issues all loads at once
#else
  NOT_UNROLLED
#endif
  for (int v = 0; v < 8; ++v)
  {
    const int o = v ^ mirror;
    flags |= MapVertex(mesh, x + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o),
      slot + (v >> 1 & 1) * (ROWS * ROW) + (v >> 2) * ROW + (v & 1 ? ODD : 0), p ARRAY_ARGUMENTS);
  }
  MakeCellPacket(slot, ROW, ROWS * ROW, 0, x, y, z, flags, cell, p);
}

static uint MakeEntry(uint cell, int what)
{
  return cell | (uint)what << DEFERRED_BITS;
}

static uint CellOf(uint entry)
{
  return entry & ((1u << DEFERRED_BITS) - 1);
}

// Returns the index of the cell of an entry.
static int3 CellOfEntry(uint entry, __global const uint* bricks, const KernelParameters* p)
{
  const uint cell = CellOf(entry);
  const uint inBrick = cell % CELLS_OF_BRICK;
  const int3 inside = (int3)((int)(inBrick % DEFORMVOLUME_BRICK_X),
    (int)(inBrick / DEFORMVOLUME_BRICK_X % DEFORMVOLUME_BRICK_Y),
    (int)(inBrick / DEFORMVOLUME_BRICK_X / DEFORMVOLUME_BRICK_Y));
  return FirstOfBrick(bricks[p->ListBegin + cell / CELLS_OF_BRICK], p) + inside;
}

#define ENTRIES_INT64(deferred) ((deferred) + 2)
// The entry with a number, for ResampleDeferredInt32.
#define ENTRY_INT32(deferred, number, p)                                                               \
  ENTRIES_INT64(deferred)[(uint)((p)->ListEnd - (p)->ListBegin) * CELLS_OF_BRICK - 1 - (number)]
