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
/// displacements are not copied to the host.
class BoxBounds
{
public:
  explicit BoxBounds(WorkDevice& device)
    : Device(device)
  {
  }

  /// Computes the bounds in each box. displacements: four finite floats per point. size: points of
  /// the field on each axis.
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
