// SPDX-License-Identifier: BSD-3-Clause
// How the displacement of a field's border fades outside the field.

#pragma OPENCL FP_CONTRACT OFF

// What is left of it: 1 - 3 s^2 + 2 s^3, s being the length of beyond, and nothing from 1 on. The root is found by
// Newton's method, as devices round their own ones differently, and a position must be the same on all.
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
  float inverseRoot = as_float(0x5f3759df - (as_int(square) >> 1)); // by 3 % off at most
  for (int i = 0; i < 3; ++i)
  {
    inverseRoot = inverseRoot * (1.5f - 0.5f * square * inverseRoot * inverseRoot);
  }
  return 1.0f - square * (3.0f - 2.0f * (square * inverseRoot));
}
