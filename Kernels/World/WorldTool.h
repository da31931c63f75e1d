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

/// A function of points, as in CarvingTool.
using PointFunction = std::function<void(const glm::dvec3* points, std::size_t count, double*)>;
/// The gradients of such a function.
using PointGradient = std::function<void(const glm::dvec3* points, std::size_t count, glm::dvec3*)>;

/// Returns a function for the first-order distance from the boundary of the body in which
/// `function` is negative: the absolute value of `function` divided by the length of its gradient,
/// or the absolute value alone if the gradient is 0.
DEFORMVOLUME_EXPORT PointFunction MakeFirstOrderDistance(
  const PointFunction& function, const PointGradient& gradient);

/// Returns a function for the distances from a surface in world coordinates. Triangles without area
/// are ignored.
DEFORMVOLUME_EXPORT PointFunction MakeSurfaceDistance(const WorldSheet& surface);

/// Converts a function of points in world coordinates to a function of continuous indices of a
/// volume.
DEFORMVOLUME_EXPORT PointFunction GetInIndices(
  const PointFunction& function, const ImageGeometry& volume);
/// Converts a tool in world coordinates, with its bounds, to continuous indices of a volume.
DEFORMVOLUME_EXPORT CarvingTool GetInIndices(const CarvingTool& tool, const ImageGeometry& volume);

} // namespace deformvolume

#endif
