// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldPointMap_h
#define DeformVolumeFieldPointMap_h

#include "OutsideVoxels.h"
#include "PointMap.h"
#include "VectorView.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <memory>

namespace deformvolume
{

/// A displacement field in world coordinates, interpolated trilinearly between its points. The
/// arrays must outlive the objects that use the field.
struct WorldField
{
  /// Number of points on each axis.
  std::array<int, 3> Dimensions{ { 0, 0, 0 } };
  /// Transform from indices to world coordinates. The first point has the index 0.
  glm::dmat4 IndexToWorld{ 1.0 };
  /// Vectors, with x varying fastest.
  VectorView Vectors;
  /// Factor by which all vectors are multiplied. Default: 1.
  double Scale = 1.0;
  /// One byte per point. 1: its vector is undefined. Null: all vectors are defined.
  const unsigned char* Undefined = nullptr;
  /// Distance from the field, in cells, up to which a point counts as inside. Default: 0.
  double Tolerance = 0.0;

  /// Returns the vector of a point, multiplied by Scale, in world units; 0 if it is undefined.
  glm::dvec3 GetVector(std::int64_t point) const
  {
    if (this->Undefined && this->Undefined[point])
    {
      return glm::dvec3(0.0);
    }
    return this->Scale * this->Vectors.Get(static_cast<std::size_t>(point));
  }
};

/// The deformation of points by a displacement field.
class DEFORMVOLUME_EXPORT FieldPointMap : public PointMap
{
public:
  /// isInverse: whether to prepare for Invert(). Without it, call only Map().
  FieldPointMap(const WorldField& field, const OutsideVoxels& outside, bool isInverse);
  ~FieldPointMap() override;

  /// Maps a point. Outside the field, OutsideVoxels applies. With Extrapolate, a point has the
  /// displacement of the closest point on the border. With Keep, this displacement fades.
  bool Map(const glm::dvec3& point, Image& image) const override;

private:
  /// Searches all cells whose deformed bounding boxes contain the point.
  bool InvertInside(const glm::dvec3& point, Image& image) const override;

  class Internals;
  std::unique_ptr<Internals> Inside;
};

} // namespace deformvolume

#endif
