// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTransformReading_h
#define DeformVolumeTransformReading_h

#include "Volume.h"

#include <string>
#include <vector>

class Messages;

/// An argument of --transform.
struct TransformFile
{
  std::string Path;
  bool IsInverted = false;
};

/// Samples transforms of a registration on a grid, in the world coordinates of the volume. The
/// result is an inverse field: for each point of the grid the vector to the transformed point, as
/// the float point array FieldArrayName.
///
/// files: transforms written by ITK, SimpleITK, ANTs and 3D Slicer (.h5, .hdf5, .tfm, .txt, .mat:
/// matrices, B-splines, displacement fields and compositions of these), or displacement fields in
/// the formats of ReadField. The last file is applied first, as in antsApplyTransforms. Points
/// outside the grid of a displacement field do not move. Throws a Failure if a file cannot be read
/// or inverted, if it is a transform of another program (the message then has the command that
/// converts it), or if the world axes of the volume are not known.
vtkSmartPointer<vtkImageData> ReadTransforms(const std::vector<TransformFile>& files,
  const Volume& volume, vtkImageData* grid, Messages& messages, bool showProgress);

#endif
