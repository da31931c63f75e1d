// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldTool_h
#define DeformVolumeWorldTool_h

#include "Carving.h"
#include "DeformVolumeExport.h"
#include "ImageGeometry.h"
#include "WorldSheet.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>

namespace deformvolume
{

/// What CarvingTool has: values of points.
using PointFunction = std::function<void(const glm::dvec3* points, std::size_t count, double*)>;
/// The gradients of such a function.
using PointGradient = std::function<void(const glm::dvec3* points, std::size_t count, glm::dvec3*)>;

/// The distance from the boundary of the body where a function is negative, to first order: the
/// value of the function by the length of its gradient, or the value where that is 0.
DEFORMVOLUME_EXPORT PointFunction MakeFirstOrderDistance(
  const PointFunction& function, const PointGradient& gradient);

/// The distances from a surface in world coordinates. Triangles without area do not count.
DEFORMVOLUME_EXPORT PointFunction MakeSurfaceDistance(const WorldSheet& surface);

/// A function of points in world coordinates as one of continuous indices of a volume.
DEFORMVOLUME_EXPORT PointFunction GetInIndices(
  const PointFunction& function, const ImageGeometry& volume);
/// The same for a tool, with its bounds.
DEFORMVOLUME_EXPORT CarvingTool GetInIndices(const CarvingTool& tool, const ImageGeometry& volume);

} // namespace deformvolume

#endif
