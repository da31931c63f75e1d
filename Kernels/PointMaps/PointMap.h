// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointMap_h
#define DeformVolumePointMap_h

#include "DeformVolumeExport.h"
#include "OutsideVoxels.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace deformvolume
{

/// A deformation of single points, in world coordinates and double precision. Several threads may
/// call const functions at the same time.
class DEFORMVOLUME_EXPORT PointMap
{
public:
  /// The image of a point, and the derivatives of the map.
  struct Image
  {
    /// The mapped position.
    glm::dvec3 Point{ 0.0 };
    /// Derivatives of Point with respect to the original position: column k for coordinate k.
    glm::dmat3 Gradient{ 1.0 };
    /// The derivatives for Newton's method, where they differ from Gradient: points that are within
    /// the tolerance outside the border of a field move with the border, although their vectors
    /// and normals change as inside.
    std::optional<glm::dmat3> StepGradient = std::nullopt;
    /// For a point whose displacement fades outside the mesh or the field: length of the
    /// displacement of the closest point on the boundary of the mesh or the border of the field.
    /// Otherwise 0.
    double FadingDisplacement = 0.0;
  };

  PointMap() = default;
  virtual ~PointMap();
  PointMap(const PointMap&) = delete;
  PointMap& operator=(const PointMap&) = delete;

  /// Maps a point. Returns false if the deformation is not defined there.
  virtual bool Map(const glm::dvec3& point, Image& image) const = 0;
  /// Finds the point that is mapped to `point`, and the derivatives of the inverse map. Of several
  /// solutions, one where the map is not inverted is preferred, then the one in the first
  /// tetrahedron (TetrahedronOrder) or the lowest cell, then one outside. Returns false if there is
  /// no solution.
  bool Invert(const glm::dvec3& point, Image& image) const;

protected:
  /// Finds a solution for Invert() within the mesh or the field.
  virtual bool InvertInside(const glm::dvec3& point, Image& image) const = 0;
  /// Inverts the map by Newton's method from a start. Steps that do not reduce the distance are
  /// shortened. Returns false if the method does not converge.
  bool Solve(const glm::dvec3& point, const glm::dvec3& start, Image& image) const;

  OutsideVoxels Outside;
  double SolutionTolerance = 0.0; // largest distance at which Newton's method counts as converged
};

/// Moves a point by a map, or by its inverse. Without a map, and outside, the image is the point
/// itself. Returns false if the point is outside.
DEFORMVOLUME_EXPORT bool MovePoint(
  const PointMap* map, bool isInverse, const glm::dvec3& point, PointMap::Image& image);

} // namespace deformvolume

#endif
