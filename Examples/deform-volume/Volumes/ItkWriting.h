// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeItkWriting_h
#define DeformVolumeItkWriting_h

#include <vtkMatrix4x4.h>

#include <string>

class vtkImageData;

/// Writes the scalars of an image as MetaImage (.mha, .mhd) or NRRD (.nrrd, .nhdr). axes:
/// directions and the position of the first voxel, as GetAxes returns them, in the world
/// coordinates left, posterior, superior. Returns what went wrong, or "". Throws a Failure if ITK
/// does not have the type of the values.
std::string WriteByITK(vtkImageData* image, vtkMatrix4x4* axes, const std::string& path);

#endif
