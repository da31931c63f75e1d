// SPDX-License-Identifier: BSD-3-Clause
// The samples of a tetrahedron, and how arrays are interpolated and stored at samples.
//
// The host defines before this text:
//   REAL                 type of the interpolation: double if the device has it, else float
//   EXACT                type that holds whole numbers to 2^53: double if the device has it, else long
//   ARRAY_PARAMETERS     kernel parameters: source and target of each array
//   ARRAY_ARGUMENTS      the same as arguments
//   STORE_ARRAYS         statements that store all arrays at a sample
//   CUBIC                1 for cubic interpolation where possible (VoxelTaps.cl then comes first), else 0

// A sample of a tetrahedron.
typedef struct
{
  size_t Target;     // output voxel in the buffers
  size_t Sources[4]; // voxels of the chunk at the tetrahedron's vertices
  REAL Weights[4];   // barycentric weights
  REAL Scale;        // 1 / Volume
  long Volume;       // sum of the edge functions; 0 if the sample was not begun yet
  int Only;          // the vertex at which the sample lies exactly, or -1
  int Nearest;       // the vertex with the largest weight; of equal ones the lowest voxel
#if CUBIC
  int IsCubic;    // whether all voxels and cells that cubic interpolation needs exist
  int Cell[3];    // local index of the cell, on z counted from the first plane of the chunk
  int Corners[4]; // corners of the cell at the vertices: bits of x, z and y
  long Along[3];  // position in the cell at rest on x, y and z, from 0 to Volume
#endif
} Sample;

// Vertices without weight are not read, so a NaN does not spread beyond its tetrahedra. A sample at a vertex takes
// its value bit for bit.
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
        const REAL value = (REAL)SOURCE[s->Sources[k] * COMPONENTS + c];                           \
        sum = s->Weights[k] > 0 ? MULTIPLY_ADD_REAL(s->Weights[k], value, sum) : sum;              \
      }                                                                                            \
      TARGET[s->Target * COMPONENTS + c] = CONVERT(sum);                                           \
    }                                                                                              \
  }

// Integers of 64 bits do not fit into REAL. So the difference to the nearest vertex is interpolated, which is exact if
// the values are close to each other. As the nearest vertex has a weight of at least 1/4, rounding errors of large
// differences do not lead out of the range of the values.
#define STORE_LINEAR_64(SOURCE, TARGET, COMPONENTS, TYPE, CONVERT)                                 \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    const TYPE first = SOURCE[s->Sources[s->Nearest] * COMPONENTS + c];                            \
    TYPE value = first;                                                                            \
    if (s->Only < 0)                                                                               \
    {                                                                                              \
      REAL sum = (REAL)first;                                                                      \
      REAL difference = 0;                                                                         \
      int near = 1;                                                                                \
      for (int k = 0; k < 4; ++k)                                                                  \
      {                                                                                            \
        const TYPE other = SOURCE[s->Sources[k] * COMPONENTS + c];                                 \
        near &= abs_diff(other, first) < (1UL << 62);                                              \
        difference =                                                                               \
          MULTIPLY_ADD_REAL(s->Weights[k], (REAL)(long)((ulong)other - (ulong)first), difference); \
        sum = MULTIPLY_ADD_REAL(s->Weights[k], (REAL)other - (REAL)first, sum);                    \
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

#if CUBIC
// Returns the taps on an axis for the cell that contains a sample.
static AxisTaps MakeAxisTaps(const Sample* s, int axis)
{
  const int voxel = s->Cell[axis];
  AxisTaps taps;
  taps.Count = 0;
  if (s->Along[axis] == 0 || s->Along[axis] == s->Volume)
  {
    AddTap(&taps, voxel + (s->Along[axis] != 0), 1);
  }
  else
  {
    AddCubicTaps(&taps, voxel, 1, 1, (REAL)s->Along[axis] * s->Scale);
  }
  return taps;
}

#undef STORE_LINEAR
#undef STORE_LINEAR_64
#define STORE_LINEAR(SOURCE, TARGET, COMPONENTS, CONVERT)                                          \
  STORE_TAPS(taps, SOURCE, TARGET, s->Target, COMPONENTS, CONVERT)
#define STORE_LINEAR_64(SOURCE, TARGET, COMPONENTS, TYPE, CONVERT)                                 \
  STORE_TAPS_64(taps, SOURCE, TARGET, s->Target, COMPONENTS, TYPE, CONVERT)

// Like StoreArrays, with cubic interpolation at the rest coordinate of the sample. In a tetrahedron the rest
// coordinate is linear between the vertices.
static __attribute__((noinline)) void StoreCubic(
  const Sample* s, const KernelParameters* p ARRAY_PARAMETERS)
{
  const AxisTaps x = MakeAxisTaps(s, 0);
  const AxisTaps y = MakeAxisTaps(s, 1);
  const AxisTaps z = MakeAxisTaps(s, 2);
  VoxelTaps taps;
  JoinTaps(&x, &y, &z, p->Size, &taps);
  STORE_ARRAYS
}
#endif

// Sets the data that all samples of a tetrahedron share. volume: the sum of the edge functions.
static void BeginSamples(
  Sample* s, int x, int y, int z, int t, long volume, const KernelParameters* p)
{
  const int mirror = Mirror(x, y, z, p);
  for (int k = 0; k < 4; ++k)
  {
    const int o = Tetrahedra[t][k] ^ mirror;
    s->Sources[k] = VertexInChunk(x + OFFSET_X(o), y + OFFSET_Y(o), z + OFFSET_Z(o), p);
#if CUBIC
    s->Corners[k] = o;
#endif
  }
#if CUBIC
  s->Cell[0] = x;
  s->Cell[1] = y;
  s->Cell[2] = z - p->ChunkFirst;
#endif
  s->Scale = (REAL)1 / (REAL)volume;
  s->Volume = volume;
}

static void SetSample(Sample* s, const long* weights, size_t target)
{
  s->Target = target;
  s->Only = -1;
  s->Nearest = 0;
  for (int k = 0; k < 4; ++k)
  {
    s->Weights[k] = (REAL)weights[k] * s->Scale;
    s->Only = weights[k] == s->Volume ? k : s->Only;
    const long lead = weights[k] - weights[s->Nearest];
    s->Nearest = lead > 0 || (lead == 0 && s->Sources[k] < s->Sources[s->Nearest]) ? k : s->Nearest;
  }
#if CUBIC
  for (int axis = 0; axis < 3; ++axis)
  {
    const int bit = axis == 0 ? 0 : 3 - axis;
    s->Along[axis] = 0;
    for (int k = 0; k < 4; ++k)
    {
      s->Along[axis] += s->Corners[k] >> bit & 1 ? weights[k] : 0;
    }
  }
#endif
}
