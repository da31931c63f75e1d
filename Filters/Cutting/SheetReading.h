// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSheetReading_h
#define DeformVolumeSheetReading_h

#include "WorldSheet.h"

#include <glm/vec3.hpp>

#include <string>

class vtkPolyData;

namespace deformvolume
{

/// Reads triangles, polygons and triangle strips, and what polylines sweep along a vector; null
/// data are an empty sheet. Vertices, and polylines where the vector is zero, are left out. Throws
/// Error where a cell has a point that is none, the vector is not finite, or there are polylines
/// only and no vector. name: what errors call it.
WorldSheet ReadSheet(vtkPolyData* data, const glm::dvec3& sweepVector, const std::string& name);

} // namespace deformvolume

#endif
