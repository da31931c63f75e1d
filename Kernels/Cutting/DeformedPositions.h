// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformedPositions_h
#define DeformVolumeDeformedPositions_h

#include "DeformVolumeExport.h"
#include "DisplacementField.h"
#include "Extent.h"
#include "IndexBounds.h"
#include "PointRanges.h"
#include "StaticMapping.h"
#include "Tetrahedron.h"
#include "VertexPositions.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Limits of displacements.
struct DisplacementLimits : IndexBounds
{
  /// Whether the limits are known; otherwise displacements may have any value.
  bool AreKnown = true;
};

/// The deformed positions of the vertices of a volume. Only the boxes of bricks are stored;
/// positions of vertices are computed when they are needed.
class DEFORMVOLUME_EXPORT DeformedPositions : public VertexPositions
{
public:
  ~DeformedPositions() override;

  SnappedBox GetBox(std::size_t brick) const override { return this->Boxes[brick]; }
  SnappedBox GetBox() const override { return this->Box; }
  void Find(const Extent& vertices, SnappedPoint* positions, bool* hasPosition) const override;

protected:
  using VertexPositions::VertexPositions;

  /// Finds the boxes of marked bricks, one byte for each brick; of all bricks if there are no
  /// marks.
  void FindBoxes(const std::vector<unsigned char>& marked);

private:
  /// Finds the displacements of `count` vertices of a row from x on, in structured indices, and
  /// whether each vertex has a position.
  virtual void FindRow(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const = 0;
  /// Returns limits of the displacements of the vertices of a brick. They need not be tight.
  virtual DisplacementLimits GetLimits(std::size_t brick) const = 0;

  SnappedBox FindBox(std::size_t brick) const;
  SnappedBox FindExactBox(std::size_t brick) const;

  std::vector<SnappedBox> Boxes;
  SnappedBox Box;
};

/// The positions of vertices in a deformation mesh. All arguments must outlive this object and not
/// change, except for the displacements, which can be set again.
class DEFORMVOLUME_EXPORT DeformedMeshPositions : public DeformedPositions
{
public:
  /// mapped, mapping: the mapping of all voxels of an extent that contains the vertices, with links
  /// or runs. displacements: three floats per node, in voxels of the volume. Throws an Error if the
  /// mapping does not contain the vertices.
  DeformedMeshPositions(const Extent& vertices, const Extent& mapped, const StaticMapping& mapping,
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements);

  /// Set the displacements, for the same mesh or after the connectivity of its tetrahedra changed.
  void SetDisplacements(const float* displacements);

private:
  struct NodeLimits
  {
    std::array<float, 3> Min;
    std::array<float, 3> Max;
  };

  void FindRow(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const override;
  DisplacementLimits GetLimits(std::size_t brick) const override;
  template <typename Function>
  void FollowRow(int x, int y, int z, int count, bool ends, Function&& function) const;
  std::vector<std::int32_t> FindTetrahedra(const Extent& vertices, float& overshoot) const;

  const Extent Mapped;
  const StaticMapping& Mapping;
  const std::vector<Tetrahedron>& Tetrahedra;
  const float* Displacements = nullptr;
  /// The tetrahedra that contain vertices of each brick, sorted by bricks. The tetrahedra of brick
  /// b begin at index Begins[b] and end before index Begins[b + 1].
  std::vector<std::int32_t> OfBricks;
  std::vector<std::size_t> Begins;
  /// For the vertices of each brick, the largest absolute value of the sum of negative weights.
  /// Weights are negative where vertices are extrapolated, and by rounding.
  std::vector<float> NegativeWeightSums;
  std::vector<NodeLimits> Limits; // limits of the displacements of the nodes of each tetrahedron
};

/// The positions of vertices in a forward displacement field, with displacements in voxels of the
/// volume.
class DEFORMVOLUME_EXPORT DeformedFieldPositions : public DeformedPositions
{
public:
  /// field: its vectors must outlive this object or be replaced by SetField().
  DeformedFieldPositions(const Extent& vertices, const DisplacementField& field);

  /// Set another displacement field. changed: ranges of points outside of which the field equals
  /// the last one; null: unknown.
  void SetField(const DisplacementField& field, const PointRanges* changed);

private:
  void FindRow(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const override;
  DisplacementLimits GetLimits(std::size_t brick) const override;
  /// Returns one byte for each brick, which is not 0 if the limits of the brick may have changed.
  /// An empty result means that the limits of all bricks may have changed. last: the last field.
  std::vector<unsigned char> FindChanged(
    const DisplacementField& last, const PointRanges* changed) const;
  bool FindDisplacement(const glm::dvec3& vertex, glm::dvec3& displacement) const;
  void MarkRow(const Extent& points, std::vector<unsigned char>& bricks) const;

  DisplacementField Field;
};

} // namespace deformvolume

#endif
