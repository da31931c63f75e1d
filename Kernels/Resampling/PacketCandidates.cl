// SPDX-License-Identifier: BSD-3-Clause
// The candidates of packets of cells: the samples in the box of each cell (BrickResampling.cl).
//
// Candidates are found one packet ahead. The number of rounds of a packet is hard to predict for the branch predictor.
// If the number was stored in memory before, a wrong prediction is detected at once, and not only after the preceding
// computations. There is also time to prefetch the output. Candidates are not found for all packets of a row at once,
// because their data would displace other data from the innermost cache. Neighboring cells share vertices, so the
// bounds of quads (the four vertices at one x) are computed once for a row.

#define MAXIMUM_EXTENT 64.0f // voxels; WeighOrigin (PacketValues.cl) relies on this limit
#define MAXIMUM_CANDIDATES 4096 // of a cell
#define EXACT_NORMALS_EXTENT 7.99f // voxels: the normals of larger cells are not exact in float
#define INEXACT_NORMALS 1.35f // factor of errors for such cells (PacketWeights.cl)
#define ALMOST_ONE (255.0f / 256.0f) // ceil(v) = trunc(v + ALMOST_ONE) for multiples of 1/256

typedef struct
{
  Packet Cells;
  // Sets of cells, as bits:
  uint Existing;       // cells with a vertex that has a position, and no vertex outside the volume
  uint Simple;         // existing cells that are small, and whose tetrahedra are all active and have positions
  uint WithCandidates; // simple cells with candidates
  FLOATS Extent;       // the longest edge of the box
  FLOATS BoundScale;   // Extent times the sum of the box's three faces; larger if normals are not exact
  INTS First[3];       // the first candidate, in output voxels
  INTS Count[3];       // number of candidates on each axis
  INTS Voxel;          // index of the first candidate in the output
  INTS Number;         // total number of candidates, for cells with candidates
  int ExceedsPart;     // whether candidates may lie outside the part of the output that is made
  INTS Aligned;        // cells whose edges are parallel to the axes of the output, if HasAligned
  // Aligned cells with a missing neighbor at a vertex (DecideOnVertices), if HasNextToMissing.
  INTS NextToMissing;
  PacketState State; // if HasNextToMissing
  int HasAligned;
  int HasNextToMissing;
  int Skip; // whether no cell touches a voxel that is still to be won
} PacketCandidates;

// Bounds of vertices or of cells.
typedef struct
{
  FLOATS LowX, LowY, LowZ;
  FLOATS HighX, HighY, HighZ;
} Bounds;

// Inlined functions do not return structures: Oclgrind does not support the code that compilers generate for this.

#if LANES > 1
// Finds the bounds of the quads of four vertices, for LANES slots of the rows from `begin` on.
static __attribute__((always_inline)) void BoundQuads(const LocalRow* rows, int begin, Bounds* b)
{
#define BOUND_QUADS(C, slot)                                                                     \
  {                                                                                                \
    const FLOATS c0 = LOAD(rows[0] + begin + (slot)*HALF_ROW);                                     \
    const FLOATS c1 = LOAD(rows[1] + begin + (slot)*HALF_ROW);                                     \
    const FLOATS c2 = LOAD(rows[2] + begin + (slot)*HALF_ROW);                                     \
    const FLOATS c3 = LOAD(rows[3] + begin + (slot)*HALF_ROW);                                     \
    b->Low##C = Min(Min(c0, c1), Min(c2, c3));                                               \
    b->High##C = Max(Max(c0, c1), Max(c2, c3));                                                 \
  }
  BOUND_QUADS(X, 0)
  BOUND_QUADS(Y, 1)
  BOUND_QUADS(Z, 2)
}

static __attribute__((always_inline)) void Join(const Bounds* a, const Bounds* b, Bounds* joined)
{
  joined->LowX = Min(a->LowX, b->LowX);
  joined->LowY = Min(a->LowY, b->LowY);
  joined->LowZ = Min(a->LowZ, b->LowZ);
  joined->HighX = Max(a->HighX, b->HighX);
  joined->HighY = Max(a->HighY, b->HighY);
  joined->HighZ = Max(a->HighZ, b->HighZ);
}

// Shifts by one lane: lanes from the second one on, then the first lane of `behind`.
static __attribute__((always_inline)) void Shift(const Bounds* a, const Bounds* behind, Bounds* b)
{
  b->LowX = NextLanes(a->LowX, behind->LowX);
  b->LowY = NextLanes(a->LowY, behind->LowY);
  b->LowZ = NextLanes(a->LowZ, behind->LowZ);
  b->HighX = NextLanes(a->HighX, behind->HighX);
  b->HighY = NextLanes(a->HighY, behind->HighY);
  b->HighZ = NextLanes(a->HighZ, behind->HighZ);
}
#endif

