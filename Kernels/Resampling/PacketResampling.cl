// SPDX-License-Identifier: BSD-3-Clause
// Resamples a packet of cells: by floats where the sign of a barycentric coordinate is certain (PacketWeights.cl),
// otherwise by integers (PacketCoverage.cl).
//
// Cells with a sample that floats do not decide are repeated with edge functions in 32-bit integers, again for LANES
// cells at once (NeedsInt32). Cells that are bent, or that lack surrounding cells, are handed to ResampleCell, which
// uses 64-bit integers (NeedsInt64). Cells too large for 32-bit integers only hand over their undecided samples
// (SamplesNeedInt64): they have many samples, and floats decide nearly all of them.

// The outcome for LANES cells, as bits.
typedef struct
{
  uint NeedsInt32;       // cells to repeat with 32-bit integers
  uint NeedsInt64;       // cells for ResampleCell, which uses 64-bit integers
  uint SamplesNeedInt64; // cells with undecided samples for ResampleSamples
} Outcome;

// The samples that floats do not decide: for each round with such samples, the number of the round, and the bits of
// the cells in the lower 16 bits.
typedef struct
{
  uint Rounds[MAXIMUM_CANDIDATES];
  uint Count;
} UndecidedSamples;

// Decides samples on the four edges of a cell along an axis, if these edges are parallel to the axis (ParallelEdges),
// inside the mesh. Such a cell is bounded by planes on the other two axes. Shifts along these axes lead into the cell
// from its low sides and out of it from its high sides. So of the four edges the cell owns the part of the lowest one
// between its ends. At an end of an edge along x, the shift along x decides, as it comes first. At an end of an edge
// along another axis, the face there may be bent, and the sample is not decided. x, y, z: the samples, in output
// voxels. Returns the bits of cells that own their sample, and removes the decided cells from undecidedByFloats.
static __attribute__((noinline)) uint DecideOnEdges(const Packet* packet, const PacketFrame* f,
  const ParallelEdges* edges, FLOATS x, FLOATS y, FLOATS z, uint* undecidedByFloats, INTS* onVertex,
  const KernelParameters* p)
{
  const int mirror = Mirror(packet->X, packet->Y, packet->Z, p);
  const INTS lowX = x == Min(f->X0, f->X7), onX = lowX | (x == Max(f->X0, f->X7));
  const INTS lowY = y == Min(f->Y0, f->Y7), onY = lowY | (y == Max(f->Y0, f->Y7));
  const INTS lowZ = z == Min(f->Z0, f->Z7), onZ = lowZ | (z == Max(f->Z0, f->Z7));
#define FROM(slot) VERTEX(mirror, slot)
  const INTS alongX = edges->X & onY & onZ;
  const INTS ownsX = alongX & lowY & lowZ & (x >= FROM(0)) & (x < VERTEX(mirror ^ 1, 0));
  const INTS alongY = edges->Y & onX & onZ & ~alongX;
  const INTS lowestY = alongY & lowX & lowZ;
  const INTS endsY = lowestY & ((y == FROM(1)) | (y == VERTEX(mirror ^ 4, 1)));
  const INTS ownsY = lowestY & (y > FROM(1)) & (y < VERTEX(mirror ^ 4, 1));
  const INTS alongZ = edges->Z & onX & onY & ~alongX & ~alongY;
  const INTS lowestZ = alongZ & lowX & lowY;
  const INTS endsZ = lowestZ & ((z == FROM(2)) | (z == VERTEX(mirror ^ 2, 2)));
  const INTS ownsZ = lowestZ & (z > FROM(2)) & (z < VERTEX(mirror ^ 2, 2));
  const uint decided =
    *undecidedByFloats & LaneBits((alongX | alongY | alongZ) & ~endsY & ~endsZ);
  *undecidedByFloats &= ~decided;
  *onVertex |= ownsX & (x == FROM(0)) & LanesOf(decided);
#undef FROM
  return decided & LaneBits(ownsX | ownsY | ownsZ);
}

// The result of a packet's rounds. In each round every lane visits one of its candidates.
typedef struct
{
  uint Count;
  uint Writes;    // number of samples found
  uint NeedsNextStep;   // bits of cells with a sample that this step of the exactness chain does not decide
  uint UndecidedRounds; // number of rounds in undecidedSamples
} Rounds;

// Finds cells inside the mesh with edges for DecideOnEdges. Returns whether there are any.
static __attribute__((noinline)) int LookForEdges(const Packet* packet, const PacketFrame* frame,
  const SamplingMesh* mesh, ParallelEdges* edges, const KernelParameters* p)
{
  INTS inside = LanesOf(frame->Decidable) & ~frame->Inverted;
  if (packet->Border)
  {
    PacketState state;
    StatesOfPacket(mesh, packet->X, packet->Y, packet->Z, &state, p);
    inside &= state.Interior == 255;
  }
  FindParallelEdges(packet, Mirror(packet->X, packet->Y, packet->Z, p), edges);
  edges->X &= inside;
  edges->Y &= inside;
  edges->Z &= inside;
  return LaneBits(edges->X | edges->Y | edges->Z) != 0;
}

