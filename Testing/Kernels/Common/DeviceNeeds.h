// SPDX-License-Identifier: BSD-3-Clause
// What a test requires of the device, as the device reports it.
#ifndef DeviceNeeds_h
#define DeviceNeeds_h

#include "VolumeDeformer.h"

#include <vector>

/// Whether the device of the tests has double precision. Without it, arrays of doubles and linear
/// arrays of 32-bit and 64-bit integers are refused, and all other arrays are interpolated in
/// single precision.
bool HasDoublePrecision();

/// Whether each work-item has the vector registers of a CPU core for itself, as resampling by lanes
/// requires.
bool HasVectors();

/// The kernels of the exact resampler that the device supports, lanes first.
std::vector<deformvolume::Resampling> GetExactMethods();

#define SKIP_WITHOUT_DOUBLE_PRECISION()                                                            \
  if (!HasDoublePrecision())                                                                       \
  {                                                                                                \
    GTEST_SKIP() << "the device has no double precision";                                          \
  }

#define SKIP_WITHOUT_VECTORS()                                                                     \
  if (!HasVectors())                                                                               \
  {                                                                                                \
    GTEST_SKIP() << "the device does not support Resampling::ExactByLanes";                        \
  }

/// For tests that include FakeDriver.h.
#define SKIP_UNLESS_GRAPHICS()                                                                     \
  if (!FakeDriver::Get().IsGraphics)                                                               \
  {                                                                                                \
    GTEST_SKIP() << "this test needs --device=gpu-like";                                           \
  }

#endif
