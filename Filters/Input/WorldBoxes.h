// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldBoxes_h
#define DeformVolumeWorldBoxes_h

#include <string>

namespace deformvolume
{

class Deformation;
struct ImageGeometry;

/// Where a displacement field and the volume that it is given for lie in the world, in words for an
/// error.
std::string DescribeBoxes(const ImageGeometry& field, const ImageGeometry& volume);

/// Throws an Error where the boxes of a mesh at rest and of the volume do not meet.
void CheckBoxes(const Deformation& mesh, const ImageGeometry& volume);

/// What is wrong where no voxel lies in a mesh at rest.
std::string DescribeMiss(const Deformation& mesh, const ImageGeometry& volume);

} // namespace deformvolume

#endif