// Returns the bits of the cells whose edge from vertex 0 to another vertex is parallel to an axis: exactly two
// coordinates of its ends are equal.
static __attribute__((always_inline)) uint FindAxialEdges(const Packet* packet, int to)
{
#define IS_SAME(slot) LaneBits(VERTEX(0, slot) == VERTEX(to, slot))
  const uint x = IS_SAME(0), y = IS_SAME(1), z = IS_SAME(2);
  return ((x & y) | ((x ^ y) & z)) & ~(x & y & z);
}

// Finds aligned cells, as in a volume that is undeformed, shifted, scaled along axes or rotated by right angles: each
// coordinate varies along a single axis of the voxel grid. rises: output: the cells whose coordinates grow with the
// indices.
static COLD INTS FindAligned(const Packet* packet, int mirror, INTS* rises)
{
  LOAD_VERTICES
#define SAME(C, a, b) (C##a == C##b)
#define ALONG_X(C) (SAME(C, 0, 1) & SAME(C, 2, 3) & SAME(C, 4, 5) & SAME(C, 6, 7))
#define ALONG_Z(C) (SAME(C, 0, 2) & SAME(C, 1, 3) & SAME(C, 4, 6) & SAME(C, 5, 7))
#define ALONG_Y(C) (SAME(C, 0, 4) & SAME(C, 1, 5) & SAME(C, 2, 6) & SAME(C, 3, 7))
#define ALIGNED(C)                                                                                 \
  ((ALONG_X(C) & ALONG_Y(C)) | (ALONG_X(C) & ALONG_Z(C)) | (ALONG_Y(C) & ALONG_Z(C)))
#define RISES(C, to) ((mirror & to) ? C##to < C##0 : C##to > C##0)
  *rises = RISES(X, 1) & RISES(Z, 2) & RISES(Y, 4);
  return ALIGNED(X) & ALIGNED(Y) & ALIGNED(Z);
}

// Cells whose edges along an axis are parallel to that axis, while the other two coordinates vary only along their own
// axes and grow with the indices. Such cells occur, for example, if tissue is pulled along an axis.
typedef struct
{
  INTS X, Y, Z;
} ParallelEdges;

static COLD void FindParallelEdges(
  const Packet* packet, int mirror, ParallelEdges* edges)
{
  LOAD_VERTICES
  const INTS x = ALONG_Y(X) & ALONG_Z(X) & RISES(X, 1);
  const INTS y = ALONG_X(Y) & ALONG_Z(Y) & RISES(Y, 4);
  const INTS z = ALONG_X(Z) & ALONG_Y(Z) & RISES(Z, 2);
  edges->X = y & z;
  edges->Y = x & z;
  edges->Z = x & y;
}

// The first sample of the output within bounds on an axis, and one past the last. Lanes without a cell may have any
// result. Cells with a vertex without position extend to the end of the output, as their samples may be anywhere
// beyond the other vertices. Clamp before converting: float-to-int conversion of NO_SOURCE gives INT_MIN on x86.
#define FIRST_OF(low) TO_INTS(Max(low, 0.0f) + ALMOST_ONE)
#define END_OF(high, toEnd, size) TO_INTS(Min((high) + toEnd, (float)(size)))

// Marks all samples in aligned cells as touched: these cells neither test their high sides nor whether they own a
// sample.
static COLD void TouchAligned(
  INTS aligned, const Bounds* b, Output* output, const KernelParameters* p)
{
  const INTS firstX = FIRST_OF(b->LowX);
  const INTS firstY = FIRST_OF(b->LowY);
  const INTS firstZ = FIRST_OF(b->LowZ);
  const INTS endX = END_OF(b->HighX, 1.0f, p->OutputSize[0]);
  const INTS endY = END_OF(b->HighY, 1.0f, p->OutputSize[1]);
  const INTS endZ = END_OF(b->HighZ, 1.0f, p->OutputSize[2]);
  const INTS touched = aligned & (firstX < endX) & (firstY < endY) & (firstZ < endZ);
  if (!LaneBits(touched))
  {
    return;
  }
  const int lastX = MaxAmong(touched, endX) - 1;
  const int lastY = MaxAmong(touched, endY) - 1;
  const int lastZ = MaxAmong(touched, endZ) - 1;
  for (int z = MinAmong(touched, firstZ); z < lastZ + DEFORMVOLUME_PATCH; z += DEFORMVOLUME_PATCH)
  {
    for (int y = MinAmong(touched, firstY); y < lastY + DEFORMVOLUME_PATCH; y += DEFORMVOLUME_PATCH)
    {
      for (int x = MinAmong(touched, firstX); x < lastX + DEFORMVOLUME_PATCH;
           x += DEFORMVOLUME_PATCH)
      {
        Touch(min(x, lastX), min(y, lastY), min(z, lastZ), output, p);
      }
    }
  }
}

