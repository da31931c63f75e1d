// SPDX-License-Identifier: BSD-3-Clause
// Samples the volume at the rest coordinates that MeshRasterization.cl found for a tile of output voxels, and writes
// the tile: the coverage, and the values of all arrays: interpolated for covered voxels, the background value for other
// voxels.
//
// Rest coordinates are integers: the index relative to the volume's first voxel times 2^FractionBits. Interpolation
// is that of VoxelTaps.cl, linear or cubic. Beyond the border of the volume, cubic interpolation extrapolates voxels
// linearly, so that an array that is linear in space stays linear.
//
// Linear arrays of one component, of type float or 8- or 16-bit integer, are handled in lanes (LaneSampling.cl). All
// other arrays are handled voxel by voxel in REAL.
//
// The host defines before this text, in addition to the macros of LaneSampling.cl and VoxelTaps.cl:
//   HAS_MASKS             1 if the volume has masks or boundary distances, else 0
//   STRETCH               neighboring voxels of a work-item: 32 on CPUs, else 1
//   ARRAY_PARAMETERS      kernel parameters: source and target of each array
//   TAP_ARRAYS(DO)        DO(index, type, components) for arrays that are not handled in lanes
//   HAS_LANE_ARRAYS, HAS_TAP_ARRAYS  defined if there are such arrays
//   STORE_ARRAY_i         statement that stores array i at a sample

static AxisTaps MakeAxisTaps(int rest, int bits, int size, int* nearest)
{
  const int voxel = min(rest >> bits, size - 2);
  const int fraction = rest - (voxel << bits);
  const int whole = 1 << bits;
  const REAL f = (REAL)fraction / (REAL)whole;
  AxisTaps taps;
  taps.Count = 0;
  *nearest = voxel + (2 * (long)fraction > whole);
#if CUBIC
  if (fraction == 0 || fraction == whole)
  {
    AddTap(&taps, voxel + (fraction != 0), 1);
    return taps;
  }
  AddCubicTaps(&taps, voxel, voxel > 0, voxel < size - 2, f);
#else
  AddTap(&taps, voxel, 1 - f);
  AddTap(&taps, voxel + 1, f);
#endif
  return taps;
}

// A covered voxel of the output, and where its values come from.
typedef struct
{
  size_t Target;
  VoxelTaps Taps;
  size_t Nearest;
} Sample;

static void MakeSample(const int* rest, Sample* s, const RasterParameters* p)
{
  int nearest[3];
  const AxisTaps x = MakeAxisTaps(rest[0], p->FractionBits[0], p->Size[0], nearest);
  const AxisTaps y = MakeAxisTaps(rest[1], p->FractionBits[1], p->Size[1], nearest + 1);
  const AxisTaps z = MakeAxisTaps(rest[2], p->FractionBits[2], p->Size[2], nearest + 2);
  JoinTaps(&x, &y, &z, p->Size, &s->Taps);
  s->Nearest = ((size_t)nearest[2] * p->Size[1] + nearest[1]) * p->Size[0] + nearest[0];
}

#define STORE_LINEAR(SOURCE, TARGET, COMPONENTS, CONVERT)                                          \
  STORE_TAPS(s.Taps, SOURCE, TARGET, s.Target, COMPONENTS, CONVERT)
#define STORE_LINEAR_64(SOURCE, TARGET, COMPONENTS, TYPE, CONVERT)                                 \
  STORE_TAPS_64(s.Taps, SOURCE, TARGET, s.Target, COMPONENTS, TYPE, CONVERT)

#define STORE_NEAREST(SOURCE, TARGET, COMPONENTS)                                                  \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    TARGET[s.Target * COMPONENTS + c] = SOURCE[s.Nearest * COMPONENTS + c];                        \
  }

typedef struct
{
  __global const uchar* Active;    // one byte per cell; bit i: tetrahedron i is active
  __global const uchar* Blanked;   // one byte per voxel
  __global const float* Distances; // boundary distances, one float per voxel
} VolumeMasks;

static void LoadRest(__local const int* rests, int x, int* rest)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    rest[axis] = rests[axis * REST_AXIS_STEP + x * REST_STEP];
  }
}

