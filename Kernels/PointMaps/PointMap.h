// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointMap_h
#define DeformVolumePointMap_h

#include "DeformVolumeExport.h"
#include "OutsideVoxels.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace deformvolume
{

/// A deformation of single points, in world coordinates and double precision. Functions that are
/// const may be called by many threads.
class DEFORMVOLUME_EXPORT PointMap
{
public:
  /// Where a point goes, and the derivatives of that by where it was.
  struct Image
  {
    /// Where the point goes.
    glm::dvec3 Point{ 0.0 };
    /// The derivatives of Point by where the point was: column k by coordinate k.
    glm::dmat3 Gradient{ 1.0 };
    /// Outside, how far the point of the border moves whose displacement fades there; else 0.
    double FadingDisplacement = 0.0;
  };

  PointMap() = default;
  virtual ~PointMap();
  PointMap(const PointMap&) = delete;
  PointMap& operator=(const PointMap&) = delete;

  /// False where the point is outside.
  virtual bool Map(const glm::dvec3& point, Image& image) const = 0;
  /// The point that is mapped to a point, and the derivatives of the inverse map. Where there are
  /// several, one where the map does not turn space inside out, and of those the one in the lowest
  /// tetrahedron or cell, or else one outside. False where there is none.
  bool Invert(const glm::dvec3& point, Image& image) const;

protected:
  /// Invert for places in the mesh or the field.
  virtual bool InvertInside(const glm::dvec3& point, Image& image) const = 0;
  /// Inverts the map by Newton's method from a start; steps that do not come closer are shortened.
  /// False where it does not converge.
  bool Solve(const glm::dvec3& point, const glm::dvec3& start, Image& image) const;

  OutsideVoxels Outside;
  double SolutionTolerance = 0.0; // the distance that Newton's method leaves
};

} // namespace deformvolume

#endif
