// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldAtRest_h
#define DeformVolumeFieldAtRest_h

#include "ImageGeometry.h"

#include "vtkSmartPointer.h"

class vtkImageData;

namespace deformvolume
{

/// A displacement field of zeros that holds all of a volume: what stands in for a deformation where
/// there is none. The zeros are its active vectors.
vtkSmartPointer<vtkImageData> MakeFieldAtRest(const ImageGeometry& volume);

} // namespace deformvolume

#endif
