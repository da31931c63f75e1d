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
  /// Index among the point arrays of the volume.
  int Index = 0;
  bool Categorical = false;
  bool IsDensity = false;
};

/// Selects the point arrays of a volume that can be resampled. categorical: names of arrays that
/// are not interpolated. The names and types of arrays that cannot be resampled (bits, strings) are
/// appended to leftOut. Throws an Error if there is nothing to resample, an array has a wrong size,
/// or two arrays have the same name.
std::vector<SourceArray> SelectArrays(vtkImageData* volume,
  const std::set<std::string>& categorical, std::vector<std::string>& leftOut);

/// Describes arrays for the engine. Data and Owner are set only for arrays of structs, which
/// kernels can read without a copy.
std::vector<VolumeArray> MakeVolumeArrays(
  const std::vector<SourceArray>& arrays, double background);

/// Differs if the arrays have to be uploaded again.
Stamp GetStamp(const std::vector<SourceArray>& arrays);

/// Copies an array into an array of structs, and sets Data and Owner of `described` to the copy.
void CopyToAOS(vtkDataArray* array, VolumeArray& described);

/// A new array with the type, components and names of another and the given number of tuples.
vtkSmartPointer<vtkDataArray> MakeArrayLike(vtkDataArray* array, vtkIdType numberOfTuples);

/// Copies the names, the lookup table and the information of an array, but no values.
void CopyDescription(vtkDataArray* from, vtkDataArray* to);

/// The memory of the values of an array of structs, such as MakeArrayLike() makes; null for other
/// layouts.
void* GetWritableValues(vtkDataArray* array);

/// Gives array i of `to` the attribute roles (active scalars, vectors and others) that sources[i]
/// has in `from`.
void CopyAttributeRoles(
  vtkDataSetAttributes* from, vtkDataSetAttributes* to, const std::vector<SourceArray>& sources);

/// The masks of a volume: blanked voxels, active tetrahedra, boundary distances and a smooth cut.
/// Pointers lead to the arrays of the volume, or to members of this struct where values had to be
/// converted.
struct VolumeMasks
{
  /// One byte for each voxel; null if no voxel is blanked.
  const unsigned char* Blanked = nullptr;
  unsigned char BlankedBits = 0; // bits of a byte that mean that the voxel is blanked
  /// One byte for each cell, with a bit for each of its tetrahedra; null if all are active.
  const unsigned char* Active = nullptr;
  std::vector<unsigned char> Joined; // storage of Active, if cells are hidden
  PointGhosts Ghosts;                // storage of Blanked
  DistanceValues Distances;
  CutValues Cut;

  ///@{
  /// Tuples that were written since the stamp that ReadMasks() got, according to the logs of the
  /// arrays. Empty: unknown.
  std::optional<PointRanges> WrittenBlanked;
  std::optional<PointRanges> WrittenActive;
  std::optional<PointRanges> WrittenDistances;
  ///@}
  /// Whether the smooth cut has not changed since this stamp.
  bool HasSameCut = false;
};

/// Reads the masks of a volume. last: GetMasksStamp() at the last reading; empty: there was none.
VolumeMasks ReadMasks(vtkImageData* volume, const Stamp& last);

/// Switches off the tetrahedra that a smooth cut crosses, and removes the cut. For models without
/// smooth cuts.
void SwitchOffCut(VolumeMasks& masks, std::size_t numberOfCells);

/// Differs if ReadMasks() may give another result.
Stamp GetMasksStamp(vtkImageData* volume);

/// Names of the cell arrays that are not resampled.
std::vector<std::string> GetUnusedCellArrays(vtkImageData* volume);

} // namespace deformvolume

#endif
