// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFrameTaker_h
#define DeformVolumeFrameTaker_h

#include <functional>

struct Deformation;

/// What is done with each frame on the way to a deformation. It may do nothing.
using FrameTaker = std::function<void(const Deformation&)>;

#endif
