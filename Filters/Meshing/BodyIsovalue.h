// SPDX-License-Identifier: BSD-3-Clause
// The isovalue that separates the body in a volume from its surroundings.
#ifndef DeformVolumeBodyIsovalue_h
#define DeformVolumeBodyIsovalue_h

class vtkDataArray;
class vtkImageData;

namespace deformvolume
{

/// Otsu's threshold for the means of blocks of voxels, of about the size `resolution` in world
/// units. Voxels that are hidden or not finite are ignored, and so is the padding of CT around the
/// circle of the scanner. A small part with very large values, such as metal, does not count.
/// Throws Error if there are no other voxels, or if their values are all equal.
double FindIsovalue(vtkImageData* volume, vtkDataArray* array, double resolution);

} // namespace deformvolume

#endif