// Visits the candidates of cells, given as bits. hits: output: the bits of cells with a sample in each round.
// Other parameters are as for ResamplePacket.
static __attribute__((always_inline)) void VisitCandidates(const PacketCandidates* c,
  const PacketFrame* frame, uint cells, const PacketState* state, const SamplingMesh* mesh, Output* output,
  Found* found, UndecidedSamples* undecidedSamples, ushort* hits, Rounds* rounds,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const Packet* const packet = &c->Cells;
  // Aligned cells own all of their candidates, whatever the second smallest weight, which decides otherwise.
  const int hasAligned = c->HasAligned;
  FLOATS threshold = frame->Bound;
  INTS aligned = 0;
  if (hasAligned)
  {
    aligned = LanesOf(frame->Decidable) & c->Aligned;
    threshold = aligned ? (FLOATS)(-INFINITY) : frame->Bound;
  }
  PacketScales scales;
  FindScales(frame, &scales);
  Walk at;
  BeginWalk(c, frame, &at, p);
  uint kept = found->Count;
  ParallelEdges edges;
  int hasEdges = !state && p->Pass == DEFORMVOLUME_PASS_DIRECT ? -1 : 0; // -1: unknown
  for (;;)
  {
    SampleWeights weights;
    WeighSamples(frame, &scales, at.X, at.Y, at.Z, &weights);
    uint undecidedByFloats;
    uint held = DecideByFloats(&weights, cells, threshold, frame->Bound, &undecidedByFloats);
    INTS onVertex = 0;
    if (c->HasNextToMissing && !state)
    {
      const INTS atGap = LanesOf(cells) & c->NextToMissing & IsOnVertex(frame, &at);
      const uint decided = LaneBits(atGap);
      if (decided)
      {
        undecidedByFloats &= ~decided;
        held = (held & ~decided) |
          DecideOnVertices(packet, decided, VerticesAt(frame, &at), &c->State, at.X + frame->X0,
            at.Y + frame->Y0, at.Z + frame->Z0, mesh, output, p);
        onVertex = atGap;
      }
    }
    if (undecidedByFloats && hasEdges)
    {
      if (hasEdges < 0)
      {
        hasEdges = LookForEdges(packet, frame, mesh, &edges, p);
      }
      if (hasEdges)
      {
        held |= DecideOnEdges(packet, frame, &edges, at.X + frame->X0, at.Y + frame->Y0,
          at.Z + frame->Z0, &undecidedByFloats, &onVertex, p);
      }
    }
    if (undecidedByFloats && state)
    {
      const FLOATS sample[3] = { at.X, at.Y, at.Z };
      held |= DecideByIntegers(
        packet, undecidedByFloats, sample, frame->Inverted, state, &onVertex, &rounds->NeedsNextStep, output, p);
    }
    else if (undecidedByFloats)
    {
      rounds->NeedsNextStep |= undecidedByFloats;
      undecidedSamples->Rounds[rounds->UndecidedRounds++] = rounds->Count << 16 | undecidedByFloats;
    }
    if (c->ExceedsPart)
    {
      held &= InOutput(at.X + frame->X0, at.Y + frame->Y0, at.Z + frame->Z0, p);
    }
    if (hasAligned)
    {
      onVertex |= aligned & IsOnVertex(frame, &at);
    }
    if (hasAligned || state || hasEdges > 0)
    {
      SnapWeights(onVertex, frame, &weights);
    }
    hits[rounds->Count] = held;
    rounds->Writes += popcount(held);
    KeepSamples(packet, held, at.Voxel, frame->Inverted, &weights, found, &kept, output,
      p ARRAY_ARGUMENTS);
    cells &= LaneBits(c->Number > (int)++rounds->Count);
    if (!cells)
    {
      break;
    }
    Advance(&at);
  }
  found->Count = kept;
  if (KEEPS_PACKET(p))
  {
    StoreFound(found, packet, output, p ARRAY_ARGUMENTS);
  }
}

