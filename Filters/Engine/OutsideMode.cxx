// SPDX-License-Identifier: BSD-3-Clause
#include "OutsideMode.h"

#include "Error.h"

#include "vtkDeformVolumeFilter.h"

#include <cmath>
#include <string>

namespace deformvolume
{

OutsideVoxels MakeOutsideVoxels(int outsideMode, double fadeDistance)
{
  if (outsideMode != vtkDeformVolumeFilter::KEEP)
  {
    return outsideMode == vtkDeformVolumeFilter::EXTRAPOLATE;
  }
  if (!std::isfinite(fadeDistance) || fadeDistance < 0.0)
  {
    throw Error("FadeDistance is " + std::to_string(fadeDistance) +
      ". Set a distance in world units, or 0, with which no voxel outside the mesh moves.");
  }
  return { OutsideVoxels::Modes::Keep, fadeDistance };
}

void CheckForField(const OutsideVoxels& outside)
{
  if (outside.AreKept())
  {
    throw Error("OutsideMode is KEEP, which needs a mesh, but the deformation is a displacement "
                "field. Set OutsideMode to DISCARD or EXTRAPOLATE, or connect a mesh.");
  }
}

} // namespace deformvolume
