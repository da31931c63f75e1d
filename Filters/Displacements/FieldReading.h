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

/// The vectors of a displacement field. Throws an Error if the field has no points or no usable
/// vectors, or if its transform cannot be inverted.
vtkDataArray* FindFieldVectors(vtkImageData* image, const DeformationSource& source);

/// The hidden points of a displacement field (FindPointGhosts()), one byte each; empty if there are
/// none. Throws like FindMask().
std::vector<unsigned char> FindHiddenPoints(vtkImageData* image);

/// Reads the vectors of a field. Vectors of undefined points become zero. undefined: one byte for
/// each point; empty: all points are defined. Throws an Error if a vector of a defined point is not
/// finite.
void ReadFieldVectors(
  vtkDataArray* array, const std::vector<unsigned char>& undefined, const VectorTaker& take);

/// The values of an array of structs of floats. Null for other arrays, and if the values would have
/// to be downloaded from a device.
const float* FindFloats(vtkDataArray* array);

} // namespace deformvolume

#endif
