// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeHandlePositions_h
#define DeformVolumeHandlePositions_h

#include <glm/vec3.hpp>

#include <string>
#include <vector>

class vtkPointSet;

namespace deformvolume
{

/// What handles hold, and where they are now, in world coordinates.
struct HandlePositions
{
  std::vector<glm::dvec3> Rest;
  std::vector<glm::dvec3> Now;
};

/// Reads the handles on input port 1, of which there may be none, or null. body: what they hold, in
/// words. Throws an Error where the point array RestPosition is missing or has another shape, or a
/// coordinate is not finite.
HandlePositions ReadHandlePositions(vtkPointSet* handles, const std::string& body);

} // namespace deformvolume

#endif
