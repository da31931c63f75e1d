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

/// Where the vertices of a volume are in a deformation. Of all bricks only limits are found; their
/// vertices are looked at where a brick matters.
class DEFORMVOLUME_EXPORT DeformedPositions : public VertexPositions
{
public:
  /// In a deformation mesh. What is given must live, and stay as it is, for as long as this object.
  /// mapping: that of all voxels of an extent which holds these, with links or runs. displacements:
  /// three floats a node, in voxels of the volume. Throws Error where the mapping is not one of
  /// them.
  DeformedPositions(const Extent& vertices, const Extent& mapped, const StaticMapping& mapping,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements);
  /// In a displacement field, forward, whose displacements are in voxels of the volume.
  DeformedPositions(const Extent& vertices, const DisplacementField& field);
  ~DeformedPositions() override;

  /// Other displacements of the same mesh, or other nodes of its tetrahedra. Not for a field.
  void SetDisplacements(const float* displacements);
  /// Another displacement field. changed: ranges of its points outside of which the field is as the
  /// last one was; null: that is not known. Not for a mesh.
  void SetField(const DisplacementField& field, const PointRanges* changed);

  SnappedBox GetBox(std::size_t brick) const override { return this->Boxes[brick]; }
  SnappedBox GetBox() const override { return this->Box; }
  void Find(const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const override;

private:
  /// Of the bricks that are marked, one byte each; of all where there are no marks.
  void FindBoxes(const std::vector<unsigned char>& marked);
  SnappedBox FindBox(std::size_t brick) const;
  SnappedBox FindExactBox(std::size_t brick) const;

  std::unique_ptr<DeformedVertices> Vertices;
  // Those above; one of these is null.
  DeformedMeshVertices* OfMesh = nullptr;
  DeformedFieldVertices* OfField = nullptr;
  std::vector<SnappedBox> Boxes;
  SnappedBox Box;
};

} // namespace deformvolume

#endif
