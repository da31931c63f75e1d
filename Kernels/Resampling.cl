// SPDX-License-Identifier: BSD-3-Clause
// Resampling: rasterises the five tetrahedra of each cell of the sampling mesh into the output, by
// the fill rule of CellCoverage.cl, for all arrays of the volume in one pass over the geometry.
//
// Data: what the mapping needs (DeformationMapping.cl), state 1 byte a vertex, active
// tetrahedra 1 byte a cell (optional), coverage 1 byte an output voxel, winners 4 or 8 bytes an
// output voxel (only where tetrahedra overlap), and the arrays themselves in their own types.
//
// A work-group takes a block of cells: it maps the block's vertices into local memory, once each, and
// then a work-item takes a cell, neighbours side by side. Almost all cells are convex enough that a sample
// needs the central tetrahedron's edge functions and at most those of the corner behind a face; the others
// try each tetrahedron.
//
// What the host puts in front of this text:
//   REAL                 type of the interpolation: double where the device has it, else float
//   KEY, ATOMIC_MIN,     type of the winner's key, and its minimum and conditional exchange
//   ATOMIC_CMPXCHG
//   ARRAY_PARAMETERS     kernel parameters: source and target of each array
//   ARRAY_ARGUMENTS      the same as arguments
//   STORE_ARRAYS         statements that store all arrays at a sample

// One sample of one tetrahedron.
typedef struct
{
  size_t Target;    // output voxel in the buffers
  size_t Sources[4]; // voxels of the chunk at the tetrahedron's vertices
  REAL Weights[4];  // barycentric weights
  int Only;         // the vertex at which the sample lies exactly, or -1
  int Nearest;      // the vertex with the largest weight; of equal ones the lowest voxel
} Sample;

// Vertices without weight are not read into the sum: a NaN stays within its tetrahedra. A sample at
// a vertex takes its value as it is, bit for bit.
#define STORE_LINEAR(SOURCE, TARGET, COMPONENTS, CONVERT)                                          \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    if (s->Only >= 0)                                                                              \
    {                                                                                              \
      TARGET[s->Target * COMPONENTS + c] = SOURCE[s->Sources[s->Only] * COMPONENTS + c];           \
    }                                                                                              \
    else                                                                                           \
    {                                                                                              \
      REAL sum = 0;                                                                                \
      for (int k = 0; k < 4; ++k)                                                                  \
      {                                                                                            \
        sum += s->Weights[k] > 0                                                                   \
          ? s->Weights[k] * (REAL)SOURCE[s->Sources[k] * COMPONENTS + c]                           \
          : (REAL)0;                                                                               \
      }                                                                                            \
      TARGET[s->Target * COMPONENTS + c] = CONVERT(sum);                                           \
    }                                                                                              \
  }

// Integers of 64 bits do not fit into REAL: what is interpolated is the difference to the first
// vertex, which is exact wherever the values are near to each other.
#define STORE_LINEAR_64(SOURCE, TARGET, COMPONENTS, TYPE, CONVERT)                                 \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    const TYPE first = SOURCE[s->Sources[s->Only >= 0 ? s->Only : 0] * COMPONENTS + c];            \
    TYPE value = first;                                                                            \
    if (s->Only < 0)                                                                               \
    {                                                                                              \
      REAL sum = (REAL)first;                                                                      \
      REAL difference = 0;                                                                         \
      int near = 1;                                                                                \
      for (int k = 1; k < 4; ++k)                                                                  \
      {                                                                                            \
        const TYPE other = SOURCE[s->Sources[k] * COMPONENTS + c];                                 \
        near &= abs_diff(other, first) < (1UL << 62);                                              \
        difference += s->Weights[k] * (REAL)(long)((ulong)other - (ulong)first);                   \
        sum += s->Weights[k] * ((REAL)other - (REAL)first);                                        \
      }                                                                                            \
      value = near ? (TYPE)((ulong)first + (ulong)convert_long_rte(difference)) : CONVERT(sum);    \
    }                                                                                              \
    TARGET[s->Target * COMPONENTS + c] = value;                                                    \
  }

#define STORE_NEAREST(SOURCE, TARGET, COMPONENTS)                                                  \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    TARGET[s->Target * COMPONENTS + c] = SOURCE[s->Sources[s->Nearest] * COMPONENTS + c];          \
  }

static void StoreArrays(const Sample* s ARRAY_PARAMETERS)
{
  STORE_ARRAYS
}

