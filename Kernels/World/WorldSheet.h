// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldSheet_h
#define DeformVolumeWorldSheet_h

#include "DeformVolumeExport.h"
#include "ImageGeometry.h"
#include "Sheet.h"

#include <glm/vec3.hpp>

#include <vector>

namespace deformvolume
{

/// Triangles in world coordinates: a sheet to cut with, or a closed surface to carve with.
struct DEFORMVOLUME_EXPORT WorldSheet
{
  /// The points.
  std::vector<glm::dvec3> Points;
  /// The indices of three points for each triangle.
  std::vector<Sheet::Triangle> Triangles;

  /// Whether there are no triangles.
  bool IsEmpty() const { return this->Triangles.empty(); }
  /// Whether points and triangles are the same.
  bool operator==(const WorldSheet& other) const
  {
    return this->Points == other.Points && this->Triangles == other.Triangles;
  }
  /// Adds two triangles for the surface that a straight edge sweeps while its ends move from fromA
  /// and fromB to toA and toB.
  void AddSweep(
    const glm::dvec3& fromA, const glm::dvec3& fromB, const glm::dvec3& toA, const glm::dvec3& toB);

  /// Returns the sheet in continuous indices of a volume. Throws an Error if the constructor of
  /// Sheet does.
  Sheet GetSheet(const ImageGeometry& volume) const;
};

} // namespace deformvolume

#endif