#if HAS_MASKS
// Whether a point in a tetrahedron of a cell has a negative boundary distance. mirror: DEFORMVOLUME_MIRROR of the
// cell.
static int IsBeyondBoundary(__global const float* distances, const int* cell, int mirror, int t,
  const long* weights, const RasterParameters* p)
{
  REAL sum = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int v = Tetrahedra[t][k] ^ mirror;
    const size_t voxel =
      ((size_t)(cell[2] + (v >> 1 & 1)) * p->Size[1] + cell[1] + (v >> 2)) * p->Size[0] + cell[0] +
      (v & 1);
    sum = weights[k] ? MULTIPLY_ADD_REAL((REAL)weights[k], (REAL)distances[voxel], sum) : sum;
  }
  return sum < 0;
}

// Whether an active tetrahedron of the sampling mesh contains a rest coordinate, with a boundary distance that is not
// negative. On shared faces, edges and vertices one such tetrahedron is enough.
static int IsThere(VolumeMasks masks, const int* rest, const RasterParameters* p)
{
  int cell[3];
  int below[3];
  long one = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    cell[axis] = min(rest[axis] >> p->FractionBits[axis], p->Size[axis] - 2);
    below[axis] = cell[axis] > 0 && rest[axis] == cell[axis] << p->FractionBits[axis];
    one = max(one, 1L << p->FractionBits[axis]);
  }
  for (int neighbor = 0; neighbor < 8; ++neighbor)
  {
    const int step[3] = { neighbor & 1, neighbor >> 1 & 1, neighbor >> 2 };
    if (step[0] > below[0] || step[1] > below[1] || step[2] > below[2])
    {
      continue;
    }
    const int c[3] = { cell[0] - step[0], cell[1] - step[1], cell[2] - step[2] };
    const int tetrahedra = p->HasActive
      ? masks.Active[((size_t)c[2] * (p->Size[1] - 1) + c[1]) * (p->Size[0] - 1) + c[0]]
      : DEFORMVOLUME_ALL_TETRAHEDRA;
    const int mirror =
      DEFORMVOLUME_MIRROR(p->First[0] + c[0], p->First[1] + c[1], p->First[2] + c[2]);
    long point[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      const long inCell = rest[axis] - ((long)c[axis] << p->FractionBits[axis]);
      point[axis] = inCell * (one >> p->FractionBits[axis]);
      point[axis] = (p->First[axis] + c[axis]) & 1 ? one - point[axis] : point[axis];
    }
    const Vector inCell = { point[0], point[1], point[2] };
    for (int t = 0; t < 5; ++t)
    {
      long weights[4];
      if (tetrahedra >> t & 1 && IsInTetrahedron(t, inCell, one, weights) &&
        !(p->HasDistances && IsBeyondBoundary(masks.Distances, c, mirror, t, weights, p)))
      {
        return 1;
      }
    }
  }
  return 0;
}

static int IsBlanked(__global const uchar* blanked, const int* rest, const RasterParameters* p)
{
  Sample s;
  MakeSample(rest, &s, p);
  for (int k = 0; k < s.Taps.Count; ++k)
  {
    if (blanked[s.Taps.Sources[k]])
    {
      return 1;
    }
  }
  return 0;
}

// Returns the voxels of a row whose rest coordinates are not masked.
static uint SelectSources(
  VolumeMasks masks, uint bits, __local const int* rests, const RasterParameters* p)
{
  for (int x = 0; x < 32; ++x)
  {
    if (bits >> x & 1)
    {
      int rest[3];
      LoadRest(rests, x, rest);
      if (((p->HasActive || p->HasDistances) && !IsThere(masks, rest, p)) ||
        (p->HasBlanked && IsBlanked(masks.Blanked, rest, p)))
      {
        bits ^= 1u << x;
      }
    }
  }
  return bits;
}
#else
#define SelectSources(masks, bits, rests, p) (bits)
#endif

#define BACKGROUND(NUMBER, TYPE) (*(__global const TYPE*)(backgrounds + NUMBER))

