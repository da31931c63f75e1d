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

/// What displacements lie between.
struct DisplacementLimits
{
  glm::dvec3 Min{ 1.0 };
  glm::dvec3 Max{ -1.0 };
  /// Whether they are known; else they may be anything.
  bool AreKnown = true;

  bool IsEmpty() const { return this->Min.x > this->Max.x; }
  void Add(const glm::dvec3& displacement);
};

/// What moves the vertices of a volume. Functions may be called by many threads.
class DeformedVertices
{
public:
  DeformedVertices() = default;
  virtual ~DeformedVertices();
  DeformedVertices(const DeformedVertices&) = delete;
  DeformedVertices& operator=(const DeformedVertices&) = delete;

  /// The displacements of the vertices of a row from x on, in structured indices, and whether they
  /// have any.
  virtual void FindRow(
    int x, int y, int z, int count, glm::dvec3* displacements, bool* hasPosition) const = 0;
  /// What the displacements of the vertices of a brick lie between. They may be closer together.
  virtual DisplacementLimits GetLimits(std::size_t brick) const = 0;
};

/// The vertices in a deformation mesh. What is given must live, and stay as it is, but for the
/// displacements.
class DeformedMeshVertices : public DeformedVertices
{
public:
  /// mapped: structured indices of the voxels that the mapping is of, which hold those of the
  /// bricks.
  DeformedMeshVertices(const CellBricks& bricks, const Extent& mapped, const StaticMapping& mapping,
    const std::vector<Tetrahedron>& tetrahedra);

  /// Three floats a node.
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
  /// The tetrahedra that hold vertices of each brick, all of brick 0 first; brick b has those from
  /// Begins[b] to Begins[b + 1].
  std::vector<std::int32_t> OfBricks;
  std::vector<std::size_t> Begins;
  /// How much negative weights of the vertices of each brick sum up to, at most, with their signs
  /// changed: where vertices are extrapolated, and by rounding.
  std::vector<float> Overshoots;
  std::vector<Box> Limits; // of the displacements of the nodes of each tetrahedron
};

/// The vertices in a displacement field.
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

  /// Another field. changed: ranges of its points outside of which it is as the last one was.
  /// Returns which bricks may have other limits, one byte a brick; nothing: all may have.
  std::vector<unsigned char> SetField(const DisplacementField& field, const PointRanges* changed);

private:
  bool Find(const glm::dvec3& vertex, glm::dvec3& displacement) const;
  void MarkRow(const Extent& points, std::vector<unsigned char>& bricks) const;

  const CellBricks Bricks;
  DisplacementField Field;
};

} // namespace deformvolume

#endif
