// SPDX-License-Identifier: BSD-3-Clause
// Relaxation: a voxel moves towards the weighted mean of the displacements of its neighbors, within the limits of its
// links. This text comes after ChainMailBlocks.cl.
//
// Neighbors of a voxel have the other parity of x + y + z. A launch moves the voxels of one parity, and reads the
// voxels of the other parity. Therefore no limit is violated, and the order of voxels does not matter.
//
// weights: of the links between two materials, 256 * material + material. The first 65536 weights are those of links
// along the component of the displacement, the next 65536 those of all other links. reciprocals: of the sums of
// weights, as floats. A product of two floats is rounded in the same way on every device.

// Larger differences, in units, are clamped to this value: six of them times 255 fit into an int.
#define MAXIMUM_PULL (1 << 20)

INLINE int8 WeightsOf(__global const uchar* weights, uchar8 a, uchar8 b)
{
  if (AreAlike(a, b))
  {
    return (int8)(weights[a.s0 * 256 + b.s0]);
  }
  const int8 lookup = convert_int8(a) * 256 + convert_int8(b);
  return (int8)(weights[lookup.s0], weights[lookup.s1], weights[lookup.s2], weights[lookup.s3],
    weights[lookup.s4], weights[lookup.s5], weights[lookup.s6], weights[lookup.s7]);
}

INLINE float8 ReciprocalsOf(__global const float* reciprocals, int8 s)
{
  return (float8)(reciprocals[s.s0], reciprocals[s.s1], reciprocals[s.s2], reciprocals[s.s3],
    reciprocals[s.s4], reciprocals[s.s5], reciprocals[s.s6], reciprocals[s.s7]);
}

// results: set to 1 for blocks that changed. threshold: in units; voxels closer to the mean do not move.
__kernel void Relax(__global int* displacements, __global const uchar* flags,
  __global const uchar* links, __global const uchar* materials, __global const int* limits,
  __global const uchar* weights, __global const float* reciprocals, __global const uint* list,
  __global uint* results, const int parity, const float elasticity, const int threshold,
  const ChainMailGrid g)
{
  __local uint changed;
  if (get_local_id(0) == 0)
  {
    changed = 0;
  }
  BARRIER();
  const uint block = list[2 * get_group_id(0)];
  const int8 odd = (int8)(0, 1, 0, 1, 0, 1, 0, 1);
  FOR_ROWS(r)
  {
    const size_t own = (size_t)block * VOXELS + 8 * r;
    const uchar8 m = vload8(0, materials + own);
    const int8 kind = convert_int8(vload8(0, links + own));
    const int8 held = (convert_int8(vload8(0, flags + own)) &
                        (DEFORMVOLUME_HELD | DEFORMVOLUME_FIXED)) != 0;
    const int8 mine = (((odd + ((r ^ r >> 3) & 1)) & 1) == parity) & ~held &
      ((kind & (DEFORMVOLUME_ELEMENT | DEFORMVOLUME_PINNED)) == DEFORMVOLUME_ELEMENT);
    int8 x[3], pull[3], sum[3], lowest[3], highest[3];
    UNROLL
    for (int c = 0; c < 3; ++c)
    {
      x[c] = vload8(0, RowAt(displacements, own, c));
      pull[c] = 0;
      sum[c] = 0;
      lowest[c] = -NO_LIMIT;
      highest[c] = NO_LIMIT;
    }
    UNROLL_FACES
    for (int face = 0; face < 6; ++face)
    {
      Neighbors n;
      FindNeighbors(&n, displacements, links, materials, block, r, face, &g);
      const int8 there = convert_int8(n.Links) != 0;
      const int axis = face >> 1;
      const int8 along = select((int8)(0), WeightsOf(weights, m, n.Materials), there);
      const int8 across = select((int8)(0), WeightsOf(weights + 65536, m, n.Materials), there);
      int8 over[3], under[3];
      FindLimitsBeside(limits, m, n.Materials, face, over, under);
      UNROLL
      for (int c = 0; c < 3; ++c)
      {
        const int8 weight = axis == c ? along : across;
        sum[c] += weight;
        pull[c] += weight *
          clamp(n.Displacements[c] - x[c], (int8)(-MAXIMUM_PULL), (int8)(MAXIMUM_PULL));
        highest[c] =
          min(highest[c], select((int8)(NO_LIMIT), n.Displacements[c] + over[c], there));
        lowest[c] =
          max(lowest[c], select((int8)(-NO_LIMIT), n.Displacements[c] - under[c], there));
      }
    }
    int8 any = 0;
    int after[3][8];
    UNROLL
    for (int c = 0; c < 3; ++c)
    {
      const int8 best =
        convert_int8_rte(convert_float8(pull[c]) * ReciprocalsOf(reciprocals, sum[c]));
      const int8 step = convert_int8_rte(convert_float8(best) * elasticity);
      const int8 isFar = (best >= threshold) | (best <= -threshold);
      const int8 next = clamp(x[c] + step, lowest[c], highest[c]);
      const int8 moves = mine & isFar & (next != x[c]);
      any |= moves;
      vstore8(select(x[c], next, moves), 0, after[c]);
    }
    // Write only voxels of this parity: other work-items read the other voxels of the row.
    int isAny[8];
    vstore8(any, 0, isAny);
    uint rowChanged = 0;
    for (int i = (parity ^ r ^ r >> 3) & 1; i < 8; i += 2)
    {
      if (isAny[i])
      {
        rowChanged = 1;
        for (int c = 0; c < 3; ++c)
        {
          displacements[((size_t)block * 3 + c) * VOXELS + 8 * r + i] = after[c][i];
        }
      }
    }
    if (rowChanged)
    {
      OR_INTO(&changed, 1);
    }
  }
  BARRIER();
  if (get_local_id(0) == 0)
  {
    results[get_group_id(0)] |= changed;
  }
}
