// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePipelineGeometry_h
#define DeformVolumePipelineGeometry_h

#include "ImageGeometry.h"

class vtkImageData;
class vtkInformation;

namespace deformvolume
{

ImageGeometry GetGeometry(vtkImageData* image);
/// Sets the origin, the spacing and the direction of an image.
void SetTransform(vtkImageData* image, const ImageGeometry& geometry);

/// The geometry that pipeline information announces. Its extent is the whole extent.
ImageGeometry GetGeometry(vtkInformation* info);

} // namespace deformvolume

#endif
