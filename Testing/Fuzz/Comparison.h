// SPDX-License-Identifier: BSD-3-Clause
// Checks of a deformed volume. Each function returns a description of the failure, or "".
#ifndef Fuzz_Comparison_h
#define Fuzz_Comparison_h

#include "Settings.h"

#include <vtkImageData.h>

#include <optional>
#include <string>

namespace fuzz
{

/// The same geometry, and the same arrays to the last bit. part may be a part of whole.
std::string CompareBits(vtkImageData* part, vtkImageData* whole);

/// The mask is 0 or 1; what is not covered is background; what is covered lies between the least
/// and the largest value of the volume, and is one of its values where an array is categorical.
std::string CheckValues(vtkImageData* output, vtkImageData* volume, const Settings& settings);

/// Against the host reference, for volumes of exact geometry that a displacement field or a mesh
/// with a node at each voxel deforms by multiples of 1/256 voxel. Nothing where it was not
/// compared: too many voxels, positions that are no such multiples, or cells too large for the
/// reference.
std::optional<std::string> CompareWithReference(vtkImageData* output, vtkImageData* volume,
  vtkDataSet* deformation, const Settings& settings, vtkIdType inverted);

} // namespace fuzz

#endif
