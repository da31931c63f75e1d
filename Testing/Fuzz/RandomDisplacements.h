// SPDX-License-Identifier: BSD-3-Clause
// Random displacements of meshes, and random displacement fields.
#ifndef Fuzz_RandomDisplacements_h
#define Fuzz_RandomDisplacements_h

#include "RandomVolume.h"

#include <vtkDataSet.h>

#include <functional>

namespace fuzz
{

/// The name of the displacements.
constexpr const char* DISPLACEMENTS = "U";

/// Gives each point a displacement, in world units but drawn in voxels of a volume: nothing, a
/// shift, an affine or smooth map, a jitter, folds. Now and then numbers that are an error. With an
/// exact geometry they are multiples of 1/256 voxel of less than 8 voxels, in single precision.
void SetDisplacements(
  vtkDataSet* points, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

/// Changes some of the displacements, all, none, or their array; hides points of a field, where it
/// is undefined. Where that is an error the function that is returned takes it back.
std::function<void()> EditDisplacements(
  vtkDataSet* points, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

/// A displacement field over a volume or a part of it; with an exact geometry of its voxels.
vtkSmartPointer<vtkImageData> MakeField(
  vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

} // namespace fuzz

#endif
