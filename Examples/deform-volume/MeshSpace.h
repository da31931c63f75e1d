// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshSpace_h
#define DeformVolumeMeshSpace_h

#include "Volume.h"

#include <string>

class Messages;
class vtkDataObject;

/// Keeps what the header or a comment of a file says of its space, "SPACE=LPS" or "SPACE=RAS",
/// where 3D Slicer puts it in files that have room for it: in the field data.
void KeepSpace(vtkDataObject* object, const char* header);

/// Turns a mesh or a sheet of a file into the world of the volume: the points, and the point array
/// of displacements, which is "" where there is none. said: what the option --mesh-space says, or
/// "". What the field data of the object or of one of its blocks say is used before that. Throws a
/// Failure where the option cannot be followed, as the space of the volume is not known.
void TurnIntoWorld(vtkDataObject* object, const std::string& displacement, const std::string& said,
  const std::string& path, WorldAxes ofVolume, Messages& messages);

#endif