typedef struct
{
  __global char* Coverage;
  __global KEY* Winners;
  __global char* Patches; // what is known of them
  // Counts of this work-item.
  uint Writes;
  uint Inverted;
  uint Overstretched;
  uint Missing; // cells on the border with a tetrahedron that is flat or left out
  uint Assumed; // whether cells on the border left samples to the next cells without looking at these
  uint Candidates; // voxels that were won, as far as others had marked them by then
  uint Touched; // nonzero where samples are held that others write, or none
} Output;

// Of overlapping tetrahedra upright ones win, then the lowest cell. Within a cell the order of
// writing decides, the lowest tetrahedron last. The key of a voxel that is contested has the highest bit: so it is
// more than those of settled voxels.
#define CONTESTED ((KEY)1 << (sizeof(KEY) * 8 - 1))

static KEY MakeKey(int x, int y, int z, int inverted, const KernelParameters* p)
{
  const KEY cell = ((KEY)z * (p->Size[1] - 1) + y) * (p->Size[0] - 1) + x;
  return cell | (KEY)(inverted != 0) << (sizeof(KEY) * 8 - 2) |
    (DEFORMVOLUME_IS_CLOSED(p->Pass) ? CONTESTED : 0);
}

// A cell that writes a voxel leaves its key there: the first one, or the lowest, which has the voxel then contested.
// Returns whether the voxel is the cell's so far.
static int Claim(__global KEY* winner, KEY key)
{
  const KEY none = (KEY)-1;
  KEY found = *winner;
  for (;;)
  {
    const KEY lowest = found & ~CONTESTED;
    const int wins = found == none || key <= lowest;
    if (lowest == key || (!wins && lowest != found))
    {
      return wins;
    }
    const KEY next = found == none ? key : CONTESTED | min(key, lowest);
    const KEY seen = ATOMIC_CMPXCHG(winner, found, next);
    if (seen == found)
    {
      return wins;
    }
    found = seen;
  }
}

// What passes but the first do with a voxel that a cell writes. Returns whether values are to follow.
static int TakesPlace(Output* output, size_t target, KEY key, const KernelParameters* p)
{
  __global KEY* winner = output->Winners + target;
  const KEY found = *winner;
  if (p->Pass == DEFORMVOLUME_PASS_WINNER)
  {
    return found == key;
  }
  if (p->Pass == DEFORMVOLUME_PASS_MARK)
  {
    if (found > key)
    {
      ATOMIC_MIN(winner, key);
      output->Candidates++;
    }
    return 0;
  }
  return Claim(winner, key);
}

// The weights and their sum as the edge functions give them.
static Sample MakeSample(int x, int y, int z, int t, const long* weights, long volume,
  size_t target, const KernelParameters* p)
{
  const int mirror = Mirror(x, y, z, p);
  const REAL scale = (REAL)1 / (REAL)volume;
  Sample s;
  s.Target = target;
  s.Only = -1;
  s.Nearest = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int o = Tetrahedra[t][k] ^ mirror;
    s.Sources[k] = VertexInChunk(x + (o & 1), y + (o >> 2), z + (o >> 1 & 1), p);
    s.Weights[k] = (REAL)weights[k] * scale;
    s.Only = weights[k] == volume ? k : s.Only;
    const long lead = weights[k] - weights[s.Nearest];
    s.Nearest =
      lead > 0 || (lead == 0 && s.Sources[k] < s.Sources[s.Nearest]) ? k : s.Nearest;
  }
  return s;
}

// Whether in one of the patches that hold the voxels of the output from first to last there is work for a pass.
static int AnyUnsettled(
  __global const char* patches, const int* first, const int* last, const KernelParameters* p)
{
  // What cells own has been claimed before.
  const char wanted = DEFORMVOLUME_PATCH_UNSETTLED |
    (p->Pass == DEFORMVOLUME_PASS_MARK ? DEFORMVOLUME_PATCH_TOUCHED : 0);
  for (int z = first[2] / DEFORMVOLUME_PATCH; z <= last[2] / DEFORMVOLUME_PATCH; ++z)
  {
    for (int y = first[1] / DEFORMVOLUME_PATCH; y <= last[1] / DEFORMVOLUME_PATCH; ++y)
    {
      __global const char* row = patches + PatchRow(y * DEFORMVOLUME_PATCH, z * DEFORMVOLUME_PATCH, p);
      for (int x = first[0] / DEFORMVOLUME_PATCH; x <= last[0] / DEFORMVOLUME_PATCH; ++x)
      {
        if ((row[x] & wanted) == wanted)
        {
          return 1;
        }
      }
    }
  }
  return 0;
}

