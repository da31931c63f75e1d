// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshSpace_h
#define DeformVolumeMeshSpace_h

#include "Volume.h"

#include <string>
#include <vector>

class Messages;
class vtkDataObject;
class vtkDataSet;

/// Keeps what the header or a comment of a file says of its space, "SPACE=LPS" or "SPACE=RAS",
/// where 3D Slicer puts it in files that have room for it: in the field data.
void KeepSpace(vtkDataObject* object, const char* header);

/// Turns a mesh or a sheet of a file into the world of the volume: the points, and the point arrays
/// of vectors with these names; "" is none. said: what the option --mesh-space says, or "". What
/// the field data of the object or of one of its blocks say is used before that. Returns whether
/// there was something to turn. Throws a Failure where the option cannot be followed, as the space
/// of the volume is not known.
bool TurnIntoWorld(vtkDataObject* object, const std::vector<std::string>& vectors,
  const std::string& said, const std::string& path, WorldAxes ofVolume, Messages& messages);

/// Exchanges right-anterior-superior and left-posterior-superior, in points and these vectors.
void ExchangeWorlds(vtkDataSet* data, const std::vector<std::string>& vectors);

#endif
