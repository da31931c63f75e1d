// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheetReading_h
#define DeformVolumeSheetReading_h

#include "WorldSheet.h"

#include <glm/vec3.hpp>

#include <optional>
#include <string>

class vtkPolyData;

namespace deformvolume
{

/// Reads the triangles, polygons and triangle strips of a sheet, and the areas that its polylines
/// sweep along a vector. Null data give an empty sheet. Vertex cells are ignored, and so are hidden
/// and duplicate cells, and polylines if the vector is zero or empty. Throws Error if a cell uses a
/// point that does not exist, if the vector is not finite, or if there are only polylines and the
/// vector is zero or empty. sweepVector: empty for surfaces, whose filter has no such vector. name:
/// the name of the sheet in messages.
WorldSheet ReadSheet(
  vtkPolyData* data, const std::optional<glm::dvec3>& sweepVector, const std::string& name);

} // namespace deformvolume

#endif
