// SPDX-License-Identifier: BSD-3-Clause
// Finds the rest coordinate of each output voxel through an inverse displacement field. RestSampling.cl samples the
// volume there. There are no tetrahedra, and voxels do not depend on each other.
//
// Data: the vectors of the field, three floats per point, in output voxels. A vector leads from a point of the output
// to the point of the volume at rest whose values the output has there. Local memory has rest coordinates and bits of
// covered voxels, as in MeshRasterization.cl.
//
// A work-group handles one output tile. This text comes after TetrahedronBinning.cl, RestSampling.cl and
// FieldFading.cl, and needs no macros beyond theirs.

// Data that the voxels of a row share: the position of the row's first voxel in the field, the step to the next
// voxel, and the map from a position in the output to a rest coordinate.
typedef struct
{
  REAL Start[3];
  REAL Steps[3];
  REAL Inverse[3][3]; // by axis, and by axis of the output
  REAL First[3];
} LookupRow;

static LookupRow MakeLookupRow(const int* voxel, const LookupParameters* f, const RasterParameters* p)
{
  LookupRow row;
  for (int axis = 0; axis < 3; ++axis)
  {
    REAL matrix[4];
    for (int column = 0; column < 4; ++column)
    {
      matrix[column] =
        (REAL)f->OutputToField[4 * axis + column] + (REAL)f->OutputToFieldRest[4 * axis + column];
    }
    row.Start[axis] = MULTIPLY_ADD_REAL(matrix[2], (REAL)voxel[2],
      MULTIPLY_ADD_REAL(
        matrix[1], (REAL)voxel[1], MULTIPLY_ADD_REAL(matrix[0], (REAL)voxel[0], matrix[3])));
    row.Steps[axis] = matrix[0];
    const REAL one = (REAL)(1 << p->FractionBits[axis]);
    for (int column = 0; column < 3; ++column)
    {
      row.Inverse[axis][column] =
        column == axis || p->HasTurnedAxes ? INVERSE_ELEMENT(p, axis, column) * one : 0;
    }
    row.First[axis] = ((REAL)p->First[axis] + OFFSET_ELEMENT(p, axis)) * one;
  }
  return row;
}

#define MIX(A, B, T) MULTIPLY_ADD_REAL(T, (B) - (A), A)

// Interpolates between two neighboring points on x.
static void MixAlongX(__global const float* vectors, size_t row, int low, int high, REAL t, REAL* mixed)
{
  const float3 a = vload3(row + low, vectors);
  const float3 b = vload3(row + high, vectors);
  mixed[0] = MIX((REAL)a.x, (REAL)b.x, t);
  mixed[1] = MIX((REAL)a.y, (REAL)b.y, t);
  mixed[2] = MIX((REAL)a.z, (REAL)b.z, t);
}

// Trilinear interpolation of the vector at a position in the field. Points with weight 0 are not read, as their
// vector may be not-a-number, which stands for an undefined point.
static void InterpolateField(
  __global const float* vectors, const REAL* position, REAL* vector, const LookupParameters* f)
{
  const int x = (int)position[0];
  const int y = (int)position[1];
  const int z = (int)position[2];
  const REAL tx = position[0] - (REAL)x;
  const REAL ty = position[1] - (REAL)y;
  const REAL tz = position[2] - (REAL)z;
  const size_t row = ((size_t)z * f->Dimensions[1] + y) * f->Dimensions[0];
  if (tx == 0 && ty == 0 && tz == 0)
  {
    const float3 here = vload3(row + x, vectors);
    vector[0] = (REAL)here.x;
    vector[1] = (REAL)here.y;
    vector[2] = (REAL)here.z;
    return;
  }
  const int high = tx > 0 ? x + 1 : x;
  const size_t nextY = ty > 0 ? f->Dimensions[0] : 0;
  const size_t nextZ = tz > 0 ? (size_t)f->Dimensions[0] * f->Dimensions[1] : 0;
  REAL a[3], b[3], c[3], d[3];
  MixAlongX(vectors, row, x, high, tx, a);
  MixAlongX(vectors, row + nextY, x, high, tx, b);
  MixAlongX(vectors, row + nextZ, x, high, tx, c);
  MixAlongX(vectors, row + nextY + nextZ, x, high, tx, d);
  for (int axis = 0; axis < 3; ++axis)
  {
    const REAL low = MIX(a[axis], b[axis], ty);
    const REAL upper = MIX(c[axis], d[axis], ty);
    vector[axis] = MIX(low, upper, tz);
  }
}

