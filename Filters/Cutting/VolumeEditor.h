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
#include "VertexPositions.h"
#include "VolumeEdit.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <array>
#include <cstdint>
#include <memory>

class vtkFloatArray;
class vtkImageData;
class vtkInformation;
class vtkUnsignedCharArray;

namespace deformvolume
{

/// What the filters that edit the active tetrahedra of a volume have in common: the edits, where
/// the vertices of the volume are, and the array of the output.
class VolumeEditor
{
public:
  /// Takes a volume with its own active tetrahedra, from which the edits are taken away, and with
  /// its own boundary distances, which edits make smaller. info: what announces the volume that it
  /// may be a part of. Returns whether its voxels lie elsewhere than before: then there are no
  /// edits any more. Throws Error, and leaves all as it was, where there is no volume, or it cannot
  /// be used.
  bool SetVolume(vtkImageData* volume, vtkInformation* info);
  const ImageGeometry& GetGeometry() const { return this->Geometry; }

  /// Where the vertices of the volume are: at rest, or with a Shape where the deformation has moved
  /// them. The source's volume is set here. Throws Error; ports have the numbers that they have in
  /// the filters here, the deformation 2 and the rest configuration 3.
  const VertexPositions& GetPositions(DeformationSource source, const OutsideVoxels& outside);

  /// Makes an edit in the place of another one, of which the number is known; 0: of none. keep: the
  /// other one stays, too.
  void Put(std::uint64_t& edit, VolumeEdit&& next, bool keep);
  /// Removes an edit.
  void Drop(std::uint64_t& edit);

  ///@{
  /// False where there is nothing to be undone or redone.
  bool Undo() { return this->Mask && this->Mask->Undo(); }
  bool Redo() { return this->Mask && this->Mask->Redo(); }
  ///@}
  /// False where there were no edits.
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

  /// See deformvolume::GetFarDistance(): of the whole volume.
  float GetFarDistance() const { return this->Mask->GetFarDistance(); }

  /// Makes an output the volume with its arrays, the active tetrahedra that are left, and the
  /// boundary distances and the smooth cut where there are some.
  void Write(vtkImageData* volume, vtkImageData* output);

private:
  void WriteMask();
  void WriteDistances();
  void WriteCut();

  std::unique_ptr<MaskEditor> Mask; // null before there is a volume
  ImageGeometry Geometry;
  Extent Whole{ { 0, -1, 0, -1, 0, -1 } };
  Stamp BaseStamp;
  Stamp DistancesStamp;     // of those that the volume comes with
  Stamp BaseDistancesStamp; // and of those that edits are taken from
  Stamp CutStamp;           // of the smooth cut that the volume comes with
  Stamp BaseCutStamp;       // and of that which edits are joined with
  // Those of the output.
  vtkSmartPointer<vtkUnsignedCharArray> Active;
  vtkSmartPointer<vtkFloatArray> Distances;
  vtkSmartPointer<vtkUnsignedCharArray> CutTetrahedra;
  vtkSmartPointer<vtkFloatArray> CutDistances;

  std::unique_ptr<RestPositions> Rest;
  DeformationGrids Grids;
  deformvolume::Deformation Deformation;
  MappingCache Mapping;
  FadedMesh Faded; // what the mapping is of, where voxels outside the mesh are kept
  std::unique_ptr<DeformedPositions> Deformed;
  // What those are of.
  struct PositionsKey
  {
    std::uint64_t Mapping = 0; // a version
    bool IsField = false;
    OutsideVoxels Outside;
    bool operator==(const PositionsKey& other) const
    {
      return this->Mapping == other.Mapping && this->IsField == other.IsField &&
        this->Outside == other.Outside;
    }
  };
  PositionsKey DeformedMapping;
  std::uint64_t DeformedVectors = 0; // a version
};

} // namespace deformvolume

#endif