// A cell holds a voxel of the output that it does not own. If there turns out to be a winner, it may be this cell.
static void Touch(int x, int y, int z, Output* output, const KernelParameters* p)
{
  output->Patches[PatchRow(y, z, p) + x / DEFORMVOLUME_PATCH] = DEFORMVOLUME_PATCH_TOUCHED;
  output->Touched = 1;
}

static void Write(int x, int y, int z, int t, const long* weights, long volume, int inverted,
  Vector voxel, int role, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  const int placeX = voxel.x - p->OutputFirst[0];
  const int placeY = voxel.y - p->OutputFirst[1];
  const int placeZ = voxel.z - p->OutputFirst[2];
  if (role == HOLDER)
  {
    if (p->Pass == DEFORMVOLUME_PASS_OWNERS)
    {
      Touch(placeX, placeY, placeZ, output, p);
    }
    return;
  }
  const size_t target =
    ((size_t)placeZ * p->OutputSize[1] + placeY) * p->OutputSize[0] + placeX;
  output->Writes++;
  if (p->Pass != DEFORMVOLUME_PASS_DIRECT &&
    !TakesPlace(output, target, MakeKey(x, y, z, inverted, p), p))
  {
    return;
  }
  const Sample s = MakeSample(x, y, z, t, weights, volume, target, p);
  output->Coverage[target] = 1;
  StoreArrays(&s ARRAY_ARGUMENTS);
}

// The output voxels that may lie within some bounds in 1/256 voxel; closed where the bounds count.
typedef struct
{
  Vector Low, High;
} Candidates;

static Candidates FindCandidates(Vector low, Vector high, int open, const KernelParameters* p)
{
  Candidates c;
  c.Low.x = max((low.x + 255) >> 8, (long)p->OutputFirst[0]);
  c.Low.y = max((low.y + 255) >> 8, (long)p->OutputFirst[1]);
  c.Low.z = max((low.z + 255) >> 8, (long)p->OutputFirst[2]);
  c.High.x = min((high.x - open) >> 8, (long)p->OutputFirst[0] + p->OutputSize[0] - 1);
  c.High.y = min((high.y - open) >> 8, (long)p->OutputFirst[1] + p->OutputSize[1] - 1);
  c.High.z = min((high.z - open) >> 8, (long)p->OutputFirst[2] + p->OutputSize[2] - 1);
  return c;
}

// Those of a cell whose vertices are all there.
static Candidates CandidatesOfCell(const Vector* q, int open, const KernelParameters* p)
{
  Vector low = q[0];
  Vector high = q[0];
  for (int v = 1; v < 8; ++v)
  {
    low = Minimum(low, q[v]);
    high = Maximum(high, q[v]);
  }
  return FindCandidates(low, high, open, p);
}

static int IsEmpty(Candidates c)
{
  return c.Low.x > c.High.x || c.Low.y > c.High.y || c.Low.z > c.High.z;
}

#define FOR_EACH_CANDIDATE(voxel, c)                                                               \
  for (voxel.z = c.Low.z; voxel.z <= c.High.z; ++voxel.z)                                          \
    for (voxel.y = c.Low.y; voxel.y <= c.High.y; ++voxel.y)                                        \
      for (voxel.x = c.Low.x; voxel.x <= c.High.x; ++voxel.x)

static Vector SamplePosition(Vector voxel)
{
  const Vector r = { voxel.x * 256, voxel.y * 256, voxel.z * 256 };
  return r;
}

// A cell whose tetrahedra are all there and upright: a sample behind no face of the central
// tetrahedron is in it, and a corner tetrahedron holds only samples behind its face.
static void ResampleUprightCell(const SamplingMesh* mesh, int x, int y, int z, const Vector* q,
  CellState state, Candidates c, Output* output, const KernelParameters* p ARRAY_PARAMETERS)
{
  const EdgeFunctions central = MakeEdgeFunctions(
    q[Tetrahedra[4][0]], q[Tetrahedra[4][1]], q[Tetrahedra[4][2]], q[Tetrahedra[4][3]]);
  Vector voxel;
  FOR_EACH_CANDIDATE(voxel, c)
  {
    const Vector sample = SamplePosition(voxel);
    long behind[4];
    Evaluate(&central, sample, behind);
    const int role = RoleOf(mesh, x, y, z, 4, behind, &central, state, p);
    if (role != STRANGER)
    {
      Write(x, y, z, 4, behind, central.Volume, 0, voxel, role, output, p ARRAY_ARGUMENTS);
    }
    if (role == OWNER)
    {
      continue;
    }
    for (int k = 0; k < 4; ++k)
    {
      if (behind[k] > 0)
      {
        continue;
      }
      const int t = CornerBehindFace[k];
      const EdgeFunctions corner = MakeEdgeFunctions(
        q[Tetrahedra[t][0]], q[Tetrahedra[t][1]], q[Tetrahedra[t][2]], q[Tetrahedra[t][3]]);
      long weights[4];
      Evaluate(&corner, sample, weights);
      const int roleOfCorner = RoleOf(mesh, x, y, z, t, weights, &corner, state, p);
      if (roleOfCorner != STRANGER)
      {
        Write(x, y, z, t, weights, corner.Volume, 0, voxel, roleOfCorner, output,
          p ARRAY_ARGUMENTS);
      }
      if (roleOfCorner == OWNER)
      {
        break;
      }
    }
  }
}

