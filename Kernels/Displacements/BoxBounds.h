// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoxBounds_h
#define DeformVolumeBoxBounds_h

#include "DisplacementBounds.h"
#include "Extent.h"
#include "WorkDevice.h"

#include <array>
#include <vector>

namespace deformvolume
{

/// Computes the bounds of the displacements of a field in boxes of its points, on the device. The
/// displacements are not copied to the host. displacements: four finite floats per point. size:
/// points of the field on each axis.
std::vector<DisplacementBounds> FindBoxBounds(WorkDevice& device, const cl::Buffer& displacements,
  const std::array<int, 3>& size, const std::vector<Extent>& boxes);

} // namespace deformvolume

#endif
