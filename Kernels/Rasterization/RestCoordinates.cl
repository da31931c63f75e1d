// SPDX-License-Identifier: BSD-3-Clause
// Rest coordinates for mesh rasterization: the positions in the undeformed volume of the voxels that a tetrahedron
// holds.
//
// The displacement is interpolated, d3 + sum of w_k (d_k - d3), rather than the rest coordinate: a mesh that moves as
// a whole then moves the volume exactly. It is evaluated at the first voxel of a tile, and continued by forward
// differences in integers, which do not drift. Neither depends on the extent of the output.
//
// This text comes after TileTetrahedra.cl.
//
// Data: see MeshRasterization.cl. Rest coordinates are 32-bit integers. Their steps are 64-bit integers with
// STEP_BITS additional bits.

// Forward differences are used up to this rest coordinate, in voxels. Beyond it (slivers with huge gradients) each
// voxel is evaluated on its own.
#define LARGEST_REST 524288
#define STEP_BITS 18

// The map from edge functions to rest coordinates, in 2^-FractionBits voxel.
typedef struct
{
  REAL Last[3];         // displacement of the last node, in output voxels
  REAL Gradients[3][3]; // by edge function, by axis
  REAL Scale[3];        // from output voxels, along the same axis
  // In a tile: the rest coordinate of its first voxel, and the steps to the next voxel on x, y and z, each for three
  // axes, with STEP_BITS additional bits; and whether these values fit.
  long Start[3];
  long Steps[3][3];
  int Fits;
} RestMap;

// Finds the rest coordinate of an output voxel. edges: the edge functions there.
static void FindRest(OF_GROUP const RestMap* map, const long* edges, const int* voxel, REAL* rest,
  const RasterParameters* p)
{
  REAL moved[3]; // the position of the voxel minus its displacement
  for (int axis = 0; axis < 3; ++axis)
  {
    REAL d = map->Last[axis];
    for (int k = 0; k < 3; ++k)
    {
      d = MULTIPLY_ADD_REAL((REAL)edges[k], map->Gradients[k][axis], d);
    }
    moved[axis] = (REAL)voxel[axis] - d;
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const REAL one = (REAL)(1 << p->FractionBits[axis]);
    rest[axis] = MULTIPLY_ADD_REAL(moved[axis], map->Scale[axis],
      -((REAL)((long)p->First[axis] << p->FractionBits[axis]) + OFFSET_ELEMENT(p, axis) * one));
    for (int k = 0; p->HasTurnedAxes && k < 3; ++k)
    {
      const REAL element = k == axis ? 0 : INVERSE_ELEMENT(p, axis, k) * one;
      rest[axis] = MULTIPLY_ADD_REAL(moved[k], element, rest[axis]);
    }
  }
}

static void SetRestMap(OF_GROUP const TileTetrahedron* t, int4 ofNodes, __global const float4* displacements,
  const int* origin, OF_GROUP RestMap* map, const RasterParameters* p)
{
  const int nodes[3] = { ofNodes.x, ofNodes.y, ofNodes.z };
  const float4 last = displacements[ofNodes.w];
  const float lasts[3] = { last.x, last.y, last.z };
  REAL slopes[3][3] = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 } };
  long edges[3];
  for (int k = 0; k < 3; ++k)
  {
    const float4 d = displacements[nodes[k]];
    const float ds[3] = { d.x, d.y, d.z };
    const Vector step = t->Steps[k];
    edges[k] = t->Start[k] + (origin[0] - t->Box.Low.x) * step.x +
      (origin[1] - t->Box.Low.y) * step.y + (origin[2] - t->Box.Low.z) * step.z;
    for (int axis = 0; axis < 3; ++axis)
    {
      const REAL gradient = ((REAL)ds[axis] - (REAL)lasts[axis]) * t->InverseVolume;
      map->Gradients[k][axis] = gradient;
      slopes[0][axis] = MULTIPLY_ADD_REAL((REAL)step.x, gradient, slopes[0][axis]);
      slopes[1][axis] = MULTIPLY_ADD_REAL((REAL)step.y, gradient, slopes[1][axis]);
      slopes[2][axis] = MULTIPLY_ADD_REAL((REAL)step.z, gradient, slopes[2][axis]);
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    map->Last[axis] = (REAL)lasts[axis];
    map->Scale[axis] = INVERSE_ELEMENT(p, axis, axis) * (REAL)(1 << p->FractionBits[axis]);
  }
  REAL start[3];
  FindRest(map, edges, origin, start, p);
  const REAL finer = (REAL)(1 << STEP_BITS);
  map->Fits = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    REAL steps[3];
    REAL range = fabs(start[axis]);
    for (int direction = 0; direction < 3; ++direction)
    {
      steps[direction] =
        ((direction == axis ? (REAL)1 : (REAL)0) - slopes[direction][axis]) * map->Scale[axis];
      for (int k = 0; p->HasTurnedAxes && k < 3; ++k)
      {
        const REAL element =
          k == axis ? 0 : INVERSE_ELEMENT(p, axis, k) * (REAL)(1 << p->FractionBits[axis]);
        steps[direction] = MULTIPLY_ADD_REAL(
          (direction == k ? (REAL)1 : (REAL)0) - slopes[direction][k], element, steps[direction]);
      }
      range += 32 * fabs(steps[direction]);
    }
    if (!(range < LARGEST_REST * (REAL)(1 << p->FractionBits[axis])))
    {
      map->Fits = 0;
      return;
    }
    map->Start[axis] = (long)floor(start[axis] * finer + (REAL)0.5);
    for (int direction = 0; direction < 3; ++direction)
    {
      map->Steps[direction][axis] = (long)floor(steps[direction] * finer + (REAL)0.5);
    }
  }
}

