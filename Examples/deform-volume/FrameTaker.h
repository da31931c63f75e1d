// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFrameTaker_h
#define DeformVolumeFrameTaker_h

#include <functional>

struct Deformation;

/// Called with the deformation of each frame of a model, for example to draw it.
using FrameTaker = std::function<void(const Deformation&)>;

#endif
