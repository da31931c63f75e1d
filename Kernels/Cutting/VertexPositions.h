// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVertexPositions_h
#define DeformVolumeVertexPositions_h

#include "CellBricks.h"
#include "DeformVolumeExport.h"
#include "Extent.h"
#include "SnappedPoint.h"

#include <cstddef>

namespace deformvolume
{

/// The positions of the vertices of a sampling mesh for cutting: at rest, or deformed. Positions
/// are in steps of 1/256 voxel, in structured indices of the volume. Functions may be called by
/// several threads.
class DEFORMVOLUME_EXPORT VertexPositions
{
public:
  /// vertices: structured indices of the voxels.
  explicit VertexPositions(const Extent& vertices)
    : Bricks(vertices)
  {
  }
  virtual ~VertexPositions();
  VertexPositions(const VertexPositions&) = delete;
  VertexPositions& operator=(const VertexPositions&) = delete;

  /// Returns the bricks of the cells.
  const CellBricks& GetBricks() const { return this->Bricks; }

  /// Returns a box of all vertices of a brick; empty if none has a position.
  virtual SnappedBox GetBox(std::size_t brick) const = 0;
  /// Returns a box of all vertices.
  virtual SnappedBox GetBox() const = 0;

  /// Finds the positions of the vertices in a box of structured indices, x varying fastest.
  /// hasPosition: false for vertices without position, for example outside a deformation mesh.
  virtual void Find(const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const = 0;

private:
  CellBricks Bricks;
};

/// The vertices of a volume at rest.
class DEFORMVOLUME_EXPORT RestPositions : public VertexPositions
{
public:
  using VertexPositions::VertexPositions;

  SnappedBox GetBox(std::size_t brick) const override;
  SnappedBox GetBox() const override;
  void Find(const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const override;
};

} // namespace deformvolume

#endif
