// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformedVertices_h
#define DeformVolumeDeformedVertices_h

#include "CellBricks.h"
#include "DisplacementField.h"
#include "Extent.h"
#include "PointRanges.h"
#include "StaticMapping.h"
#include "Tetrahedron.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Limits of displacements.
struct DisplacementLimits
{
  glm::dvec3 Min{ 1.0 };
  glm::dvec3 Max{ -1.0 };
  /// Whether the limits are known; otherwise displacements may have any value.
  bool AreKnown = true;

  bool IsEmpty() const { return this->Min.x > this->Max.x; }
  void Add(const glm::dvec3& displacement);
};

/// Interface of deformations that move the vertices of a volume. Functions may be called by several
/// threads.
class DeformedVertices
{
public:
  DeformedVertices() = default;
  virtual ~DeformedVertices();
  DeformedVertices(const DeformedVertices&) = delete;
  DeformedVertices& operator=(const DeformedVertices&) = delete;

  /// Finds the displacements of `count` vertices of a row from x on, in structured indices, and
  /// whether each vertex has a position.
  virtual void FindRow(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const = 0;
  /// Returns limits of the displacements of the vertices of a brick. They need not be tight.
  virtual DisplacementLimits GetLimits(std::size_t brick) const = 0;
};

/// Vertices in a deformation mesh. All arguments must outlive this object and not change, except
/// for the displacements, which can be set again.
class DeformedMeshVertices : public DeformedVertices
{
public:
  /// mapped: structured indices of the voxels of the mapping. They must include those of the
  /// bricks.
  DeformedMeshVertices(const CellBricks& bricks, const Extent& mapped, const StaticMapping& mapping,
    const std::vector<Tetrahedron>& tetrahedra);

  /// Three floats per node.
  void SetDisplacements(const float* displacements);

  void FindRow(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const override;
  DisplacementLimits GetLimits(std::size_t brick) const override;

private:
  struct Box
  {
    std::array<float, 3> Least;
    std::array<float, 3> Greatest;
  };

  template <typename Function>
  void FollowRow(int x, int y, int z, int count, bool ends, Function&& function) const;
  void FindTetrahedra(
    const Extent& vertices, std::vector<std::int32_t>& tetrahedra, float& overshoot) const;

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
  std::vector<float> Overshoots;
  std::vector<Box> Limits; // limits of the displacements of the nodes of each tetrahedron
};

/// Vertices in a displacement field.
class DeformedFieldVertices : public DeformedVertices
{
public:
  DeformedFieldVertices(const CellBricks& bricks, const DisplacementField& field)
    : Bricks(bricks)
    , Field(field)
  {
  }

  void FindRow(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const override;
  DisplacementLimits GetLimits(std::size_t brick) const override;

  /// Set another field. changed: ranges of points outside of which the new field equals the last
  /// one; null: unknown. Returns one byte for each brick, which is not 0 if the limits of the brick
  /// may have changed. An empty result means that the limits of all bricks may have changed.
  std::vector<unsigned char> SetField(const DisplacementField& field, const PointRanges* changed);

private:
  bool Find(const glm::dvec3& vertex, glm::dvec3& displacement) const;
  void MarkRow(const Extent& points, std::vector<unsigned char>& bricks) const;

  const CellBricks Bricks;
  DisplacementField Field;
};

} // namespace deformvolume

#endif
