// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMapWriting_h
#define DeformVolumeMapWriting_h

#include "Volume.h"

class Messages;
class vtkDeformVolumeFilter;
struct Options;

/// Writes maps of the deformation: --jacobian and --inverse-field.

/// Makes a filter generate the arrays that WriteMaps needs.
void AskForMaps(const Options& options, vtkDeformVolumeFilter* filter);

/// Writes the maps of a deformed volume, and removes their arrays from the image. Maps are 0
/// outside the deformed volume; for an inverse field, a warning gives the number of such voxels.
/// Vectors lead from a voxel of the result to its rest position: in .vti files in the world
/// coordinates of the volume, in other files left-posterior-superior.
void WriteMaps(const Options& options, Volume& deformed, Messages& messages);

#endif