// row: index of voxel 0 of the row, which may lie before the output. from, to: voxels of the row in the output.
#define STORE_LANES(NUMBER, TYPE, BITS)                                                            \
  {                                                                                                \
    LANES_OF(TYPE) values = (TYPE)(BACKGROUND(NUMBER, TYPE));                                      \
    if (bits)                                                                                      \
    {                                                                                              \
      values = SampleLanes##NUMBER(source##NUMBER, &cells, (float)BACKGROUND(NUMBER, TYPE));       \
    }                                                                                              \
    if (x >= from && x + LANES - 1 <= to)                                                          \
    {                                                                                              \
      STORE(values, target##NUMBER + row + x);                                                     \
    }                                                                                              \
    else                                                                                           \
    {                                                                                              \
      TYPE single[LANES];                                                                          \
      STORE(values, single);                                                                       \
      for (int i = max(from, x); i <= min(to, x + LANES - 1); ++i)                                 \
      {                                                                                            \
        target##NUMBER[row + i] = single[i - x];                                                   \
      }                                                                                            \
    }                                                                                              \
  }

#define STORE_BACKGROUND(NUMBER, TYPE, COMPONENTS)                                                 \
  for (int c = 0; c < COMPONENTS; ++c)                                                             \
  {                                                                                                \
    target##NUMBER[s.Target * COMPONENTS + c] = BACKGROUND(NUMBER, TYPE);                          \
  }
#define STORE_VALUES(NUMBER, TYPE, COMPONENTS) STORE_ARRAY_##NUMBER

// Always inlined: in PoCL 3.1 to 6.0, writes of a static function to a local array of a kernel are lost. (LLVM puts
// the address of the array into the function, and PoCL then replaces the array in the kernel only.)
static __attribute__((always_inline)) void SampleTile(VoxelBox tile, const int* origin,
  __local const int* rests, __local const uint* covered, __global const ulong* backgrounds,
  __global char* coverage, const RasterParameters* p ARRAY_PARAMETERS)
{
  for (int stretch = get_local_id(0); stretch < DEFORMVOLUME_TILE_VOXELS / STRETCH;
       stretch += get_local_size(0))
  {
    const int first = stretch * STRETCH;
    const int rowOfTile = first >> DEFORMVOLUME_TILE_BITS_X;
    int voxel[3];
    FindFirstOfRow(rowOfTile, origin, voxel);
    const int y = voxel[1];
    const int z = voxel[2];
    const int inRow = first & 31;
    const int from = max(inRow, tile.Low.x - origin[0]);
    const int to = min(inRow + STRETCH - 1, tile.High.x - origin[0]);
    if (y < tile.Low.y || y > tile.High.y || z < tile.Low.z || z > tile.High.z || from > to)
    {
      continue;
    }
    const long row = ((long)(z - p->OutputFirst[2]) * p->OutputSize[1] + y - p->OutputFirst[1]) *
        p->OutputSize[0] +
      origin[0] - p->OutputFirst[0];
    const uint held = covered[rowOfTile];
    __local const int* rowRests = rests + rowOfTile * REST_ROW_STEP;
    for (int x = from; x <= to; ++x)
    {
      coverage[row + x] = held >> x & 1;
    }
#ifdef HAS_LANE_ARRAYS
    for (int x = from & -LANES; x <= to; x += LANES)
    {
      const uint bits = held >> x & LANE_MASK;
      LaneCells cells;
      if (bits)
      {
        MakeLaneCells(rowRests + x * REST_STEP, bits, &cells, p);
      }
      LANE_ARRAYS(STORE_LANES)
    }
#endif
#ifdef HAS_TAP_ARRAYS
    for (int x = from; x <= to; ++x)
    {
      Sample s;
      s.Target = row + x;
      if (held >> x & 1)
      {
        int rest[3];
        LoadRest(rowRests, x, rest);
        MakeSample(rest, &s, p);
        TAP_ARRAYS(STORE_VALUES)
      }
      else
      {
        TAP_ARRAYS(STORE_BACKGROUND)
      }
    }
#endif
  }
}

// Writes the number of covered voxels of a tile, and whether tetrahedra overlap there, to its counters. Called by one
// work-item when all rows are done.
static inline void CountTile(
  __local const uint* covered, uint overlaps, __global uint* tileCounters)
{
  uint sum = 0;
  for (int row = 0; row < DEFORMVOLUME_TILE_ROWS; ++row)
  {
    sum += popcount(covered[row]);
  }
  tileCounters[DEFORMVOLUME_TILE_COVERED] = sum;
  tileCounters[DEFORMVOLUME_TILE_OVERLAPS] = overlaps;
}
