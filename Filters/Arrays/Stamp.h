// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStamp_h
#define DeformVolumeStamp_h

#include "DataStamp.h"

class vtkAbstractArray;
class vtkPoints;

namespace deformvolume
{

/// Adds an array, or null, to a stamp: two entries, of which the second one also differs if the
/// array has other memory or another size.
void AddArray(Stamp& stamp, vtkAbstractArray* array);

/// Adds points, or null, and their array to a stamp.
void AddPoints(Stamp& stamp, vtkPoints* points);

} // namespace deformvolume

#endif
