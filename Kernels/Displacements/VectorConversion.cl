// SPDX-License-Identifier: BSD-3-Clause
// Displacements, in output voxels, of vectors in world units that lie on the device. With double precision it comes
// after the mapping by fields in place, by whose products a matrix is applied; without it there is no matrix.

static float3 ConvertVector(float3 v, const FieldParameters* field)
{
#if REAL_IS_DOUBLE
  if (field->IsMapped)
  {
    return (float3)(ROW_PRODUCT(field, 0, float, double, v.x, v.y, v.z),
      ROW_PRODUCT(field, 1, float, double, v.x, v.y, v.z),
      ROW_PRODUCT(field, 2, float, double, v.x, v.y, v.z));
  }
#endif
  return v;
}

// Four floats a point. A point whose displacement is not finite, or larger than the largest, is reported. A work-item
// takes one point.
__kernel void ConvertVectors(__global const float* vectors, const FieldParameters field, const ulong count,
  const float largest, __global float4* displacements, __global uint* firstBad)
{
  const size_t point = get_global_id(0);
  if (point >= count)
  {
    return;
  }
  const float3 moved = ConvertVector(vload3(point, vectors), &field);
  // Not-a-number is not good either.
  if (!all(fabs(moved) <= largest))
  {
    atomic_min(firstBad, (uint)point);
  }
  displacements[point] = (float4)(moved, 0.0f);
}
