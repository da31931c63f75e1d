// SPDX-License-Identifier: BSD-3-Clause
// The isovalue that separates the body in a volume from what is around it.
#ifndef DeformVolumeBodyIsovalue_h
#define DeformVolumeBodyIsovalue_h

#include <array>

class vtkDataArray;
class vtkImageData;

namespace deformvolume
{

/// Otsu's threshold for the means of blocks of voxels, of about the size `resolution` in world
/// units. Voxels that are hidden or not finite do not count. Throws Error where there is none.
double FindIsovalue(vtkImageData* volume, vtkDataArray* array, double resolution);

/// The least and the greatest of the finite values that are not hidden; the first is greater than
/// the second where there are none.
std::array<double, 2> FindRange(vtkImageData* volume, vtkDataArray* array);

} // namespace deformvolume

#endif
