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

/// The extent of the coarse volume. Its voxels are those whose structured indices are multiples of
/// the factor, and their indices in the coarse volume are these indices divided by the factor.
Extent CoarsenExtent(const Extent& voxels, int factor);

/// The geometry of the coarse volume: its voxels keep their positions in the world.
ImageGeometry CoarsenExtent(const ImageGeometry& volume, int factor);

/// The extent of the volume from the first to the last voxel of a coarse extent.
Extent RefineExtent(const Extent& coarse, int factor);

/// Makes an array with one tuple for each point of the coarse extent, from an array with one tuple
/// for each point of the fine extent. Point (i, j, k) of the coarse extent gets the tuple of point
/// (factor * i, factor * j, factor * k).
vtkSmartPointer<vtkDataArray> SampleTuples(
  vtkDataArray* array, const Extent& fine, const Extent& coarse, int factor);

/// Throws an Error if a coarse volume has fewer than two voxels on an axis.
void CheckCoarse(const ImageGeometry& coarse, int factor);

/// The coarse volume of a volume, kept until the volume changes. Voxels keep their blanking. If all
/// tetrahedra of the cells that a coarse cell covers are active, those of the coarse cell are
/// active, too; otherwise none of them is.
class CoarseVolume
{
public:
  /// Makes the coarse arrays and masks from those of the volume, and replaces the entries of
  /// `arrays` by the coarse arrays. Returns an image that has the masks. With a factor of 1 it
  /// changes nothing and returns `volume`.
  vtkImageData* Update(vtkImageData* volume, int factor, std::vector<SourceArray>& arrays);

  void Forget();

private:
  void CopyArrays(const std::vector<SourceArray>& arrays, const Extent& fine, int factor);

  vtkSmartPointer<vtkImageData> Image;
  std::vector<vtkSmartPointer<vtkDataArray>> Arrays;
  Extent Voxels = EmptyExtent; // of the volume that the copies were made from
  Stamp ArraysStamp;
  Stamp MasksStamp;
};

} // namespace deformvolume

#endif
