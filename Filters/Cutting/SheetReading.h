// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheetReading_h
#define DeformVolumeSheetReading_h

#include "ImageGeometry.h"
#include "Sheet.h"

#include <glm/vec3.hpp>

#include <string>
#include <vector>

class vtkPolyData;

namespace deformvolume
{

/// The triangles of a vtkPolyData, in world coordinates.
struct WorldSheet
{
  std::vector<glm::dvec3> Points;
  std::vector<Sheet::Triangle> Triangles;

  bool IsEmpty() const { return this->Triangles.empty(); }
  bool operator==(const WorldSheet& other) const
  {
    return this->Points == other.Points && this->Triangles == other.Triangles;
  }
  /// Adds what a straight edge sweeps between two places of its ends.
  void AddSweep(
    const glm::dvec3& fromA, const glm::dvec3& fromB, const glm::dvec3& toA, const glm::dvec3& toB);

  /// In continuous indices of a volume. Throws Error as Sheet does.
  Sheet GetSheet(const ImageGeometry& volume) const;
};

/// Reads triangles, polygons and triangle strips, and what polylines sweep along a vector; null
/// data are an empty sheet. Vertices, and polylines where the vector is zero, are left out. Throws
/// Error where a cell has a point that is none, the vector is not finite, or there are polylines
/// only and no vector. name: what errors call it.
WorldSheet ReadSheet(vtkPolyData* data, const glm::dvec3& sweepVector, const std::string& name);

} // namespace deformvolume

#endif
