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

/// Checks that geometry and arrays are the same to the last bit. part may be a part of whole.
std::string CompareBits(vtkImageData* part, vtkImageData* whole);

/// Checks that the mask is 0 or 1, that voxels which are not covered have the background, and that
/// covered voxels have values between the least and the largest one of the volume. In categorical
/// arrays each value must be a value of the volume.
std::string CheckValues(vtkImageData* output, vtkImageData* volume, const Settings& settings);

/// Compares with the host reference, for volumes of exact geometry that a displacement field or a
/// mesh with a node at each voxel deforms by multiples of 1/256 voxel. Returns nullopt if it cannot
/// compare: there are too many voxels, positions are no such multiples, or cells are too large for
/// the reference.
std::optional<std::string> CompareWithReference(vtkImageData* output, vtkImageData* volume,
  vtkDataSet* deformation, const Settings& settings, vtkIdType inverted);

} // namespace fuzz

#endif
