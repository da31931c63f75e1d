// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaterialArray_h
#define DeformVolumeMaterialArray_h

#include "VoxelMaterials.h"

#include "vtkType.h"

#include <array>
#include <string>
#include <vector>

class vtkDataArray;
class vtkImageData;

namespace deformvolume
{

/// Finds the point array of a volume from which materials are read: the array called `name`, or, if
/// `name` is "" and there are ranges, the active scalars. Returns null if `name` is "" and there
/// are no ranges. Throws an Error if the array does not exist, is not numeric, or does not have one
/// component and one tuple for each voxel.
vtkDataArray* FindMaterialArray(vtkImageData* volume, const std::string& name, bool hasRanges);

/// Reads the materials of the voxels from an array of one component. With ranges, a voxel has the
/// material of the range that contains its value, or `fallback` if no range does. Without ranges,
/// the values are the materials. Without an array, all voxels have the material `fallback`. exists:
/// which of the 256 materials are defined. ghosts: null, or a byte for each voxel; voxels with one
/// of the IgnoredPointBits are not read, and have the material `fallback`. Throws an Error that
/// names a value without a material.
std::vector<unsigned char> ReadMaterials(vtkDataArray* array, vtkIdType voxels,
  const std::vector<MaterialRange>& ranges, int fallback, const std::array<bool, 256>& exists,
  const unsigned char* ghosts = nullptr);

/// Converts the values of an array of one component to flags: 0 for 0, and 1 for other values.
std::vector<unsigned char> ReadFlags(vtkDataArray* array);

} // namespace deformvolume

#endif
