// SPDX-License-Identifier: BSD-3-Clause
// Interpolation between the points of a field. This text comes after MultiplyAdd.cl.

// Only MULTIPLY_ADD may fuse multiply and add.
#pragma OPENCL FP_CONTRACT OFF

// a + t (b - a) is exact for t = 0, where a voxel is a point of the field.
#define MIX(a, b, t) MULTIPLY_ADD((float4)(t), (b) - (a), a)

// Interpolates the displacement trilinearly at the continuous index f, from 0 to last. width, plane: points of a row
// and of a plane.
static float4 InterpolatePoints(__global const float4* points, size_t width, size_t plane, float3 f, int3 last)
{
  const int3 low = min(convert_int3(floor(f)), last);
  const int3 high = min(low + 1, last);
  const float3 t = f - convert_float3(low);
  __global const float4* const lowLow = points + low.z * plane + low.y * width;
  __global const float4* const lowHigh = points + low.z * plane + high.y * width;
  __global const float4* const highLow = points + high.z * plane + low.y * width;
  __global const float4* const highHigh = points + high.z * plane + high.y * width;
  const float4 a = MIX(lowLow[low.x], lowLow[high.x], t.x);
  const float4 b = MIX(lowHigh[low.x], lowHigh[high.x], t.x);
  const float4 c = MIX(highLow[low.x], highLow[high.x], t.x);
  const float4 d = MIX(highHigh[low.x], highHigh[high.x], t.x);
  return MIX(MIX(a, b, t.y), MIX(c, d, t.y), t.z);
}

#undef MIX