#if LANES > 1
// Prefetches the output at the first candidates of some lanes, long before it is written. The prefetch of FetchFound
// reaches the caches in time, but would be too late for memory.
static __attribute__((always_inline)) void FetchOutput(
  const PacketCandidates* c, const Output* output ARRAY_PARAMETERS)
{
  const uint* const voxels = (const uint*)&c->Voxel;
#pragma unroll
  for (int i = 0; i < 3; ++i)
  {
    const uint voxel = voxels[i * (LANES - 1) / 2];
    LANE_ARRAYS(FETCH_OUTPUT)
    PREFETCH_TO_WRITE(output->Coverage + voxel)
  }
}
#endif

// Finds the sizes of cells with these bounds.
static __attribute__((always_inline)) void MeasureCells(const Bounds* b, PacketCandidates* c)
{
  const FLOATS sizeX = b->HighX - b->LowX, sizeY = b->HighY - b->LowY, sizeZ = b->HighZ - b->LowZ;
  const FLOATS extent = Max(sizeX, Max(sizeY, sizeZ));
  const uint existing = LaneBits((b->LowX > 0.5f * NO_VERTEX) & (b->LowX < 0.5f * NO_SOURCE));
  c->Existing = existing;
  c->Extent = extent;
  c->BoundScale = extent * fma(sizeX, sizeY, sizeZ * (sizeX + sizeY));
  if (LaneBits(extent > EXACT_NORMALS_EXTENT) & existing)
  {
    c->BoundScale *= extent > EXACT_NORMALS_EXTENT ? (FLOATS)(INEXACT_NORMALS) : (FLOATS)(1.0f);
  }
}

// Finds aligned cells, if there are any. rises: as for FindAligned.
static __attribute__((always_inline)) void LookForAligned(
  PacketCandidates* c, INTS* aligned, INTS* rises, const KernelParameters* p)
{
  const Packet* const packet = &c->Cells;
  *aligned = 0;
  *rises = 0;
  // If no cell has two edges parallel to axes, there are no aligned cells. Lanes without a cell contain arbitrary
  // values and must not decide.
  uint alignedCells = c->Existing & FindAxialEdges(packet, 1);
  if (alignedCells)
  {
    alignedCells &= FindAxialEdges(packet, 2);
  }
  c->HasAligned = alignedCells != 0;
  if (c->HasAligned)
  {
    *aligned = FindAligned(packet, Mirror(packet->X, packet->Y, packet->Z, p), rises);
    c->HasAligned = (c->Existing & LaneBits(*aligned)) != 0;
  }
}

// The numbers that END_OF adds to the high sides of cells: 1 if samples on the high sides are candidates, otherwise
// ALMOST_ONE.
typedef struct
{
  FLOATS X, Y, Z;
} ToEnds;

// For a packet at the border: finds the whole cells, as bits; the cells that may be handled as aligned; the numbers
// that are added to the high sides of these; and aligned cells next to missing ones.
static __attribute__((always_inline)) void EndOnBorder(PacketCandidates* c, INTS rises,
  const SamplingMesh* mesh, uint* whole, INTS* aligned, ToEnds* toEnds, Output* output,
  const KernelParameters* p)
{
  const Packet* const packet = &c->Cells;
  PacketState* const state = &c->State;
  // Without states all cells that exist are whole.
  if (p->HasState || c->HasAligned)
  {
    StatesOfPacket(mesh, packet->X, packet->Y, packet->Z, state, p);
    *whole = c->Existing & LaneBits(state->Whole);
  }
  // Aligned cells at the border leave the samples on their high sides to the next cells, if these exist. This
  // requires that the high sides have the higher coordinates.
  if (!DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass) && c->HasAligned)
  {
    const INTS inner = state->Interior == 255;
    const INTS all = *aligned & LanesOf(c->Existing);
    *aligned = all & (inner | ((state->Regular == 255) & rises));
    c->NextToMissing = all & ~*aligned & rises;
    c->HasNextToMissing = LaneBits(c->NextToMissing) != 0;
    output->Assumed |= LaneBits(*aligned & ~inner) != 0;
    const INTS isLastX = packet->X + 2 * LANE_INDEX == p->Size[0] - 2;
    toEnds->X = (*aligned & ~isLastX) ? ALMOST_ONE : toEnds->X;
    toEnds->Y = (*aligned & (INTS)(packet->Y != p->Size[1] - 2 ? -1 : 0)) ? ALMOST_ONE : toEnds->Y;
    toEnds->Z = (*aligned & (INTS)(packet->Z != p->Size[2] - 2 ? -1 : 0)) ? ALMOST_ONE : toEnds->Z;
  }
}

