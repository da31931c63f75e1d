// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStamp_h
#define DeformVolumeStamp_h

#include "vtkType.h"

#include <utility>
#include <vector>

namespace deformvolume
{

/// Addresses and modification times of VTK objects. Two stamps differ if one of the objects was
/// replaced or modified.
using Stamp = std::vector<std::pair<const void*, vtkMTimeType>>;

} // namespace deformvolume

#endif
