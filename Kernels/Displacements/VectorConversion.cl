// SPDX-License-Identifier: BSD-3-Clause
// Conversion of vectors in world units to displacements in output voxels, on the device. With double precision, this
// text comes after the mapping by fields in place, which defines ROW_PRODUCT. Without it, there is no matrix.

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

// Converts the vectors of `count` points, beginning at point `first`, to displacements of four floats per point.
// displacements: of all points. firstBad: set to the first point whose displacement is not finite or exceeds `largest`.
// A work-item processes one point.
__kernel void ConvertVectors(__global const float* vectors, const FieldParameters field, const ulong first,
  const ulong count, const float largest, __global float4* displacements, __global uint* firstBad)
{
  if (get_global_id(0) >= count)
  {
    return;
  }
  const size_t point = first + get_global_id(0);
  const float3 moved = ConvertVector(vload3(get_global_id(0), vectors), &field);
  // True for NaN, too.
  if (!all(fabs(moved) <= largest))
  {
    atomic_min(firstBad, (uint)point);
  }
  displacements[point] = (float4)(moved, 0.0f);
}
