// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeEditor_h
#define DeformVolumeVolumeEditor_h

#include "Deformation.h"
#include "DeformedPositions.h"
#include "FadedMesh.h"
#include "ImageGeometry.h"
#include "MappingCache.h"
#include "MaskEditor.h"
#include "MeshGrids.h"
#include "Stamp.h"
#include "VertexPositions.h"
#include "VolumeEdit.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <array>
#include <cstdint>
#include <memory>
#include <tuple>

class vtkFloatArray;
class vtkImageData;
class vtkInformation;
class vtkUnsignedCharArray;

namespace deformvolume
{

/// Common part of the filters that edit the active tetrahedra of a volume: the edits, the positions
/// of the vertices, and the arrays of the output.
class VolumeEditor
{
public:
  /// Sets the volume. Edits switch off some of its active tetrahedra, and reduce its boundary
  /// distances. info: pipeline information of the volume, with the whole extent, of which the
  /// volume may be a part. written: see GetWrittenStamp(). Returns whether the voxel grid has
  /// changed, in which case all edits are removed. Throws Error, and changes nothing, if there is
  /// no volume or it cannot be used.
  bool SetVolume(vtkImageData* volume, vtkInformation* info, const Stamp::value_type& written);
  const ImageGeometry& GetGeometry() const { return this->Geometry; }

  /// The positions of the vertices of the volume: at rest, or, if the source has a Shape, deformed.
  /// The Volume of the source is set here. Throws Error. The filters that use this class have the
  /// deformation on port 2 and the mesh at rest on port 3.
  const VertexPositions& GetPositions(DeformationSource source, const OutsideVoxels& outside);

  /// Adds the edit `next` and sets `edit` to its number. The edit that had the number `edit` before
  /// is removed, unless `keep` is true. 0: there was no edit.
  void Put(std::uint64_t& edit, VolumeEdit&& next, bool keep);
  /// Removes the edit with a number, and sets the number to 0.
  void Drop(std::uint64_t& edit);

  ///@{
  /// Return false if there is nothing to undo or redo.
  bool Undo() { return this->Mask && this->Mask->Undo(); }
  bool Redo() { return this->Mask && this->Mask->Redo(); }
  ///@}
  /// Removes all edits. Returns false if there were none.
  bool Reset();

  vtkIdType GetNumberOfSwitchedOffTetrahedra() const
  {
    return this->Mask ? static_cast<vtkIdType>(this->Mask->GetNumberOfSwitchedOffTetrahedra()) : 0;
  }

  vtkIdType GetNumberOfDividedTetrahedra() const
  {
    return this->Mask
      ? static_cast<vtkIdType>(this->Mask->GetSmoothCrossings().GetNumberOfDividedTetrahedra())
      : 0;
  }

  /// deformvolume::GetFarDistance() of the whole volume.
  float GetFarDistance() const { return this->Mask->GetBoundaryDistances().GetFar(); }

  /// Makes the output a shallow copy of the volume, with the remaining active tetrahedra, and with
  /// boundary distances and a smooth cut if there are any.
  void Write(vtkImageData* volume, vtkImageData* output);

private:
  std::unique_ptr<MaskEditor> Mask; // null before there is a volume
  ImageGeometry Geometry;
  Extent Whole = EmptyExtent;
  Stamp BaseStamp;
  Stamp DistancesStamp;     // of the distances of the volume
  Stamp BaseDistancesStamp; // of the distances that Mask has
  Stamp CutStamp;           // of the smooth cut of the volume
  Stamp BaseCutStamp;       // of the smooth cut that Mask has
  // Arrays of the output.
  vtkSmartPointer<vtkUnsignedCharArray> Active;
  vtkSmartPointer<vtkFloatArray> Distances;
  vtkSmartPointer<vtkUnsignedCharArray> CutTetrahedra;
  vtkSmartPointer<vtkFloatArray> CutDistances;

  std::unique_ptr<RestPositions> Rest;
  DeformationGrids Grids;
  deformvolume::Deformation Deformation;
  MappingCache Mapping;
  FadedMesh Faded; // the mesh of the mapping, if voxels outside the deformation mesh are kept
  std::unique_ptr<DeformedPositions> Deformed;
  // What Deformed was computed from: the version of the mapping, whether the deformation is a
  // field, and the voxels outside.
  using PositionsKey = std::tuple<std::uint64_t, bool, OutsideVoxels>;
  PositionsKey DeformedMapping;
  std::uint64_t DeformedVectors = 0; // a version
};

} // namespace deformvolume

#endif
