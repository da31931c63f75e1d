// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldTool_h
#define DeformVolumeWorldTool_h

#include "Carving.h"
#include "ImageGeometry.h"
#include "SheetReading.h"

#include <cstddef>
#include <functional>

class vtkImplicitFunction;

namespace deformvolume
{

/// The tool that a function in world coordinates is: it carves out where the function is negative.
/// The tool holds the function. Functions that VTK is not known to evaluate in several threads at a
/// time are evaluated in one. Spheres and boxes without a transform have bounds. The distance from
/// the boundary is to first order: the value of the function by the length of its gradient.
CarvingTool MakeWorldTool(vtkImplicitFunction* function);

/// The distances from a surface in world coordinates, of points in continuous indices of a volume.
std::function<void(const glm::dvec3* points, std::size_t count, double* distances)> MakeDistance(
  const WorldSheet& surface, const ImageGeometry& volume);

/// A tool in world coordinates as one in continuous indices of a volume.
CarvingTool GetInIndices(const CarvingTool& tool, const ImageGeometry& volume);

} // namespace deformvolume

#endif
