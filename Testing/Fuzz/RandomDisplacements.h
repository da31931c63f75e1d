// SPDX-License-Identifier: BSD-3-Clause
// Random displacements of meshes, and random displacement fields.
#ifndef Fuzz_RandomDisplacements_h
#define Fuzz_RandomDisplacements_h

#include "RandomVolume.h"

#include <vtkDataSet.h>

#include <functional>

namespace fuzz
{

/// The name of the array of displacements.
constexpr const char* DISPLACEMENTS = "U";

/// Gives each point a displacement: zero, a shift, an affine or smooth map, a jitter, folds, or
/// rarely numbers that are an error. Displacements are chosen in voxels of a volume and converted
/// to world units. With an exact geometry they are multiples of 1/256 voxel of less than 8 voxels,
/// in single precision.
void SetDisplacements(
  vtkDataSet* points, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

/// Changes some displacements, all, none, or their array, or hides points of a field, which makes
/// the field undefined there. If the change is an error, returns a function that reverts it.
std::function<void()> EditDisplacements(
  vtkDataSet* points, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

/// Returns a displacement field over a volume or a part of it. With an exact geometry the points of
/// the field are the voxels.
vtkSmartPointer<vtkImageData> MakeField(
  vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

} // namespace fuzz

#endif