// Finds the rest coordinate of voxel x of a row, counted from 0. voxel: the first voxel of the row. Returns 0 if the
// voxel is outside the field, or its rest coordinate is outside the volume.
static int LookUpRest(__global const float* vectors, const LookupRow* row, const int* voxel, int x,
  __local int* rest, const LookupParameters* f, const RasterParameters* p)
{
  REAL position[3];
  float beyond[3];
  int inside = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    const REAL last = (REAL)(f->Dimensions[axis] - 1);
    const REAL here = MULTIPLY_ADD_REAL((REAL)x, row->Steps[axis], row->Start[axis]);
    inside &= here >= -(REAL)DEFORMVOLUME_LOOKUP_TOLERANCE &&
      here <= last + (REAL)DEFORMVOLUME_LOOKUP_TOLERANCE;
    position[axis] = clamp(here, (REAL)0, last);
    const REAL outside = fmax(fabs(here - position[axis]) - (REAL)DEFORMVOLUME_LOOKUP_TOLERANCE, (REAL)0);
    beyond[axis] = (float)outside * f->Fading[axis];
  }
  if (!inside && !f->Extrapolate)
  {
    return 0;
  }
  const float weight = inside ? 1.0f : WeightBeyond((float3)(beyond[0], beyond[1], beyond[2]));
  REAL vector[3] = { 0, 0, 0 };
  if (weight > 0)
  {
    InterpolateField(vectors, position, vector, f);
  }
  if (isnan(vector[0]))
  {
    // A rounding error may have given weight to an undefined point.
    for (int axis = 0; axis < 3; ++axis)
    {
      const REAL nearest = rint(position[axis]);
      position[axis] =
        fabs(position[axis] - nearest) <= (REAL)DEFORMVOLUME_LOOKUP_TOLERANCE ? nearest : position[axis];
    }
    InterpolateField(vectors, position, vector, f);
  }
  inside = 1;
  REAL at[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    at[axis] = MULTIPLY_ADD_REAL(vector[axis], (REAL)weight, (REAL)(voxel[axis] + (axis == 0 ? x : 0)));
  }
  int found[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    REAL inVolume = MULTIPLY_ADD_REAL(at[axis], row->Inverse[axis][axis], -row->First[axis]);
    if (p->HasTurnedAxes)
    {
      const int second = axis == 0 ? 1 : 0;
      const int third = axis == 2 ? 1 : 2;
      inVolume = MULTIPLY_ADD_REAL(at[second], row->Inverse[axis][second], inVolume);
      inVolume = MULTIPLY_ADD_REAL(at[third], row->Inverse[axis][third], inVolume);
    }
    const int most = (p->Size[axis] - 1) << p->FractionBits[axis];
    inside &= inVolume >= (REAL)-p->Tolerance[axis] &&
      inVolume <= (REAL)most + (REAL)p->Tolerance[axis];
    // The value is not negative, so adding 0.5 and truncating rounds to nearest.
    found[axis] = (int)(clamp(inVolume, (REAL)0, (REAL)most) + (REAL)0.5);
  }
  if (inside)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      rest[axis * REST_AXIS_STEP + x * REST_STEP] = found[axis];
    }
  }
  return inside;
}

