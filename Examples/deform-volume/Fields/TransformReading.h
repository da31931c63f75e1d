// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTransformReading_h
#define DeformVolumeTransformReading_h

#include "Volume.h"

#include <string>
#include <vector>

class Messages;

/// A file of --transform.
struct TransformFile
{
  std::string Path;
  bool IsInverted = false;
};

/// The displacement field of a registration's transform, on the grid of an image that lies in the
/// world of a volume: for each voxel the vector to the point that the transform leads to, as the
/// point array FieldArrayName of floats. That is what a resampling of the volume by the transform
/// needs: an inverse field.
///
/// files: transforms as ITK, SimpleITK, ANTs and 3D Slicer write them (.h5, .hdf5, .tfm, .txt,
/// .mat: matrices, B-splines, displacement fields and compositions of these) or displacement fields
/// in the formats of ReadField. A point goes through the last file first, as with
/// antsApplyTransforms. Outside the grid of a displacement field a point stays where it is. Throws
/// a Failure for what cannot be read or inverted, for transforms of other programs with the command
/// that converts them, and where the world of the volume is not known.
vtkSmartPointer<vtkImageData> ReadTransforms(const std::vector<TransformFile>& files,
  const Volume& volume, vtkImageData* grid, Messages& messages, bool showProgress);

#endif
