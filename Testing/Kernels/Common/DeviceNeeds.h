// SPDX-License-Identifier: BSD-3-Clause
// What a test needs of the device, by what the device says of itself.
#ifndef DeviceNeeds_h
#define DeviceNeeds_h

#include "VolumeDeformer.h"

#include <vector>

/// Whether the device of the tests has double precision. Without it arrays of doubles and linear
/// arrays of integers of 32 and 64 bits are refused, and all others are interpolated in single
/// precision.
bool HasDoublePrecision();

/// Whether a work-item has the vector registers of a processor for itself, as the resampling by
/// lanes needs.
bool HasVectors();

/// The kernels of the exact resampling that the device can run, lanes first.
std::vector<deformvolume::Resampling> GetExactMethods();

#define SKIP_WITHOUT_DOUBLE_PRECISION()                                                            \
  if (!HasDoublePrecision())                                                                       \
  {                                                                                                \
    GTEST_SKIP() << "the device has no double precision";                                          \
  }

#define SKIP_WITHOUT_VECTORS()                                                                     \
  if (!HasVectors())                                                                               \
  {                                                                                                \
    GTEST_SKIP() << "work-items of the device have no vector registers for themselves";            \
  }

/// For tests that include FakeDriver.h.
#define SKIP_UNLESS_GRAPHICS()                                                                     \
  if (!FakeDriver::Get().IsGraphics)                                                               \
  {                                                                                                \
    GTEST_SKIP() << "for --device=gpu-like";                                                       \
  }

#endif
