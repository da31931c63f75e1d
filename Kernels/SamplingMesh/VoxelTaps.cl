// SPDX-License-Identifier: BSD-3-Clause
// Interpolation at a position at rest: trilinear over 8 voxels, or tricubic (Catmull-Rom) over 64. Voxels with weight 0
// are omitted, so that a NaN does not spread beyond its cells, and a position on a voxel gives exactly the value of the
// voxel.
//
// Macros that the host defines before this text:
//   REAL   type of the interpolation: double if the device supports it, else float
//   CUBIC  whether the interpolation is cubic

#define TAPS_PER_AXIS (CUBIC ? 4 : 2)
#define TAPS (CUBIC ? 64 : 8)

// The voxels and weights on one axis.
typedef struct
{
  int Voxels[TAPS_PER_AXIS];
  REAL Weights[TAPS_PER_AXIS];
  int Count;
} AxisTaps;

static void AddTap(AxisTaps* taps, int voxel, REAL weight)
{
  if (weight != 0)
  {
    taps->Voxels[taps->Count] = voxel;
    taps->Weights[taps->Count++] = weight;
  }
}

#if CUBIC
// Adds the taps for a position between `voxel` and voxel + 1, at the fraction f. hasBefore, hasAfter: whether there is a
// voxel before and after these two. If not, its value is extrapolated linearly from the two.
static void AddCubicTaps(AxisTaps* taps, int voxel, int hasBefore, int hasAfter, REAL f)
{
  const REAL before = MULTIPLY_ADD_REAL(2 - f, f, (REAL)-1) * f / 2;
  const REAL after = (f - 1) * f * f / 2;
  REAL low = MULTIPLY_ADD_REAL(MULTIPLY_ADD_REAL((REAL)3, f, (REAL)-5) * f, f, (REAL)2) / 2;
  REAL high = MULTIPLY_ADD_REAL(MULTIPLY_ADD_REAL((REAL)-3, f, (REAL)4), f, (REAL)1) * f / 2;
  if (hasBefore)
  {
    AddTap(taps, voxel - 1, before);
  }
  else
  {
    low = MULTIPLY_ADD_REAL((REAL)2, before, low);
    high -= before;
  }
  if (!hasAfter)
  {
    low -= after;
    high = MULTIPLY_ADD_REAL((REAL)2, after, high);
  }
  AddTap(taps, voxel, low);
  AddTap(taps, voxel + 1, high);
  if (hasAfter)
  {
    AddTap(taps, voxel + 2, after);
  }
}
#endif

typedef struct
{
  size_t Sources[TAPS]; // indices of the voxels in the arrays
  REAL Weights[TAPS];
  int Count;
} VoxelTaps;

// Multiplies the taps of three axes. size: voxels of the volume on each axis.
static void JoinTaps(
  const AxisTaps* x, const AxisTaps* y, const AxisTaps* z, const int* size, VoxelTaps* taps)
{
  taps->Count = 0;
  for (int k = 0; k < z->Count; ++k)
  {
    for (int j = 0; j < y->Count; ++j)
    {
      const size_t row = ((size_t)z->Voxels[k] * size[1] + y->Voxels[j]) * size[0];
      const REAL weight = z->Weights[k] * y->Weights[j];
      for (int i = 0; i < x->Count; ++i)
      {
        taps->Sources[taps->Count] = row + x->Voxels[i];
        taps->Weights[taps->Count++] = weight * x->Weights[i];
      }
    }
  }
}

#define STORE_TAPS(T, SOURCE, TARGET, INDEX, COMPONENTS, CONVERT)                                  \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    if (T.Count == 1)                                                                              \
    {                                                                                              \
      TARGET[INDEX * COMPONENTS + c] = SOURCE[T.Sources[0] * COMPONENTS + c];                      \
    }                                                                                              \
    else                                                                                           \
    {                                                                                              \
      REAL sum = 0;                                                                                \
      for (int k = 0; k < T.Count; ++k)                                                            \
      {                                                                                            \
        sum = MULTIPLY_ADD_REAL(T.Weights[k], (REAL)SOURCE[T.Sources[k] * COMPONENTS + c], sum);   \
      }                                                                                            \
      TARGET[INDEX * COMPONENTS + c] = CONVERT(sum);                                               \
    }                                                                                              \
  }

// REAL cannot represent all 64-bit integers. So the difference to the first voxel is interpolated, which is exact if
// the values are close to each other. A cubic sum may exceed the range of the type, so the addition saturates.
#define STORE_TAPS_64(T, SOURCE, TARGET, INDEX, COMPONENTS, TYPE, CONVERT)                         \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    const TYPE first = SOURCE[T.Sources[0] * COMPONENTS + c];                                      \
    REAL sum = 0;                                                                                  \
    REAL difference = 0;                                                                           \
    int near = 1;                                                                                  \
    for (int k = 0; k < T.Count; ++k)                                                              \
    {                                                                                              \
      const TYPE other = SOURCE[T.Sources[k] * COMPONENTS + c];                                    \
      near &= abs_diff(other, first) < (1UL << 58);                                                \
      difference =                                                                                 \
        MULTIPLY_ADD_REAL(T.Weights[k], (REAL)(long)((ulong)other - (ulong)first), difference);    \
      sum = MULTIPLY_ADD_REAL(T.Weights[k], (REAL)other, sum);                                     \
    }                                                                                              \
    const TYPE step = (TYPE)abs(convert_long_rte(near ? difference : 0));                          \
    TARGET[INDEX * COMPONENTS + c] = !near ? CONVERT(sum)                                          \
      : difference < 0                     ? sub_sat(first, step)                                  \
                                           : add_sat(first, step);                                                     \
  }
