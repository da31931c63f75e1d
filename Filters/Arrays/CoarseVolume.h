// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCoarseVolume_h
#define DeformVolumeCoarseVolume_h

#include "ImageGeometry.h"
#include "VolumeArrays.h"

#include "vtkSmartPointer.h"

#include <vector>

class vtkImageData;

namespace deformvolume
{

/// The extent of those voxels whose structured indices a factor divides, in indices divided by it.
Extent GetCoarse(const Extent& voxels, int factor);

/// The geometry of these voxels: they lie where they lay.
ImageGeometry GetCoarse(const ImageGeometry& volume, int factor);

/// The extent of the volume from the first to the last of some of these voxels.
Extent GetFine(const Extent& coarse, int factor);

/// An array of some tuples of another one, which has a tuple for each point of the fine extent: a
/// point of the coarse extent has that of the point whose structured indices are a factor times
/// its.
vtkSmartPointer<vtkDataArray> TakeTuples(
  vtkDataArray* array, const Extent& fine, const Extent& coarse, int factor);

/// Throws an Error where these are fewer than two on an axis.
void CheckCoarse(const ImageGeometry& coarse, int factor);

/// A volume of those voxels of another one whose structured indices a factor divides, kept until
/// the other one changes. Voxels keep their blanking. A cell has all its tetrahedra where all cells
/// that it covers have all of theirs, and else none.
class CoarseVolume
{
public:
  /// Makes it of a volume and its arrays, and puts its own in their place. A factor of 1 changes
  /// nothing. Returns an image that has the masks.
  vtkImageData* Update(vtkImageData* volume, int factor, std::vector<SourceArray>& arrays);

  void Forget();

private:
  void CopyArrays(const std::vector<SourceArray>& arrays, const Extent& fine, int factor);

  vtkSmartPointer<vtkImageData> Image;
  std::vector<vtkSmartPointer<vtkDataArray>> Arrays;
  Extent Voxels{ { 0, -1, 0, -1, 0, -1 } }; // of the volume that this was made of
  Stamp ArraysStamp;
  Stamp MasksStamp;
};

} // namespace deformvolume

#endif