// Any cell: each tetrahedron on its own. The lowest one last, because the last one to write wins.
static void ResampleTetrahedra(const SamplingMesh* mesh, int x, int y, int z, const Vector* q,
  const long* determinants, int tetrahedra, int inverted, CellState state, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  for (int t = 4; t >= 0; --t)
  {
    if (!(tetrahedra >> t & 1) || determinants[t] == 0)
    {
      continue;
    }
    const Vector a = q[Tetrahedra[t][0]];
    const Vector b = q[Tetrahedra[t][1]];
    const Vector c = q[Tetrahedra[t][2]];
    const Vector d = q[Tetrahedra[t][3]];
    const Candidates candidates = FindCandidates(Minimum(Minimum(a, b), Minimum(c, d)),
      Maximum(Maximum(a, b), Maximum(c, d)), 0, p);
    if (IsEmpty(candidates))
    {
      continue;
    }
    const EdgeFunctions f = MakeEdgeFunctions(a, b, c, d);
    Vector voxel;
    FOR_EACH_CANDIDATE(voxel, candidates)
    {
      long weights[4];
      Evaluate(&f, SamplePosition(voxel), weights);
      const int role = RoleOf(mesh, x, y, z, t, weights, &f, state, p);
      if (role != STRANGER)
      {
        Write(x, y, z, t, weights, f.Volume, inverted >> t & 1, voxel, role, output,
          p ARRAY_ARGUMENTS);
      }
    }
  }
}

// Whether the bounds of a cell meet a patch of the output with voxels that are not settled.
static int TouchesUnsettled(const Vector* q, const Output* output, const KernelParameters* p)
{
  const Candidates c = CandidatesOfCell(q, 0, p);
  if (IsEmpty(c))
  {
    return 0;
  }
  const int first[3] = { c.Low.x - p->OutputFirst[0], c.Low.y - p->OutputFirst[1],
    c.Low.z - p->OutputFirst[2] };
  const int last[3] = { c.High.x - p->OutputFirst[0], c.High.y - p->OutputFirst[1],
    c.High.z - p->OutputFirst[2] };
  return AnyUnsettled(output->Patches, first, last, p);
}

// One cell, by whichever of the two ways is right for it.
static void ResampleCell(const SamplingMesh* mesh, int x, int y, int z, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  Vector q[8];
  const int present = LoadCell(mesh, x, y, z, p, q);
  int tetrahedra = ActiveTetrahedra(mesh, x, y, z, p);
  if (present == 0 || tetrahedra == 0)
  {
    return;
  }
  if (DEFORMVOLUME_IS_CLOSED(p->Pass) && present == 255 && !TouchesUnsettled(q, output, p))
  {
    return;
  }
  const int mirror = Mirror(x, y, z, p);
  const CellState state = CellStateOf(mesh, x, y, z, p);
  // Orientations, against the one that the parity of the cell asks for.
  const int odd = (mirror ^ mirror >> 1 ^ mirror >> 2) & 1;
  long determinants[5];
  int inverted = 0;
  int missing = 0;
  int regular = tetrahedra == 31 && present == 255;
  for (int t = 0; t < 5; ++t)
  {
    determinants[t] = 0;
    const int needed = VerticesOf(t);
    if (!(tetrahedra >> t & 1) || (present & needed) != needed)
    {
      regular = 0;
      continue;
    }
    const Vector a = q[Tetrahedra[t][0]];
    const Vector b = q[Tetrahedra[t][1]];
    const Vector c = q[Tetrahedra[t][2]];
    const Vector d = q[Tetrahedra[t][3]];
    if (IsOverstretched(a, b, c, d))
    {
      ++output->Overstretched;
      tetrahedra &= ~(1 << t);
      regular = 0;
      missing = 1;
      continue;
    }
    determinants[t] = Determinant(a, b, c, d);
    const int upright = odd != (t == 4) ? determinants[t] < 0 : determinants[t] > 0;
    regular &= upright;
    inverted |= (!upright && determinants[t] != 0) << t;
    missing |= determinants[t] == 0;
  }
  output->Inverted += popcount(inverted);
  output->Missing += missing && state.Interior != 255;
  output->Assumed |= (state.Regular & ~state.Interior) != 0;
  if (regular)
  {
    // Where all ties are decided by the shift, no sample on the upper bounds is ever taken.
    const Candidates c =
      CandidatesOfCell(q, state.Interior == 255 && p->Pass == DEFORMVOLUME_PASS_DIRECT, p);
    if (!IsEmpty(c))
    {
      ResampleUprightCell(mesh, x, y, z, q, state, c, output, p ARRAY_ARGUMENTS);
    }
  }
  else
  {
    ResampleTetrahedra(mesh, x, y, z, q, determinants, tetrahedra, inverted, state, output,
      p ARRAY_ARGUMENTS);
  }
}