#if LANES == 1
// Finds the rest coordinates of the voxels of a tile that this work-item takes. The first component is -1 if a voxel
// has no rest coordinate. Neighboring work-items take neighboring voxels on x, which read neighboring memory. Always
// inlined: see SampleTile.
static __attribute__((always_inline)) void FindTileRests(__global const float* vectors, VoxelBox tile,
  const int* origin, __local int* rests, const LookupParameters* f, const RasterParameters* p)
{
  for (int i = get_local_id(0); i < DEFORMVOLUME_TILE_VOXELS; i += get_local_size(0))
  {
    const int row = i >> DEFORMVOLUME_TILE_BITS_X;
    const int x = i & ((1 << DEFORMVOLUME_TILE_BITS_X) - 1);
    __local int* rowRests = rests + row * REST_ROW_STEP;
    int voxel[3];
    FindFirstOfRow(row, origin, voxel);
    int inside = voxel[0] + x >= tile.Low.x && voxel[0] + x <= tile.High.x && voxel[1] >= tile.Low.y &&
      voxel[1] <= tile.High.y && voxel[2] >= tile.Low.z && voxel[2] <= tile.High.z;
    if (inside)
    {
      const LookupRow common = MakeLookupRow(voxel, f, p);
      inside = LookUpRest(vectors, &common, voxel, x, rowRests, f, p);
    }
    if (!inside)
    {
      rowRests[x * REST_STEP] = -1;
    }
  }
}
#else
#define REALS LANES_OF(REAL)
#define TO_REALS JOIN(convert_, REALS)
#define LONGS LANES_OF(long)
#define TO_LONGS JOIN(convert_, LONGS)
// Rounds numbers toward 0. Converts the results of comparisons of REALS.
#define REALS_TO_INTS JOIN(convert_, INTS)

// Every third element of three vectors in a row, from the first, the second or the third one on.
#if LANES == 16
#define THIRDS_0(a, b, c) (FLOATS)(a.s0369, a.scf, b.s258b, b.se, c.s147a, c.sd)
#define THIRDS_1(a, b, c) (FLOATS)(a.s147a, a.sd, b.s0369, b.scf, c.s258b, c.se)
#define THIRDS_2(a, b, c) (FLOATS)(a.s258b, a.se, b.s147a, b.sd, c.s0369, c.scf)
#elif LANES == 8
#define THIRDS_0(a, b, c) (FLOATS)(a.s036, b.s147, c.s25)
#define THIRDS_1(a, b, c) (FLOATS)(a.s147, b.s25, c.s036)
#define THIRDS_2(a, b, c) (FLOATS)(a.s25, b.s036, c.s147)
#else
#define THIRDS_0(a, b, c) (FLOATS)(a.s03, b.s2, c.s1)
#define THIRDS_1(a, b, c) (FLOATS)(a.s1, b.s03, c.s2)
#define THIRDS_2(a, b, c) (FLOATS)(a.s2, b.s1, c.s03)
#endif

#define LOAD_COMPONENT(k, axis) vectors[3 * points[k] + axis]

// Loads the vectors of LANES points. Points of a field on the grid of the output are neighbors.
static void LoadVectors(__global const float* vectors, LONGS numbers, REALS* loaded)
{
  long points[LANES];
  STORE(numbers, points);
  if (all(numbers == points[0] + TO_LONGS(LANE_INDEX)))
  {
    __global const float* const first = vectors + 3 * points[0];
    const FLOATS a = LOAD(first);
    const FLOATS b = LOAD(first + LANES);
    const FLOATS c = LOAD(first + 2 * LANES);
    loaded[0] = TO_REALS(THIRDS_0(a, b, c));
    loaded[1] = TO_REALS(THIRDS_1(a, b, c));
    loaded[2] = TO_REALS(THIRDS_2(a, b, c));
    return;
  }
  loaded[0] = TO_REALS((FLOATS)(GATHER(LOAD_COMPONENT, 0)));
  loaded[1] = TO_REALS((FLOATS)(GATHER(LOAD_COMPONENT, 1)));
  loaded[2] = TO_REALS((FLOATS)(GATHER(LOAD_COMPONENT, 2)));
}

