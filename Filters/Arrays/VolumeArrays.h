// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeArrays_h
#define DeformVolumeVolumeArrays_h

#include "MaskArray.h"
#include "PointRanges.h"
#include "Stamp.h"
#include "VolumeArray.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <optional>
#include <set>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSetAttributes;
class vtkImageData;
class vtkPointData;

namespace deformvolume
{

/// A point array of the volume that is resampled.
struct SourceArray
{
  vtkDataArray* Array = nullptr;
  /// Its place among the point arrays.
  int Index = 0;
  bool Categorical = false;
};

/// The point arrays of a volume to resample; the names and types of those that cannot be (bits,
/// strings) are appended to leftOut. Throws an Error where there is nothing to resample or a
/// size is wrong.
std::vector<SourceArray> SelectArrays(vtkImageData* volume,
  const std::set<std::string>& categorical, std::vector<std::string>& leftOut);

/// The arrays, with their data and an owner where the kernels can read these as they are.
std::vector<VolumeArray> MakeVolumeArrays(
  const std::vector<SourceArray>& arrays, double background);

/// What an upload of arrays depends on.
Stamp GetStamp(const std::vector<SourceArray>& arrays);

/// Gives an array in another layout the data and the owner of a copy.
void CopyIntoCommonLayout(vtkDataArray* array, VolumeArray& described);

/// A new array with the type, components and names of another and the given number of tuples.
vtkSmartPointer<vtkDataArray> MakeLike(vtkDataArray* array, vtkIdType numberOfTuples);

/// Where the values of an array that MakeLike() made are written.
void* GetWritableValues(vtkDataArray* array);

/// Gives arrays[i] of the output the roles (active scalars, vectors, ...) that sources[i] has.
void CopyRoles(
  vtkDataSetAttributes* from, vtkDataSetAttributes* to, const std::vector<SourceArray>& sources);

/// What is no source, one byte a voxel, the active tetrahedra, one byte a cell, the distances to
/// the boundary of what has been carved out, a float a voxel, and what a smooth cut crosses. In the
/// memory of the volume where that serves as it is.
struct VolumeMasks
{
  /// Null where there are no such voxels for certain.
  const unsigned char* Blanked = nullptr;
  unsigned char BlankedBits = 0; // of each byte that make it so
  /// Null where all tetrahedra are active.
  const unsigned char* Active = nullptr;
  std::vector<unsigned char> Joined; // with what cells are hidden
  DistanceValues Distances;
  CutValues Cut;

  ///@{
  /// What was written since a stamp was taken (GetMasksStamp), where logs tell that.
  std::optional<PointRanges> WrittenBlanked;
  std::optional<PointRanges> WrittenActive;
  std::optional<PointRanges> WrittenDistances;
  ///@}
};

/// last: of the masks that were read last; empty: there are none.
VolumeMasks ReadMasks(vtkImageData* volume, const Stamp& last);

/// Switches off the tetrahedra that a smooth cut crosses, for what knows no such cuts.
void SwitchOffCut(VolumeMasks& masks, std::size_t numberOfCells);

/// What ReadMasks depends on.
Stamp GetMasksStamp(vtkImageData* volume);

/// Names of the cell arrays that are not resampled.
std::vector<std::string> GetUnusedCellArrays(vtkImageData* volume);

} // namespace deformvolume

#endif
