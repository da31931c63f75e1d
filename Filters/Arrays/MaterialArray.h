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

/// The point array of a volume that tells materials: the one of a name, or, where that is "" and
/// there are ranges, the active scalars; else null. Throws an Error where it is not there, or has
/// several components.
vtkDataArray* FindMaterialArray(vtkImageData* volume, const std::string& name, bool hasRanges);

/// The materials of so many voxels, by an array of one component: by ranges, and fallback where
/// none holds a value, or, without ranges, the values themselves. Without an array all are
/// fallback. exists: which of the 256 materials there are. Throws an Error that names a value
/// without a material.
std::vector<unsigned char> ReadMaterials(vtkDataArray* array, vtkIdType voxels,
  const std::vector<MaterialRange>& ranges, int fallback, const std::array<bool, 256>& exists);

/// 1 where a value of an array of one component is not 0, else 0.
std::vector<unsigned char> ReadFlags(vtkDataArray* array);

} // namespace deformvolume

#endif
