// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshSpace_h
#define DeformVolumeMeshSpace_h

#include "Volume.h"

#include <string>
#include <vector>

class Messages;
class vtkDataObject;
class vtkDataSet;

/// Copies the text "SPACE=LPS" or "SPACE=RAS" of the header or a comment of a file to the field
/// data, in the form in which 3D Slicer writes it to files that have field data.
void KeepSpace(vtkDataObject* object, const char* header);

/// Returns the comment that states the axes that KeepSpace() has stored, or "".
std::string GetSpaceComment(vtkDataObject* object);

/// Converts a mesh or a sheet of a file to the world coordinates of the volume: the points, and the
/// point arrays of vectors with the given names; "" is ignored. optionValue: the value of the
/// option --mesh-space, or "". The field data of the object or of a block take precedence over the
/// option. Returns whether anything was converted. Throws a Failure if the option is given and the
/// world axes of the volume are not known.
bool ConvertToWorldOfVolume(vtkDataObject* object, const std::vector<std::string>& vectors,
  const std::string& optionValue, const std::string& path, WorldAxes ofVolume, Messages& messages);

/// Exchanges right-anterior-superior and left-posterior-superior, in points and in the point arrays
/// of the given names.
void FlipWorldAxes(vtkDataSet* data, const std::vector<std::string>& vectors);

#endif
