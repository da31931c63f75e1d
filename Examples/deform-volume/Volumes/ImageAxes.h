// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeImageAxes_h
#define DeformVolumeImageAxes_h

#include <vtkMatrix4x4.h>
#include <vtkSmartPointer.h>

#include <string>

class Messages;
class vtkImageData;

/// Returns the number of voxels on each axis, such as "25 x 22 x 19".
std::string DescribeSize(vtkImageData* image);

/// Returns the matrix whose columns are the directions of the index axes and the world position of
/// the first voxel of the extent. It transforms (index - first index) * spacing to the world.
vtkSmartPointer<vtkMatrix4x4> GetAxes(vtkImageData* image);

/// Sets directions and origin of an image from a matrix as GetAxes returns it. The extent of the
/// image must begin at 0. Its spacing is multiplied by the lengths of the columns.
///
/// vtkImageData has perpendicular axes. If the shear (the cosine of the angle between two axes) is
/// at most 1e-3, the nearest perpendicular axes are used, and the center of the image does not
/// move. A shear of more than 1e-5 is not rounding of the file: a warning gives the largest
/// displacement of a voxel. Throws a Failure if the shear is larger than 1e-3 or if a column is 0.
/// path: the file that messages name. advice: appended to the message.
void SetAxes(vtkImageData* image, vtkMatrix4x4* axes, const std::string& path, Messages& messages,
  const std::string& advice = "");

/// Exchanges the conventions right-anterior-superior and left-posterior-superior.
void FlipWorldAxes(vtkMatrix4x4* axes);
void FlipWorldAxes(vtkImageData* image);

/// Reverses the order of the slices of an image in its scalars.
void ReverseSlices(vtkImageData* image);

/// Adapts the axes of an image to slices in reverse order. depth: distance of the last slice from
/// the first one.
void ReverseSlices(vtkMatrix4x4* axes, double depth);

#endif
