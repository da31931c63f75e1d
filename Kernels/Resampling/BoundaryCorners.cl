// SPDX-License-Identifier: BSD-3-Clause
// The corners of the pieces with which the boundary of the deformation mesh is resampled (BoundaryCells.cl).

// Computes the deformed positions of the corners of pieces, in 1/256 output voxel, and their displacements. For a
// mesh: points: nodes; tetrahedra: in the format of links. For a field: points: its displacements as float4.
__kernel void MoveCorners(__global const BoundaryCorner* corners, __global const int4* tetrahedra,
  __global const float4* points, const int4 dimensions, __global int4* positions, __global float4* displacements,
  const uint count)
{
  const uint i = get_global_id(0);
  if (i >= count)
  {
    return;
  }
  const BoundaryCorner corner = corners[i];
  float4 d = 0.0f;
  if (dimensions.x > 0)
  {
    const float3 f = (float3)(corner.Weights[0], corner.Weights[1], corner.Weights[2]);
    const size_t width = dimensions.x;
    d = InterpolatePoints(points, width, width * dimensions.y, f, dimensions.xyz - 1);
  }
  else if (corner.Node >= 0)
  {
    const int offset = ((__global const int*)tetrahedra)[4 * (size_t)corner.Tetrahedron + corner.Node];
    d = points[offset / DEFORMVOLUME_NODE_STRIDE];
  }
  else
  {
    const int4 offsets = tetrahedra[corner.Tetrahedron];
    const int nodes[4] = { offsets.x, offsets.y, offsets.z, offsets.w };
    for (int k = 0; k < 4; ++k)
    {
      d = MULTIPLY_ADD((float4)(corner.Weights[k]), points[nodes[k] / DEFORMVOLUME_NODE_STRIDE], d);
    }
  }
  // Both the integer and the fractional part of this product are exact.
  const float4 steps = clamp(d, -16384.0f, 16384.0f) * 256.0f;
  const float4 whole = floor(steps);
  const float4 fraction = (float4)(corner.Fraction[0], corner.Fraction[1], corner.Fraction[2], 0.0f);
  positions[i] = (int4)(corner.Whole[0], corner.Whole[1], corner.Whole[2], 0) + convert_int4(whole) +
    convert_int4_rte(fraction + (steps - whole));
  displacements[i] = d;
}
