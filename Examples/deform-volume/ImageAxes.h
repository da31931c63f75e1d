// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeImageAxes_h
#define DeformVolumeImageAxes_h

#include <vtkMatrix4x4.h>
#include <vtkSmartPointer.h>

#include <string>
#include <vector>

class vtkImageData;

/// The matrix whose columns are the directions of the index axes and the world position of the
/// first voxel of the image's extent. It takes (index - first index) * spacing to the world.
vtkSmartPointer<vtkMatrix4x4> GetAxes(vtkImageData* image);

/// Gives the image these directions and this position of its index 0. Lengths of the columns go
/// into the spacing. Returns false, and does nothing, where they are not perpendicular.
bool SetAxes(vtkImageData* image, vtkMatrix4x4* axes);

/// Exchanges the conventions right-anterior-superior and left-posterior-superior.
void FlipWorldAxes(vtkMatrix4x4* axes);

/// The value of a field in the text header of a MetaImage or NRRD file ("" where it is missing):
/// what follows the name and the separator, '=' or ':'.
std::string ReadHeaderField(const std::string& path, const std::string& name, char separator);

/// All numbers in a text, in their order, whatever stands between them.
std::vector<double> FindNumbers(const std::string& text);

#endif
