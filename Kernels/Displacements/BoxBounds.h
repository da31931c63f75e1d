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

/// What the displacements of a field lie between, in each of some boxes of its points: found on the
/// device, so that they need not come to the host.
class BoxBounds
{
public:
  explicit BoxBounds(WorkDevice& device)
    : Device(device)
  {
  }

  /// displacements: four floats a point, all finite. size: the points of the field on each axis.
  std::vector<DisplacementBounds> Find(const cl::Buffer& displacements,
    const std::array<int, 3>& size, const std::vector<Extent>& boxes);

  void Clear();

private:
  WorkDevice& Device;
  std::vector<Extent> Boxes;
  cl::Buffer BoxesThere; // on the device
};

} // namespace deformvolume

#endif
