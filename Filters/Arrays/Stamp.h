// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStamp_h
#define DeformVolumeStamp_h

#include "vtkType.h"

#include <utility>
#include <vector>

class vtkAbstractArray;
class vtkPoints;

namespace deformvolume
{

/// Addresses and modification times of VTK objects. Two stamps differ if one of the objects was
/// replaced or modified.
using Stamp = std::vector<std::pair<const void*, vtkMTimeType>>;

/// Adds an array, or null, to a stamp: two entries, of which the second one also differs if the
/// array has other memory or another size.
void AddArray(Stamp& stamp, vtkAbstractArray* array);

/// Adds points, or null, and their array to a stamp.
void AddPoints(Stamp& stamp, vtkPoints* points);

} // namespace deformvolume

#endif
