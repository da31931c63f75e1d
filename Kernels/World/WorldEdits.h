// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldEdits_h
#define DeformVolumeWorldEdits_h

#include "DeformVolumeExport.h"
#include "ImageGeometry.h"
#include "MaskEditor.h"
#include "VertexPositions.h"
#include "VolumeEdit.h"
#include "WorldDeformer.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// Edits of a volume that lies in the world, at rest, and the masks that it has by them: what
/// vtkCutVolume and vtkCarveVolume do with whole data, with the same bits, without VTK.
class DEFORMVOLUME_EXPORT WorldEdits
{
public:
  /// Throws Error where the volume has less than two voxels on an axis.
  explicit WorldEdits(const ImageGeometry& volume);

  /// What finds edits, without options. It is valid as long as this object.
  EditFinder MakeFinder() const;

  /// The masks before all edits. They are borrowed until others are set, and their values may be
  /// others than they were.
  void SetBase(const WorldMasks& base);
  /// The masks with the edits, in memory of the base or of this object, until something is set or
  /// edited.
  WorldMasks GetMasks();

  void Add(VolumeEdit&& edit);
  ///@{
  /// False where there is nothing to be undone or redone.
  bool Undo() { return this->Editor.Undo(); }
  bool Redo() { return this->Editor.Redo(); }
  ///@}
  void Reset() { this->Editor.Reset(); }

  std::size_t GetNumberOfEdits() const { return this->Editor.GetNumberOfEdits(); }
  std::size_t GetNumberOfUndoneEdits() const { return this->Editor.GetNumberOfUndoneEdits(); }
  std::int64_t GetNumberOfSwitchedOffTetrahedra() const
  {
    return this->Editor.GetNumberOfSwitchedOffTetrahedra();
  }
  std::int64_t GetNumberOfDividedTetrahedra() const
  {
    return this->Editor.GetSmoothCrossings().GetNumberOfDividedTetrahedra();
  }

private:
  ImageGeometry Volume;
  RestPositions Vertices;
  MaskEditor Editor;
  WorldMasks Base;
  // The editor has others. It gets them where an edit is joined with them.
  bool BaseDistancesAreOld = false;
  bool BaseCutIsOld = false;
};

} // namespace deformvolume

#endif
