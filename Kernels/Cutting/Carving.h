// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCarving_h
#define DeformVolumeCarving_h

#include "DeformVolumeExport.h"
#include "DistanceSet.h"
#include "EditProgress.h"
#include "IndexBounds.h"
#include "TetrahedronSet.h"
#include "VertexPositions.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <vector>

namespace deformvolume
{

/// Which tetrahedra a tool carves. A tetrahedron is carved if its centroid (Centroid), any of its
/// vertices (Conservative), or all of its vertices (Minimal) are inside the tool. With Centroid the
/// carved volume is on average as large as the tool.
enum class CarvingRule
{
  Centroid,
  Conservative,
  Minimal
};

/// A body to carve out: the points where a function of the position is negative. Not-a-number
/// counts as outside.
struct CarvingTool
{
  /// Computes the values at `count` points, in continuous structured indices of the volume. Called
  /// by several threads.
  std::function<void(const glm::dvec3* points, std::size_t count, double* values)> Function;
  /// Computes the distances of points from the boundary of the body, not negative, in the unit of
  /// boundary distances; they need to be accurate near the boundary only. Null: the absolute values
  /// of Function are used.
  std::function<void(const glm::dvec3* points, std::size_t count, double* distances)> Distance;
  /// No point outside these bounds is inside the tool. Bricks outside are skipped.
  IndexBounds Bounds;
  /// Whether the function is linear, like that of a plane. If it is linear, and all corners of the
  /// box of a brick are on one side, FindCarvedTetrahedra() does not evaluate the function inside
  /// this box.
  bool IsLinear = false;
  /// Whether the function is known at the vertices of the volume at rest only, like a label map.
  /// The value at a centroid is then the mean of the values at the vertices.
  bool IsOfVertices = false;
};

/// Returns infinite bounds, for tools that may carve anywhere in the volume.
DEFORMVOLUME_EXPORT IndexBounds GetUnlimitedBounds();

/// Makes a tool from the path of a sphere: the capsules between consecutive centers, or a single
/// sphere. radii: the radii of the sphere on each axis, in the unit of centers. Throws an Error if
/// there is no center, a value is not finite, or a radius is not greater than 0.
DEFORMVOLUME_EXPORT CarvingTool MakeSweptSphere(
  const std::vector<glm::dvec3>& centers, const glm::dvec3& radii);

/// Finds the tetrahedra of the sampling mesh that a tool carves out. The centroid of a tetrahedron
/// is the mean of its vertices. Tetrahedra with a vertex without position are skipped.
DEFORMVOLUME_EXPORT TetrahedronSet FindCarvedTetrahedra(const VertexPositions& positions,
  const CarvingTool& tool, CarvingRule rule, const EditProgress& progress = nullptr);

/// The result of carving with a boundary that passes between vertices.
struct SmoothCarving
{
  /// The tetrahedra with all vertices inside.
  TetrahedronSet Tetrahedra;
  /// The boundary distances of the vertices of cells through which the boundary passes. Other
  /// vertices have the distance -far if they are inside; if they are outside, they have the
  /// distance far or are not in the set.
  DistanceSet Distances;
};

/// Carves with a smooth boundary. far: the distance of vertices that are far from the boundary.
DEFORMVOLUME_EXPORT SmoothCarving FindSmoothCarving(const VertexPositions& positions,
  const CarvingTool& tool, float far, const EditProgress& progress = nullptr);

} // namespace deformvolume

#endif