// The samples within the bounds of cells.
typedef struct
{
  INTS FirstX, FirstY, FirstZ;
  INTS CountX, CountY, CountZ;
} SamplesInBounds;

static __attribute__((always_inline)) void FindSamples(
  const Bounds* b, const ToEnds* toEnds, SamplesInBounds* s, const KernelParameters* p)
{
  s->FirstX = FIRST_OF(b->LowX);
  s->FirstY = FIRST_OF(b->LowY);
  s->FirstZ = FIRST_OF(b->LowZ);
  s->CountX = END_OF(b->HighX, toEnds->X, p->OutputSize[0]) - s->FirstX;
  s->CountY = END_OF(b->HighY, toEnds->Y, p->OutputSize[1]) - s->FirstY;
  s->CountZ = END_OF(b->HighZ, toEnds->Z, p->OutputSize[2]) - s->FirstZ;
}

// Finds the samples in the whole output, if only a part of it is made. A cell that extends beyond the part must have
// the same candidates as in the whole output, so that results do not depend on where the part ends. Such a cell begins
// less than MAXIMUM_EXTENT before the part.
static __attribute__((always_inline)) void FindSamplesOfWhole(
  const Bounds* b, const ToEnds* toEnds, SamplesInBounds* s, const KernelParameters* p)
{
#define WHOLE_FIRST(low, axis)                                                                     \
  max(TO_INTS((low) + (MAXIMUM_EXTENT + ALMOST_ONE)) - (int)MAXIMUM_EXTENT,                        \
    (INTS)(max(p->WholeFirst[axis], -(int)MAXIMUM_EXTENT)))
#define WHOLE_END(high, toEnd, axis)                                                               \
  (TO_INTS(Min((high) + toEnd,                                                                   \
             (float)min(p->WholeEnd[axis], p->OutputSize[axis] + (int)MAXIMUM_EXTENT)) +           \
     MAXIMUM_EXTENT) -                                                                             \
    (int)MAXIMUM_EXTENT)
  s->FirstX = WHOLE_FIRST(b->LowX, 0);
  s->FirstY = WHOLE_FIRST(b->LowY, 1);
  s->FirstZ = WHOLE_FIRST(b->LowZ, 2);
  s->CountX = WHOLE_END(b->HighX, toEnds->X, 0) - s->FirstX;
  s->CountY = WHOLE_END(b->HighY, toEnds->Y, 1) - s->FirstY;
  s->CountZ = WHOLE_END(b->HighZ, toEnds->Z, 2) - s->FirstZ;
}

// Takes the samples within the bounds of cells as candidates. inPart: the samples in the part of the output that is
// made.
static __attribute__((always_inline)) void SetCandidates(const Bounds* b, const ToEnds* toEnds,
  const SamplesInBounds* inPart, PacketCandidates* c, const KernelParameters* p)
{
  // A cell that lies in the part has the same samples in the whole output.
  c->ExceedsPart = p->IsPart &&
    LaneBits((Min(b->LowX, Min(b->LowY, b->LowZ)) < 0.0f) |
      (inPart->FirstX + inPart->CountX == p->OutputSize[0]) |
      (inPart->FirstY + inPart->CountY == p->OutputSize[1]) |
      (inPart->FirstZ + inPart->CountZ == p->OutputSize[2]));
  SamplesInBounds s = *inPart;
  if (c->ExceedsPart)
  {
    FindSamplesOfWhole(b, toEnds, &s, p);
  }
  c->First[0] = s.FirstX;
  c->First[1] = s.FirstY;
  c->First[2] = s.FirstZ;
  c->Count[0] = s.CountX;
  c->Count[1] = s.CountY;
  c->Count[2] = s.CountZ;
  c->Voxel = (s.FirstZ * p->OutputSize[1] + s.FirstY) * p->OutputSize[0] + s.FirstX;
  c->Number = s.CountX * s.CountY * s.CountZ;
}