// Does the same as InterpolateField for LANES positions. If none of them is between points, only one vector is read
// for each.
static void InterpolateLanes(
  __global const float* vectors, const REALS* position, REALS* vector, const LookupParameters* f)
{
  LONGS point[3];
  REALS between[3];
  LONGS next[3]; // the step to the next point on each axis; 0 if that point has no weight
  const LONGS steps[3] = { 1, f->Dimensions[0], (long)f->Dimensions[0] * f->Dimensions[1] };
  INTS isBetween = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const INTS low = REALS_TO_INTS(position[axis]);
    point[axis] = TO_LONGS(low);
    between[axis] = position[axis] - TO_REALS(low);
    const INTS hasNext = REALS_TO_INTS(between[axis] > 0);
    next[axis] = TO_LONGS(hasNext) & steps[axis];
    isBetween |= hasNext;
  }
  const LONGS first = point[2] * steps[2] + point[1] * steps[1] + point[0];
  if (!LaneBits(isBetween))
  {
    LoadVectors(vectors, first, vector);
    return;
  }
  REALS rows[4][3];
  for (int row = 0; row < 4; ++row)
  {
    const LONGS begin = first + (row & 1 ? next[1] : 0) + (row & 2 ? next[2] : 0);
    REALS high[3];
    LoadVectors(vectors, begin, rows[row]);
    LoadVectors(vectors, begin + next[0], high);
    for (int axis = 0; axis < 3; ++axis)
    {
      rows[row][axis] = MIX(rows[row][axis], high[axis], between[0]);
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const REALS low = MIX(rows[0][axis], rows[1][axis], between[1]);
    const REALS upper = MIX(rows[2][axis], rows[3][axis], between[1]);
    vector[axis] = MIX(low, upper, between[2]);
  }
}

// Does the same as LookUpRest for the LANES voxels from x on of a row, if all wanted ones are inside the field and no
// vector is undefined. wanted: bits of voxels, relative to x. found: receives the bits of voxels that have a rest
// coordinate. Returns 0 if LookUpRest must be called for each voxel.
static int LookUpRests(__global const float* vectors, const LookupRow* row, const int* voxel, int x, uint wanted,
  __local int* rests, uint* found, const LookupParameters* f, const RasterParameters* p)
{
  const REALS lane = TO_REALS(LANE_INDEX + x);
  REALS position[3];
  INTS inside = -1;
  for (int axis = 0; axis < 3; ++axis)
  {
    const REAL last = (REAL)(f->Dimensions[axis] - 1);
    const REALS here = MULTIPLY_ADD_REAL(lane, (REALS)row->Steps[axis], (REALS)row->Start[axis]);
    inside &= REALS_TO_INTS((here >= -(REAL)DEFORMVOLUME_LOOKUP_TOLERANCE) &
      (here <= last + (REAL)DEFORMVOLUME_LOOKUP_TOLERANCE));
    position[axis] = clamp(here, (REAL)0, last);
  }
  if (~LaneBits(inside) & wanted)
  {
    return 0;
  }
  REALS vector[3];
  InterpolateLanes(vectors, position, vector, f);
  if (LaneBits(REALS_TO_INTS(isnan(vector[0]))) & wanted)
  {
    return 0;
  }
  REALS at[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    at[axis] = vector[axis] + ((REALS)voxel[axis] + (axis == 0 ? lane : (REALS)0));
  }
  inside = -1;
  for (int axis = 0; axis < 3; ++axis)
  {
    REALS inVolume = MULTIPLY_ADD_REAL(at[axis], (REALS)row->Inverse[axis][axis], (REALS)-row->First[axis]);
    if (p->HasTurnedAxes)
    {
      const int second = axis == 0 ? 1 : 0;
      const int third = axis == 2 ? 1 : 2;
      inVolume = MULTIPLY_ADD_REAL(at[second], (REALS)row->Inverse[axis][second], inVolume);
      inVolume = MULTIPLY_ADD_REAL(at[third], (REALS)row->Inverse[axis][third], inVolume);
    }
    const int most = (p->Size[axis] - 1) << p->FractionBits[axis];
    inside &= REALS_TO_INTS((inVolume >= (REAL)-p->Tolerance[axis]) &
      (inVolume <= (REAL)most + (REAL)p->Tolerance[axis]));
    STORE(REALS_TO_INTS(clamp(inVolume, (REAL)0, (REAL)most) + (REAL)0.5),
      rests + axis * REST_AXIS_STEP + x * REST_STEP);
  }
  *found = LaneBits(inside) & wanted;
  return 1;
}

