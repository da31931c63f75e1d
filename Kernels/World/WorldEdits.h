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

/// Edits of a volume at rest, given in world coordinates, and the resulting masks. The masks equal
/// those of vtkCutVolume and vtkCarveVolume for whole data bit for bit, but VTK is not needed.
class DEFORMVOLUME_EXPORT WorldEdits
{
public:
  /// Throws an Error if the volume has fewer than two voxels on an axis.
  explicit WorldEdits(const ImageGeometry& volume);

  /// Returns an EditFinder with default options. It is valid as long as this object.
  EditFinder MakeFinder() const;

  /// Set the masks before all edits. Their memory must stay valid until other masks are set. Each
  /// call means that values may have changed.
  void SetBase(const WorldMasks& base);
  /// Returns the masks with all edits. The pointers lead to memory of the base or of this object,
  /// and are valid until the base or an edit changes.
  WorldMasks GetMasks();

  void Add(VolumeEdit&& edit);
  ///@{
  /// Undo or redo an edit. Return false if there is no edit to undo or redo.
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
  // Whether the editor still has the distances, or the cut, of an older base. They are only set
  // when an edit needs them.
  bool BaseDistancesAreOld = false;
  bool BaseCutIsOld = false;
};

} // namespace deformvolume

#endif
