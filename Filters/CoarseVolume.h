// SPDX-License-Identifier: BSD-3-Clause
// A volume at the resolution at which its body is looked for, and where the body is in it.
#ifndef DeformVolumeCoarseVolume_h
#define DeformVolumeCoarseVolume_h

#include "vtkType.h"

#include <glm/vec3.hpp>

#include <array>
#include <vector>

namespace deformvolume
{

using Index = std::array<vtkIdType, 3>;

/// A volume at the resolution that is worked with, with a border of voxels outside the body.
struct CoarseVolume
{
  Index Size = {};       // voxels on each axis, border included
  Index Border = {};     // voxels of border on each side
  glm::dvec3 Spacing;    // world units
  glm::dvec3 FirstIndex; // where the first voxel lies in the structured index of the volume
  glm::dvec3 IndexStep;  // voxels of the volume to one of these
  std::vector<float> Values;

  vtkIdType Count() const { return this->Size[0] * this->Size[1] * this->Size[2]; }
};

/// Otsu, "A threshold selection method from gray-level histograms", 1979: the threshold between low
/// and high at which the variance between the two classes is greatest; the middle where several
/// thresholds are. Values that are not finite do not count.
double OtsuThreshold(const std::vector<float>& values, double low, double high);

/// 1 for voxels of the body, its cavities filled, and 0 for the others; empty if there is no body.
std::vector<unsigned char> FindBody(const CoarseVolume& coarse, double isovalue, bool largestOnly);

/// Replaces the values by a function that is positive in the body (enlarged by the margin, in world
/// units) and negative outside.
void MakeLevelSet(CoarseVolume& coarse, const std::vector<unsigned char>& body, double isovalue,
  double background, double margin);

} // namespace deformvolume

#endif
