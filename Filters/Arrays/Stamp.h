// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStamp_h
#define DeformVolumeStamp_h

#include "vtkType.h"

#include <utility>
#include <vector>

namespace deformvolume
{

/// Tells two states of VTK objects apart: addresses and modification times.
using Stamp = std::vector<std::pair<const void*, vtkMTimeType>>;

} // namespace deformvolume

#endif