// Adds counts to those of a section of a brick.
static void AddCounts(
  const Output* output, size_t section, __global uint* counters, const KernelParameters* p)
{
  const uint counts[DEFORMVOLUME_COUNTERS] = { output->Writes, output->Inverted,
    output->Overstretched, output->Missing, output->Assumed, output->Candidates,
    output->Touched };
  for (int i = 0; i < DEFORMVOLUME_COUNTERS; ++i)
  {
    // The passes that come later count nothing again.
    if (counts[i] && (i == DEFORMVOLUME_COUNT_CANDIDATES || !DEFORMVOLUME_IS_CLOSED(p->Pass)))
    {
      atomic_add(counters + section * DEFORMVOLUME_COUNTERS + i, counts[i]);
    }
  }
}

// A work-group takes a block of cells. positions: room for three ints a vertex of the block.
__kernel void Resample(MAPPING_PARAMETERS, __global const uchar* state,
  __global const uchar* active, __global char* coverage, __global KEY* winners,
  __global char* patches, __global uint* counters, __local int* positions,
  const KernelParameters p ARRAY_PARAMETERS)
{
  const int first[3] = { get_group_id(0) * DEFORMVOLUME_BLOCK_X,
    get_group_id(1) * DEFORMVOLUME_BLOCK_Y, p.LayersBegin + get_group_id(2) * DEFORMVOLUME_BLOCK_Z };
  const SamplingMesh unmapped = { MAPPING_ARGUMENTS, state, active, 0, { 0, 0, 0 } };
  const int width = DEFORMVOLUME_BLOCK_X + 1;
  const int height = DEFORMVOLUME_BLOCK_Y + 1;
  for (int i = get_local_id(0); i < DEFORMVOLUME_BLOCK_VERTICES; i += get_local_size(0))
  {
    const int x = first[0] + i % width;
    const int y = first[1] + i / width % height;
    const int z = first[2] + i / (width * height);
    const int4 q = x < p.Size[0] && y < p.Size[1] && z <= p.LayersEnd
      ? VertexPosition(&unmapped, x, y, z, &p)
      : (int4)(INT_MIN, 0, 0, 0);
    positions[3 * i] = q.x;
    positions[3 * i + 1] = q.y;
    positions[3 * i + 2] = q.z;
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  const SamplingMesh mesh = { MAPPING_ARGUMENTS, state, active, positions,
    { first[0], first[1], first[2] } };
  Output output = { coverage, winners, patches, 0, 0, 0, 0, 0, 0, 0 };
  for (int i = get_local_id(0);
       i < DEFORMVOLUME_BLOCK_X * DEFORMVOLUME_BLOCK_Y * DEFORMVOLUME_BLOCK_Z;
       i += get_local_size(0))
  {
    const int x = first[0] + i % DEFORMVOLUME_BLOCK_X;
    const int y = first[1] + i / DEFORMVOLUME_BLOCK_X % DEFORMVOLUME_BLOCK_Y;
    const int z = first[2] + i / (DEFORMVOLUME_BLOCK_X * DEFORMVOLUME_BLOCK_Y);
    if (x < p.Size[0] - 1 && y < p.Size[1] - 1 && z < p.LayersEnd)
    {
      ResampleCell(&mesh, x, y, z, &output, &p ARRAY_ARGUMENTS);
    }
  }
  // The sums over all bricks are what counts here.
  const uint brick = ((uint)(first[2] - p.BrickOrigin[2]) / DEFORMVOLUME_BRICK_Z * p.BrickCount[1] +
                       (uint)(first[1] - p.BrickOrigin[1]) / DEFORMVOLUME_BRICK_Y) *
    p.BrickCount[0];
  AddCounts(&output, DEFORMVOLUME_SECTIONS * (size_t)brick, counters, &p);
}