// Finds the rest coordinates of some voxels of a row one by one. voxel: the first voxel of the row. edges: the edge
// functions there. bits: the wanted voxels. Returns the voxels whose rest coordinates lie inside the volume.
static uint FindRestsOneByOne(OF_GROUP const TileTetrahedron* t, OF_GROUP const RestMap* map, const long* edges,
  const int* voxel, uint bits, __local int* rests, const RasterParameters* p)
{
  uint found = 0;
  for (int x = 0; x < 32; ++x)
  {
    if (!(bits >> x & 1))
    {
      continue;
    }
    const long here[3] = { edges[0] + x * t->Steps[0].x, edges[1] + x * t->Steps[1].x,
      edges[2] + x * t->Steps[2].x };
    const int at[3] = { voxel[0] + x, voxel[1], voxel[2] };
    REAL rest[3];
    FindRest(map, here, at, rest, p);
    int inside = 1;
    for (int axis = 0; axis < 3; ++axis)
    {
      inside &= rest[axis] >= (REAL)-p->Tolerance[axis] &&
        rest[axis] <= (REAL)((p->Size[axis] - 1) << p->FractionBits[axis]) + p->Tolerance[axis];
    }
    if (inside)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        const int most = (p->Size[axis] - 1) << p->FractionBits[axis];
        rests[axis * REST_AXIS_STEP + x * REST_STEP] =
          min(max(convert_int_sat_rte(rest[axis]), 0), most);
      }
      found |= 1u << x;
    }
  }
  return found;
}

// Does the same as FindRestsOneByOne by forward differences. y and z are relative to the first voxel of the tile.
static uint FindRests(
  OF_GROUP const RestMap* map, int y, int z, uint bits, __local int* rests, const RasterParameters* p)
{
  const int first = popcount((bits & -bits) - 1);
  const int last = 31 - clz(bits);
  uint whole[3];
  uint wholeStep[3];
  float fraction[3];
  float fractionStep[3];
  float estimate[3];
  float estimateStep[3];
  int inside = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    const long start = map->Start[axis] + y * map->Steps[1][axis] + z * map->Steps[2][axis];
    const long step = map->Steps[0][axis];
    const long most = (long)((p->Size[axis] - 1) << p->FractionBits[axis]) << STEP_BITS;
    const long begin = start + first * step;
    const long end = start + last * step;
    inside &= begin >= 0 && begin <= most && end >= 0 && end <= most;
    whole[axis] = (uint)(start >> STEP_BITS);
    wholeStep[axis] = (uint)(step >> STEP_BITS);
    fraction[axis] = (float)(start & ((1 << STEP_BITS) - 1)) * (1.0f / (1 << STEP_BITS));
    fractionStep[axis] = (float)(step & ((1 << STEP_BITS) - 1)) * (1.0f / (1 << STEP_BITS));
    const float unit = 1.0f / ((float)(1 << STEP_BITS) * (float)(1 << p->FractionBits[axis]));
    estimate[axis] = (float)start * unit;
    estimateStep[axis] = (float)step * unit;
  }
  uint found = inside ? bits : 0;
  for (int x = first & -LANES; x <= last; x += LANES)
  {
    const uint wanted = bits >> x & LANE_MASK;
    const INTS lane = LANE_INDEX + x;
    const FLOATS laneFloat = TO_FLOATS(lane);
    INTS mask = -((INTS)((int)wanted) >> LANE_INDEX & 1);
    INTS rest[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      rest[axis] = AS_INTS(whole[axis] + AS_UINTS(lane) * wholeStep[axis]) +
        ROUND_TO_INTS(fraction[axis] + laneFloat * fractionStep[axis]);
    }
    if (!inside)
    {
      // These integers can overflow. They are correct near the volume, which a float estimate tests.
      for (int axis = 0; axis < 3; ++axis)
      {
        const int most = (p->Size[axis] - 1) << p->FractionBits[axis];
        const FLOATS near = estimate[axis] + laneFloat * estimateStep[axis];
        mask &= (near > -1.0f) & (near < (float)p->Size[axis]) &
          (rest[axis] >= -p->Tolerance[axis]) & (rest[axis] <= most + p->Tolerance[axis]);
        rest[axis] = min(max(rest[axis], 0), most);
      }
      // Collect one bit for each lane.
      int lanes[LANES];
      STORE(mask, lanes);
      for (int i = 0; i < LANES; ++i)
      {
        found |= (uint)(lanes[i] & 1) << (x + i);
      }
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      __local int* target = rests + axis * REST_AXIS_STEP + x * REST_STEP;
      STORE(select(LOAD(target), rest[axis], mask), target);
    }
  }
  return found;
}
