// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeHandlePositions_h
#define DeformVolumeHandlePositions_h

#include <glm/vec3.hpp>

#include <string>
#include <vector>

class vtkPointSet;

namespace deformvolume
{

/// The positions at rest that handles hold, and the positions of the handles now, in world
/// coordinates.
struct HandlePositions
{
  std::vector<glm::dvec3> Rest;
  std::vector<glm::dvec3> Now;
};

/// Reads the handles on input port 1. handles: may be empty or null. body: in messages, the object
/// that the handles hold. Throws an Error if the point array RestPosition is missing, is not
/// numeric, or has another number of components or tuples, or if a coordinate is not finite.
HandlePositions ReadHandlePositions(vtkPointSet* handles, const std::string& body);

} // namespace deformvolume

#endif
