// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFieldPointMap_h
#define DeformVolumeFieldPointMap_h

#include "OutsideVoxels.h"
#include "PointMap.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <memory>

namespace deformvolume
{

/// A displacement field in world coordinates, trilinear between its points. What is pointed to must
/// outlive what uses it.
struct WorldField
{
  /// Points on each axis.
  std::array<int, 3> Dimensions{ { 0, 0, 0 } };
  /// From indices, 0 being the first point, to world coordinates.
  glm::dmat4 IndexToWorld{ 1.0 };
  /// Three values a point, x varying fastest, of which one pointer is set; and a factor on them.
  const float* Floats = nullptr;
  /// As Floats, in double precision.
  const double* Doubles = nullptr;
  /// A factor on the vectors.
  double Scale = 1.0;
  /// One byte a point, 1: its vector is not known; null: all are.
  const unsigned char* Undefined = nullptr;
  /// Cells by which a point may be outside and count as inside.
  double Tolerance = 0.0;

  /// The vector of a point, times Scale, in world units.
  glm::dvec3 GetVector(std::int64_t point) const
  {
    const std::int64_t first = 3 * point;
    return this->Scale *
      (this->Floats
          ? glm::dvec3(this->Floats[first], this->Floats[first + 1], this->Floats[first + 2])
          : glm::dvec3(this->Doubles[first], this->Doubles[first + 1], this->Doubles[first + 2]));
  }
};

/// The map of a field.
class DEFORMVOLUME_EXPORT FieldPointMap : public PointMap
{
public:
  /// isInverse: whether Invert is to be called, and not Map.
  FieldPointMap(const WorldField& field, const OutsideVoxels& outside, bool isInverse);
  ~FieldPointMap() override;

  /// Extrapolate: by the displacement of the closest point of the field's border; Keep: by that,
  /// faded.
  bool Map(const glm::dvec3& point, Image& image) const override;

private:
  /// Looks into all cells that may have come to the point.
  bool InvertInside(const glm::dvec3& point, Image& image) const override;

  class Internals;
  std::unique_ptr<Internals> Inside;
};

} // namespace deformvolume

#endif