// Resamples a packet of cells. state: if not null, 32-bit integers decide what floats do not, for the cells in `only`
// (bits); it is the state of the packet at the border. If null, such samples are added to undecidedSamples. mesh:
// needed if state is null. Writes of cells that must be repeated are not counted.
static __attribute__((always_inline)) void ResamplePacket(
  const PacketCandidates* c, uint only, const PacketState* state, const SamplingMesh* mesh,
  Output* output, Found* found, UndecidedSamples* undecidedSamples, Outcome* outcome,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const int exact = state != 0;
  const uint existing = exact ? c->Existing & only : c->Existing;
  PacketFrame frame;
  MakePacketFrame(c, c->Simple & existing, &frame);
  const uint bent = existing & ~frame.Decidable;
  ushort hits[MAXIMUM_CANDIDATES];
  Rounds rounds = { 0, 0, 0, 0 };
  const uint visited = c->WithCandidates & frame.Decidable;
  if (visited)
  {
    VisitCandidates(
      c, &frame, visited, state, mesh, output, found, undecidedSamples, hits, &rounds, p ARRAY_ARGUMENTS);
  }
  uint needsNextStep = rounds.NeedsNextStep;
  outcome->SamplesNeedInt64 = 0;
  if (!exact && needsNextStep)
  {
    undecidedSamples->Count = rounds.UndecidedRounds;
    outcome->SamplesNeedInt64 = needsNextStep & ~LaneBits(c->Extent < MAXIMUM_EXACT_EXTENT);
    needsNextStep ^= outcome->SamplesNeedInt64;
  }
  output->Inverted += 5 * popcount(frame.InvertedBits & frame.Decidable & ~needsNextStep);
  const uint repeated = bent | needsNextStep;
  if (repeated)
  {
    // These cells will write their samples again. The samples must not be counted twice.
    for (uint i = 0; i < rounds.Count; ++i)
    {
      rounds.Writes -= popcount(hits[i] & repeated);
    }
  }
  output->Writes += rounds.Writes;
  // 32-bit integers decide ownership only, so not in passes with closed tetrahedra.
  outcome->NeedsInt32 = exact || DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass) ? 0 : needsNextStep;
  outcome->NeedsInt64 = repeated & ~outcome->NeedsInt32;
}

static __attribute__((noinline)) Outcome ResampleByFloats(
  const PacketCandidates* c, const SamplingMesh* mesh, Output* output, Found* found, UndecidedSamples* undecidedSamples,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  Outcome outcome;
  ResamplePacket(c, 0, 0, mesh, output, found, undecidedSamples, &outcome, p ARRAY_ARGUMENTS);
  return outcome;
}

// Resamples the cells in `only` by 32-bit integers. Returns the bits of the cells for ResampleCell.
static __attribute__((noinline)) uint ResampleByIntegers(
  const PacketCandidates* c, uint only, const SamplingMesh* mesh, Output* output, Found* found,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  PacketState state;
  if (c->Cells.Border)
  {
    StatesOfPacket(mesh, c->Cells.X, c->Cells.Y, c->Cells.Z, &state, p);
  }
  Outcome outcome;
  ResamplePacket(c, only, &state, 0, output, found, 0, &outcome, p ARRAY_ARGUMENTS);
  return outcome.NeedsInt64;
}

// Resamples the samples that floats leave undecided, of cells, given as bits, from beginX to endX.
static __attribute__((noinline)) void ResampleUndecided(const PacketCandidates* c,
  const UndecidedSamples* undecidedSamples, uint wanted, int beginX, int endX, const SamplingMesh* mesh, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  Lanes first[3], count[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    first[axis].Vector = c->First[axis];
    count[axis].Vector = c->Count[axis];
  }
  Neighbors near[LANES];
  Cell cells[LANES];
  SamplingMesh keeping = *mesh;
  const Candidates all = AllCandidates(p);
  uint begun = 0; // bits of lanes whose cell was made
  uint made = 0;  // bits of lanes whose cell may have samples
  // Inverted cells were counted before.
  const uint inverted = output->Inverted;
  for (uint i = 0; i < undecidedSamples->Count; ++i)
  {
    const int round = undecidedSamples->Rounds[i] >> 16;
    uint here = undecidedSamples->Rounds[i] & wanted;
    FOR_EACH_LANE(lane, here)
    {
      const int cell = c->Cells.X + 2 * lane;
      const int width = count[0].Lanes[lane], height = count[1].Lanes[lane];
      const int x = first[0].Lanes[lane] + round % width;
      const int y = first[1].Lanes[lane] + round / width % height;
      const int z = first[2].Lanes[lane] + round / (width * height);
      if (cell < beginX || cell >= endX || x < 0 || x >= p->OutputSize[0] || y < 0 ||
        y >= p->OutputSize[1] || z < 0 || z >= p->OutputSize[2])
      {
        continue;
      }
      const Vector voxel = { x + p->OutputFirst[0], y + p->OutputFirst[1], z + p->OutputFirst[2] };
      const Candidates only = { voxel, voxel };
      // In passes with closed tetrahedra, MakeCell tests the sample and not the whole cell.
      const int isClosed = DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass);
      if (!(begun >> lane & 1) || isClosed)
      {
        keeping = KeepNeighbors(mesh, cell, c->Cells.Y, c->Cells.Z, near + lane);
        // A whole cell is not divided, so there are no views.
        const int hasSamples = MakeCell(&keeping, cell, c->Cells.Y, c->Cells.Z,
                                 isClosed ? &only : &all, cells + lane, 0, output, p) &&
          !IsDeferred(cells + lane, &only, output, p);
        begun |= 1u << lane;
        made = (made & ~(1u << lane)) | (uint)hasSamples << lane;
      }
      if (made >> lane & 1)
      {
        keeping.Near = near + lane;
        ResampleSamples(&keeping, cells + lane, &only, output, p ARRAY_ARGUMENTS);
      }
    }
  }
  output->Inverted = inverted;
}
