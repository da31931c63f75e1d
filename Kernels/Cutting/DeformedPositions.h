// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformedPositions_h
#define DeformVolumeDeformedPositions_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "StaticMapping.h"
#include "Tetrahedron.h"
#include "VertexPositions.h"

#include <glm/vec3.hpp>

#include <functional>
#include <vector>

namespace deformvolume
{

/// Where the vertices of a volume are in a deformation. All of them are looked at once, for the
/// boxes of the bricks; after that only those of bricks that matter.
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

  SnappedBox GetBox(std::size_t brick) const override { return this->Boxes[brick]; }
  SnappedBox GetBox() const override { return this->Box; }
  void Find(const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const override;

private:
  /// The displacements of the vertices of a row from x on, and whether they have any.
  using RowFinder = std::function<void(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition)>;

  void FindBoxes();

  RowFinder FindRow;
  std::vector<SnappedBox> Boxes;
  SnappedBox Box;
};

} // namespace deformvolume

#endif
