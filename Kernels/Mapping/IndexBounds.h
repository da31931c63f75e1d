// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeIndexBounds_h
#define DeformVolumeIndexBounds_h

#include "DisplacementField.h"
#include "Extent.h"
#include "VoxelGrid.h"

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstdint>

namespace deformvolume
{

/// A box in continuous output indices.
struct IndexBounds
{
  glm::dvec3 Min{ 1.0 };
  glm::dvec3 Max{ -1.0 };
  bool IsEmpty() const { return this->Min.x > this->Max.x; }
  void Add(const glm::dvec3& point)
  {
    if (this->IsEmpty())
    {
      this->Min = point;
      this->Max = point;
      return;
    }
    this->Min = glm::min(this->Min, point);
    this->Max = glm::max(this->Max, point);
  }
  void Add(const IndexBounds& other)
  {
    if (!other.IsEmpty())
    {
      this->Add(other.Min);
      this->Add(other.Max);
    }
  }
};

/// The volume's box, in its continuous indices.
inline IndexBounds GetBox(const VoxelGrid& voxelGrid)
{
  const Extent& extent = voxelGrid.VertexExtent;
  IndexBounds box;
  box.Min = glm::dvec3(extent[0], extent[2], extent[4]);
  box.Max = glm::dvec3(extent[1], extent[3], extent[5]);
  return box;
}

inline glm::dvec3 GetScale(const VoxelGrid& voxelGrid)
{
  return glm::dvec3(voxelGrid.Scale[0], voxelGrid.Scale[1], voxelGrid.Scale[2]);
}

inline bool IsFinite(const glm::dvec3& v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// One of many vectors, three floats each.
inline glm::dvec3 GetVector(const float* vectors, std::int64_t index)
{
  return glm::dvec3(vectors[3 * index], vectors[3 * index + 1], vectors[3 * index + 2]);
}

/// What takes a vector in voxels of the volume to one in points of a field.
inline glm::dmat3 GetVoxelsToField(const DisplacementField& field)
{
  const auto& m = field.IndexToField;
  return glm::dmat3(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
}

/// The displacement of a point of a field.
inline glm::dvec3 GetVector(const DisplacementField& field, std::int64_t point)
{
  const std::array<float, 3> displacement = GetDisplacement(field, point);
  return glm::dvec3(displacement[0], displacement[1], displacement[2]);
}

/// The trilinear vector at a position within a field, in indices of its points. getVector returns
/// the one of a point; it is not asked for points without weight, which may be undefined.
template <typename Function>
glm::dvec3 Interpolate(
  const DisplacementField& field, const glm::dvec3& position, const Function& getVector)
{
  const glm::i64vec3 low(position);
  const glm::dvec3 t = position - glm::dvec3(low);
  glm::dvec3 vector(0.0);
  for (int corner = 0; corner < 8; ++corner)
  {
    double weight = 1.0;
    std::int64_t point = 0;
    for (int axis = 2; axis >= 0; --axis)
    {
      const int upper = corner >> axis & 1;
      weight *= upper ? t[axis] : 1.0 - t[axis];
      point = point * field.Dimensions[static_cast<std::size_t>(axis)] + low[axis] + upper;
    }
    if (weight != 0.0)
    {
      vector += weight * getVector(point);
    }
  }
  return vector;
}

} // namespace deformvolume

#endif
