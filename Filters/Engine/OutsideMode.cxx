// SPDX-License-Identifier: BSD-3-Clause
#include "OutsideMode.h"

#include "vtkDeformVolumeFilter.h"

namespace deformvolume
{

OutsideVoxels MakeOutsideVoxels(int outsideMode, double fadeDistance)
{
  if (outsideMode != vtkDeformVolumeFilter::KEEP)
  {
    return outsideMode == vtkDeformVolumeFilter::EXTRAPOLATE;
  }
  return MakeKeptVoxels(fadeDistance);
}

} // namespace deformvolume
