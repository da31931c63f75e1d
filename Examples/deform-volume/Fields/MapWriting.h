// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMapWriting_h
#define DeformVolumeMapWriting_h

#include "Volume.h"

class Messages;
class vtkDeformVolumeFilter;
struct Options;

/// What is written of the deformation itself: --jacobian and --inverse-field.

/// Has a filter make the arrays that WriteMaps takes.
void AskForMaps(const Options& options, vtkDeformVolumeFilter* filter);

/// Writes these arrays of a deformed volume, and takes them out of the image. They are 0 where the
/// volume covers nothing; a warning gives the number of such voxels of a field. Vectors lead from a
/// voxel of the result to the place at rest that it shows, in the world of the volume, but in files
/// other than .vti to the left, to the back and to the head.
void WriteMaps(const Options& options, Volume& deformed, Messages& messages);

#endif
