// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeImageAxes_h
#define DeformVolumeImageAxes_h

#include <vtkMatrix4x4.h>
#include <vtkSmartPointer.h>

#include <string>

class Messages;
class vtkImageData;

/// The matrix whose columns are the directions of the index axes and the world position of the
/// first voxel of the image's extent. It takes (index - first index) * spacing to the world.
vtkSmartPointer<vtkMatrix4x4> GetAxes(vtkImageData* image);

/// Gives an image whose extent begins at 0 these directions and this position of its first voxel.
/// Lengths of the columns are factors on its spacing.
///
/// vtkImageData has perpendicular axes. A shear (the cosine of the angle between two axes) of up to
/// 1e-3 is taken out: the nearest perpendicular axes are used, and the middle of the image stays
/// where it is; from 1e-5 on, which rounding in the file does not explain, a warning says how far
/// voxels lie from their places. Throws a Failure where the shear is larger or a column is 0; path
/// is the file, advice one more sentence.
void SetAxes(vtkImageData* image, vtkMatrix4x4* axes, const std::string& path, Messages& messages,
  const std::string& advice = "");

/// Exchanges the conventions right-anterior-superior and left-posterior-superior.
void FlipWorldAxes(vtkMatrix4x4* axes);
void FlipWorldAxes(vtkImageData* image);

#endif
