// SPDX-License-Identifier: BSD-3-Clause
// Fading of the displacement of a field's border outside the field.

#pragma OPENCL FP_CONTRACT OFF

// Returns the factor 1 - 3 s^2 + 2 s^3, where s is the length of `beyond`; 0 for s >= 1. The square root is computed by
// Newton's method: built-in square roots round differently on different devices, but positions must be the same.
static float WeightBeyond(float3 beyond)
{
  const float square = beyond.x * beyond.x + beyond.y * beyond.y + beyond.z * beyond.z;
  if (square >= 1.0f)
  {
    return 0.0f;
  }
  if (square < 1e-12f)
  {
    return 1.0f;
  }
  float inverseRoot = as_float(0x5f3759df - (as_int(square) >> 1)); // relative error at most 3 %
  for (int i = 0; i < 3; ++i)
  {
    inverseRoot = inverseRoot * (1.5f - 0.5f * square * inverseRoot * inverseRoot);
  }
  return 1.0f - square * (3.0f - 2.0f * (square * inverseRoot));
}
