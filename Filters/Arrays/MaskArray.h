// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaskArray_h
#define DeformVolumeMaskArray_h

#include "vtkAOSDataArrayTemplate.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkDataSetAttributes;
class vtkImageData;
class vtkInformation;

namespace deformvolume
{

/// Bytes in memory, one after the other: a vtkUnsignedCharArray is one, and since VTK 9.6 others
/// are, too.
using ByteArray = vtkAOSDataArrayTemplate<unsigned char>;

/// The cell array that tells which tetrahedra are active.
constexpr const char* ActiveTetrahedraName = "ActiveTetrahedra";

/// The point array of signed distances to the boundary of what has been carved out.
constexpr const char* BoundaryDistanceName = "BoundaryDistance";

///@{
/// The cell array that tells which tetrahedra a smooth cut crosses, and the point array of signed
/// distances to the sheet.
constexpr const char* CutTetrahedraName = "CutTetrahedra";
constexpr const char* CutDistanceName = "CutDistance";
///@}

/// Which points of an output are deformed ones, as vtkProbeFilter names it.
constexpr const char* ValidPointMaskName = "vtkValidPointMask";

/// The bit that vtkGhostType of a cell has beside HIDDENCELL where only an edit hides the cell, for
/// views: the arrays above say what is left of it. VTK uses the first six bits.
constexpr unsigned char HiddenByEdit = 128;

/// Distances of the points of a volume.
struct DistanceValues
{
  const float* Values = nullptr; // null: there are none
  std::vector<float> Converted;  // where they are not floats in memory, one after the other
};

/// Throws an Error where the array is there, but not numeric, of one component and as long as the
/// volume has points.
DistanceValues FindBoundaryDistances(vtkImageData* volume);

/// A smooth cut of a volume.
struct CutValues
{
  const unsigned char* Crossed = nullptr; // one a cell; null: there is no cut
  DistanceValues Distances;
};

/// Whether a volume comes with a smooth cut.
bool HasCut(vtkImageData* volume);
/// Whether a source says that its volume does, before it is there. Few do.
bool IsCutAnnounced(vtkInformation* volumeInfo);
/// Throws an Error where one of the arrays is there and not the other one, or of another type or
/// size.
CutValues FindCut(vtkImageData* volume);

/// An array of one byte for each of `size` points or cells, or null where there is none of the
/// name. Throws an Error where the array is there, but of another type, shape or size. `what` and
/// `owner` are its words: "cell" and "volume" for a cell array of the volume.
ByteArray* FindMask(vtkDataSetAttributes* attributes, const char* name, vtkIdType size,
  const std::string& what, const std::string& owner);

/// The ghosts of a volume's points, one byte each; null where there are none. Throws as FindMask.
const unsigned char* FindPointGhosts(vtkImageData* volume);

} // namespace deformvolume

#endif