// Finds the rest coordinates of a row of a tile. Returns the bits of the voxels that have one.
static uint FindRowRests(__global const float* vectors, VoxelBox tile, const int* origin, int row,
  __local int* rowRests, const LookupParameters* f, const RasterParameters* p)
{
  int voxel[3];
  FindFirstOfRow(row, origin, voxel);
  uint found = 0;
  if (voxel[1] >= tile.Low.y && voxel[1] <= tile.High.y && voxel[2] >= tile.Low.z && voxel[2] <= tile.High.z)
  {
    const LookupRow common = MakeLookupRow(voxel, f, p);
    const int from = tile.Low.x - origin[0];
    const int to = tile.High.x - origin[0];
    for (int first = from & -LANES; first <= to; first += LANES)
    {
      const uint wanted = (uint)(((ulong)2 << min(to - first, LANES - 1)) - ((ulong)1 << max(from - first, 0)));
      uint those = 0;
      if (!LookUpRests(vectors, &common, voxel, first, wanted, rowRests, &those, f, p))
      {
        for (int x = max(first, from); x <= min(to, first + LANES - 1); ++x)
        {
          those |= (uint)LookUpRest(vectors, &common, voxel, x, rowRests, f, p) << (x - first);
        }
      }
      found |= those << first;
    }
  }
  return found;
}
#endif

__kernel void LookUpField(__global const float* vectors, const LookupParameters f,
  __global const uchar* active, __global const uchar* blanked, __global const float* distances,
  __global const ulong* backgrounds, __global char* coverage, __global uint* counters,
  const RasterParameters p ARRAY_PARAMETERS)
{
  __local int rests[RESTS];
  __local uint covered[DEFORMVOLUME_TILE_ROWS];
  const int index = p.TileBegin + (int)get_group_id(0);
  int origin[3];
  const VoxelBox tile = GetTile(index, origin, &p);
  const VolumeMasks masks = { active, blanked, distances };
#if LANES == 1
  FindTileRests(vectors, tile, origin, rests, &f, &p);
  barrier(CLK_LOCAL_MEM_FENCE);
#endif
  for (int row = get_local_id(0); row < DEFORMVOLUME_TILE_ROWS; row += get_local_size(0))
  {
    __local int* rowRests = rests + row * REST_ROW_STEP;
#if LANES == 1
    uint found = 0;
    for (int x = 0; x < 1 << DEFORMVOLUME_TILE_BITS_X; ++x)
    {
      found |= (uint)(rowRests[x * REST_STEP] >= 0) << x;
    }
#else
    const uint found = FindRowRests(vectors, tile, origin, row, rowRests, &f, &p);
#endif
    covered[row] = found ? SelectSources(masks, found, rowRests, &p) : 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  SampleTile(tile, origin, rests, covered, backgrounds, coverage, &p ARRAY_ARGUMENTS);
  if (get_local_id(0) == 0)
  {
    CountTile(covered, 0, counters + index * DEFORMVOLUME_TILE_COUNTERS);
  }
}
