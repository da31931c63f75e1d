// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMaskArray_h
#define DeformVolumeMaskArray_h

#include "vtkAOSDataArrayTemplate.h"
#include "vtkDataSetAttributes.h"
#include "vtkType.h"

#include <string>
#include <vector>

class vtkDataSet;
class vtkImageData;
class vtkInformation;

namespace deformvolume
{

/// An array of contiguous bytes: a vtkUnsignedCharArray, and since VTK 9.6 also other classes.
using ByteArray = vtkAOSDataArrayTemplate<unsigned char>;

/// Name of the cell array of active tetrahedra: a bit for each of the five tetrahedra of a cell.
constexpr const char* ActiveTetrahedraName = "ActiveTetrahedra";

/// Name of the point array of boundary distances: signed, to the surface of what was carved out.
constexpr const char* BoundaryDistanceName = "BoundaryDistance";

///@{
/// Names of the arrays of a smooth cut: the cell array of the tetrahedra that it crosses, and the
/// point array of signed distances to the sheet.
constexpr const char* CutTetrahedraName = "CutTetrahedra";
constexpr const char* CutDistanceName = "CutDistance";
///@}

/// Name of the point array that marks the covered points of an output, as in vtkProbeFilter. In an
/// input it marks the points that have a value.
constexpr const char* ValidPointMaskName = "vtkValidPointMask";

/// Bit of the vtkGhostType of a cell, set together with HIDDENCELL if the cell is hidden only
/// because an edit switched off tetrahedra. Such a cell is hidden in views, but the filters still
/// read its tetrahedra from the arrays above. VTK uses the first six bits.
constexpr unsigned char HiddenByEdit = 128;

/// Distances of the points of a volume.
struct DistanceValues
{
  const float* Values = nullptr; // null: there are no distances
  std::vector<float> Converted;  // storage of Values, if the array is not one of contiguous floats
};

/// Returns the boundary distances of a volume. Throws an Error if the array exists, but is not
/// numeric, or does not have one component and one tuple for each point.
DistanceValues FindBoundaryDistances(vtkImageData* volume);

/// A smooth cut of a volume.
struct CutValues
{
  const unsigned char* Crossed = nullptr; // one byte for each cell; null: there is no cut
  DistanceValues Distances;
};

/// Whether a volume has a smooth cut.
bool HasCut(vtkImageData* volume);
/// Whether the information of a source announces a smooth cut, before the volume is read. Few
/// sources announce their cell arrays.
bool IsCutAnnounced(vtkInformation* volumeInfo);
/// Returns the smooth cut of a volume. Throws an Error if only one of the two arrays exists, or if
/// one has a wrong type or size.
CutValues FindCut(vtkImageData* volume);

/// Finds the array of a name that has one byte for each of `size` points or cells. Returns null if
/// there is no array of that name. Throws an Error if the array has another type, number of
/// components or size. `what` and `owner` are words for the message, such as "cell" and "volume".
ByteArray* FindMask(vtkDataSetAttributes* attributes, const char* name, vtkIdType size,
  const std::string& what, const std::string& owner);

/// The bits of vtkGhostType that mean that a point of a volume is ignored.
constexpr unsigned char IgnoredPointBits =
  vtkDataSetAttributes::DUPLICATEPOINT | vtkDataSetAttributes::HIDDENPOINT;

/// The vtkGhostType of the points of a dataset, one byte each. Points whose vtkValidPointMask is 0
/// are hidden as well.
struct PointGhosts
{
  const unsigned char* Values = nullptr; // null: no point is a ghost
  std::vector<unsigned char> Joined;     // storage of Values, if both arrays are used
};

/// Finds the ghosts of a dataset. owner: words for messages. Throws like FindMask(), also if the
/// valid point mask does not have one component and one tuple for each point.
PointGhosts FindPointGhosts(vtkDataSet* data, const std::string& owner);

/// The cells of a dataset that are not part of it: those that vtkGhostType marks as hidden or
/// duplicate, and those with a hidden point.
class SkippedCells
{
public:
  /// owner: words for messages. Throws like FindPointGhosts().
  SkippedCells(vtkDataSet* data, const std::string& owner);

  bool Contain(vtkIdType cell) const;
  /// Whether a cell has a hidden point. Points that the dataset does not have are ignored.
  bool ContainPointOf(const vtkIdType* points, vtkIdType count) const;

private:
  const unsigned char* Cells = nullptr;
  vtkIdType NumberOfPoints = 0;
  PointGhosts Points;
};

} // namespace deformvolume

#endif
