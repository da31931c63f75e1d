// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformedPositions_h
#define DeformVolumeDeformedPositions_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "PointRanges.h"
#include "StaticMapping.h"
#include "Tetrahedron.h"
#include "VertexPositions.h"

#include <memory>
#include <vector>

namespace deformvolume
{

class DeformedFieldVertices;
class DeformedMeshVertices;
class DeformedVertices;

/// The deformed positions of the vertices of a volume. Only the boxes of bricks are stored;
/// positions of vertices are computed when they are needed.
class DEFORMVOLUME_EXPORT DeformedPositions : public VertexPositions
{
public:
  /// Vertices in a deformation mesh. All arguments must outlive this object and not change. mapped,
  /// mapping: the mapping of all voxels of an extent that contains the vertices, with links or
  /// runs. displacements: three floats per node, in voxels of the volume. Throws an Error if the
  /// mapping does not contain the vertices.
  DeformedPositions(const Extent& vertices, const Extent& mapped, const StaticMapping& mapping,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements);
  /// Vertices in a forward displacement field, with displacements in voxels of the volume.
  DeformedPositions(const Extent& vertices, const DisplacementField& field);
  ~DeformedPositions() override;

  /// Set the displacements, for the same mesh or after the connectivity of its tetrahedra changed.
  /// Only for vertices in a deformation mesh.
  void SetDisplacements(const float* displacements);
  /// Set another displacement field. changed: ranges of points outside of which the field equals
  /// the last one; null: unknown. Only for vertices in a displacement field.
  void SetField(const DisplacementField& field, const PointRanges* changed);

  SnappedBox GetBox(std::size_t brick) const override { return this->Boxes[brick]; }
  SnappedBox GetBox() const override { return this->Box; }
  void Find(const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const override;

private:
  /// Finds the boxes of marked bricks, one byte for each brick; of all bricks if there are no
  /// marks.
  void FindBoxes(const std::vector<unsigned char>& marked);
  SnappedBox FindBox(std::size_t brick) const;
  SnappedBox FindExactBox(std::size_t brick) const;

  std::unique_ptr<DeformedVertices> Vertices;
  // Vertices as a pointer to its derived class; one of these two pointers is null.
  DeformedMeshVertices* OfMesh = nullptr;
  DeformedFieldVertices* OfField = nullptr;
  std::vector<SnappedBox> Boxes;
  SnappedBox Box;
};

} // namespace deformvolume

#endif
