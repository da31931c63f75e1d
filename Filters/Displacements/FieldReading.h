// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldReading_h
#define DeformVolumeFieldReading_h

#include "VectorArray.h"

#include <vector>

class vtkDataArray;
class vtkImageData;

namespace deformvolume
{

struct DeformationSource;

/// The vectors of a displacement field. Throws an Error where it has no points or no such vectors,
/// or its transform cannot be inverted.
vtkDataArray* FindFieldVectors(vtkImageData* image, const DeformationSource& source);

/// vtkGhostType of the points of a displacement field, or null. Throws as FindMask.
vtkDataArray* FindFieldGhosts(vtkImageData* image);

/// The hidden points, one byte each; empty where there are none. ghosts: may be null.
std::vector<unsigned char> FindHiddenPoints(vtkDataArray* ghosts);

/// Reads vectors of a field, of which those of undefined points (one byte each; empty: there are
/// none) count as zero. Throws an Error where another one is not finite.
void ReadFieldVectors(
  vtkDataArray* array, const std::vector<unsigned char>& undefined, const VectorTaker& take);

/// The values of an array of floats that lies in memory tuple by tuple; null for others, and where
/// they would have to come from a device.
const float* FindFloats(vtkDataArray* array);

} // namespace deformvolume

#endif