// Whether cells, as bits, touch no voxel that is still to be won.
static __attribute__((always_inline)) int IsSettled(
  uint cells, const SamplesInBounds* s, const Output* output, const KernelParameters* p)
{
  const INTS among = LanesOf(cells);
  const int first[3] = { MinAmong(among, s->FirstX), MinAmong(among, s->FirstY),
    MinAmong(among, s->FirstZ) };
  const int last[3] = { MaxAmong(among, s->FirstX + s->CountX - 1),
    MaxAmong(among, s->FirstY + s->CountY - 1), MaxAmong(among, s->FirstZ + s->CountZ - 1) };
  return !cells || !AnyUnsettled(output->Patches, first, last, p);
}

// Finds the candidates of a packet. b: the bounds of the cells. mesh: null if vertices have no state. withBorder:
// whether cells at the border are recognized; otherwise cells must be whole, and if HasAligned is set, the other
// results are not valid.
static __attribute__((always_inline)) void FindPacketCandidates(const Bounds* b,
  const SamplingMesh* mesh, int withBorder, Output* output, PacketCandidates* c,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  MeasureCells(b, c);
  INTS aligned, rises;
  LookForAligned(c, &aligned, &rises, p);

  // Candidates are half-open inside the mesh: by the fill rule no sample on the upper side is owned.
  const int border = c->Cells.Border;
  uint whole = c->Existing;
  c->HasNextToMissing = 0;
  const FLOATS toEnd = border || p->Pass != DEFORMVOLUME_PASS_DIRECT ? 1.0f : ALMOST_ONE;
  ToEnds toEnds = { toEnd, toEnd, toEnd };
  if (border && withBorder)
  {
    EndOnBorder(c, rises, mesh, &whole, &aligned, &toEnds, output, p);
  }
#if HAS_CUT
  if (c->Cells.Split)
  {
    whole &= ~FindDivided(mesh, c->Cells.X, c->Cells.Y, c->Cells.Z, p);
  }
#endif
  if (c->HasAligned && (!border || withBorder))
  {
    c->Aligned = aligned;
    if (p->Pass == DEFORMVOLUME_PASS_OWNERS)
    {
      if (!border)
      {
        toEnds.X = toEnds.Y = toEnds.Z = aligned ? (FLOATS)(ALMOST_ONE) : (FLOATS)(1.0f);
      }
      TouchAligned(LanesOf(c->Existing) & aligned, b, output, p);
    }
  }
  SamplesInBounds s;
  FindSamples(b, &toEnds, &s, p);
  const uint withCandidates = c->Existing & LaneBits((s.CountX > 0) & (s.CountY > 0) & (s.CountZ > 0));
  // If a cut divides cells, these extend beyond the bounds of their vertices.
  const int isDivided = HAS_CUT && (c->Existing & ~whole);
  c->Skip = DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass) && !isDivided && IsSettled(withCandidates, &s, output, p);
  SetCandidates(b, &toEnds, &s, c, p);
  c->Simple = whole & LaneBits(c->Extent < MAXIMUM_EXTENT) &
    ~(withCandidates & LaneBits(c->Number > MAXIMUM_CANDIDATES));
  c->WithCandidates = withCandidates & c->Simple;
}

#if LANES > 1
// Finds the candidates of the two packets at slot k of a row of cells, for even and for odd x. Cells of the second
// packet begin at the odd vertices. even: input: bounds of the quads of even x from slot k on; output: from slot k +
// LANES on. output: counts the packets of the span.
static COLD void FindPairCandidates(const RowOfCells* row, int k, Bounds* even,
  const SamplingMesh* mesh, Output* output, PacketCandidates* candidates,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  Bounds odd, behind, cells;
  BoundQuads(row->Rows, k + ODD, &odd);
  BoundQuads(row->Rows, k + LANES, &behind);
  MakePacket(row, k, 0, &candidates[0].Cells);
  Join(even, &odd, &cells);
  FindPacketCandidates(&cells, mesh, 1, output, candidates, p ARRAY_ARGUMENTS);
  MakePacket(row, k, 1, &candidates[1].Cells);
  Shift(even, &behind, &cells);
  Join(&cells, &odd, &cells);
  FindPacketCandidates(&cells, mesh, 1, output, candidates + 1, p ARRAY_ARGUMENTS);
  *even = behind;
}
#endif
