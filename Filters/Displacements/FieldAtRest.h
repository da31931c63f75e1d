// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldAtRest_h
#define DeformVolumeFieldAtRest_h

#include "ImageGeometry.h"

#include "vtkSmartPointer.h"

class vtkImageData;

namespace deformvolume
{

/// Makes a displacement field of zeros that contains the whole volume, for use if no deformation is
/// connected. The zeros are its active vectors.
vtkSmartPointer<vtkImageData> MakeFieldAtRest(const ImageGeometry& volume);

} // namespace deformvolume

#endif
