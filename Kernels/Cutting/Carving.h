// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCarving_h
#define DeformVolumeCarving_h

#include "DeformVolumeExport.h"
#include "DistanceSet.h"
#include "EditProgress.h"
#include "Extent.h"
#include "IndexBounds.h"
#include "TetrahedronSet.h"
#include "VertexPositions.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <vector>

namespace deformvolume
{

/// Which tetrahedra a tool carves out: those that have their centroid, any vertex, or all vertices
/// inside it. What is carved by the first is on average as large as the tool.
enum class CarvingRule
{
  Centroid,
  Conservative,
  Minimal
};

/// A body that is carved out: where a function of position is negative. Values that are no numbers
/// are outside.
struct CarvingTool
{
  /// The values at so many points, in continuous structured indices of the volume. Called by many
  /// threads.
  std::function<void(const glm::dvec3* points, std::size_t count, double* values)> Function;
  /// How far points are from the boundary of the body, not negative, in the unit of all edits: near
  /// the boundary. Where there is no such function, the values above are taken, without their sign.
  std::function<void(const glm::dvec3* points, std::size_t count, double* distances)> Distance;
  /// Nothing outside these bounds is inside the tool. Bricks that lie outside are not looked at.
  IndexBounds Bounds;
  /// Whether the function is linear, as that of a plane: of a brick whose corners are on one side
  /// nothing else is looked at.
  bool IsLinear = false;
};

/// A tool without bounds: all of the volume is looked at.
DEFORMVOLUME_EXPORT IndexBounds GetUnlimitedBounds();

/// The capsules that a sphere sweeps out that moves from center to center along straight lines, or
/// a single sphere. radii: of the sphere in voxels, on each axis. Throws Error where there is no
/// center, or something is not finite, or a radius is not greater than 0.
DEFORMVOLUME_EXPORT CarvingTool MakeSweptSphere(
  const std::vector<glm::dvec3>& centers, const glm::dvec3& radii);

/// The tetrahedra of the sampling mesh that a tool carves out. The centroid of a tetrahedron is the
/// mean of its vertices. A tetrahedron with a vertex that has no position is left alone.
DEFORMVOLUME_EXPORT TetrahedronSet FindCarvedTetrahedra(const VertexPositions& positions,
  const CarvingTool& tool, CarvingRule rule, const EditProgress& progress = nullptr);

/// The same where the values at the vertices are known, such as where a label is: wherever these
/// are now. The value at a centroid is the mean of those at the vertices. find: the values of the
/// vertices in a box of structured indices, x varying fastest; called by many threads.
DEFORMVOLUME_EXPORT TetrahedronSet FindCarvedTetrahedra(const CellBricks& bricks,
  const std::function<void(const Extent& vertices, double* values)>& find, CarvingRule rule,
  const EditProgress& progress = nullptr);

/// What a tool carves out with a boundary between vertices.
struct SmoothCarving
{
  /// Those with all vertices inside.
  TetrahedronSet Tetrahedra;
  /// Of the vertices of cells that the boundary passes through; other vertices are far inside, or
  /// are not in the set.
  DistanceSet Distances;
};

/// far: the distance that counts as far from the boundary.
DEFORMVOLUME_EXPORT SmoothCarving FindSmoothCarving(const VertexPositions& positions,
  const CarvingTool& tool, float far, const EditProgress& progress = nullptr);

/// The same where values at the vertices are known, as for FindCarvedTetrahedra; distance: of all
/// vertices from the boundary.
DEFORMVOLUME_EXPORT SmoothCarving FindSmoothCarving(const CellBricks& bricks,
  const std::function<void(const Extent& vertices, double* values)>& find, double distance,
  float far, const EditProgress& progress = nullptr);

} // namespace deformvolume

#endif
