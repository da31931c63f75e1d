// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelJacobians.h"

#include "BarycentricMap.h"
#include "IndexBounds.h"
#include "LinkExtrapolation.h"
#include "ParallelFor.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace deformvolume
{

namespace
{

// Calls body(index, number) in parallel for the voxels of an extent.
template <typename Body>
void ForEachVoxel(const Extent& voxels, Body&& body)
{
  const std::int64_t width = GetSize(voxels, 0);
  const std::int64_t height = GetSize(voxels, 1);
  ParallelForItems(height * GetSize(voxels, 2), 16,
    [&](std::int64_t row)
    {
      glm::ivec3 index(voxels[0], voxels[2] + static_cast<int>(row % height),
        voxels[4] + static_cast<int>(row / height));
      for (std::int64_t x = 0; x < width; ++x, ++index.x)
      {
        body(index, row * width + x);
      }
    });
}

bool IsUndefined(const glm::dvec3& vector)
{
  return glm::any(glm::isnan(vector));
}

// Returns the finite difference of a function between two positions. An undefined value is replaced
// by the value in the middle. Returns NaN if there are not two defined values.
template <typename Function>
glm::dvec3 GetSlope(double low, double middle, double high, const Function& getValue)
{
  glm::dvec3 before = getValue(low);
  if (IsUndefined(before))
  {
    low = middle;
    before = getValue(low);
  }
  glm::dvec3 after = getValue(high);
  if (IsUndefined(after))
  {
    high = middle;
    after = getValue(high);
  }
  return high > low ? (after - before) / (high - low)
                    : glm::dvec3(std::numeric_limits<double>::quiet_NaN());
}

// The derivatives of a displacement field.
class DerivedField
{
public:
  // undefined: one byte per point, nonzero if the point has no vector; may be empty. Points with a
  // NaN are undefined, too.
  DerivedField(
    const DisplacementField& field, bool isMapped, const std::vector<unsigned char>& undefined = {})
    : Field(field)
    , IsMapped(isMapped)
    , Undefined(undefined)
    , Transform(field)
  {
  }

  // Returns the derivative of the displacement with respect to the index to which IndexToField
  // applies.
  glm::dmat3 GetDerivative(const glm::dvec3& index) const
  {
    const glm::dvec3 position = this->Transform.ToField(index);
    const glm::dvec3 beyond =
      glm::max(glm::max(-position, position - this->Transform.Last), glm::dvec3(0.0));
    glm::dmat3 derivative(0.0);
    if (this->Field.Extrapolate && std::max({ beyond.x, beyond.y, beyond.z }) > FieldTolerance)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        const auto getPosition = [&](double shifted)
        {
          glm::dvec3 moved = index;
          moved[axis] = shifted;
          return this->Transform.ToField(moved);
        };
        // A shift must not cross a border of the field that the voxel is within.
        const auto shift = [&](double distance)
        {
          const glm::dvec3 moved = getPosition(index[axis] + distance);
          const glm::dvec3 after = glm::max(-moved, moved - this->Transform.Last);
          const auto crosses = glm::lessThan(beyond, glm::dvec3(FieldTolerance)) &&
            glm::greaterThan(after, glm::dvec3(FieldTolerance));
          return glm::any(crosses) ? index[axis] : index[axis] + distance;
        };
        derivative[axis] = GetSlope(shift(-0.5), index[axis], shift(0.5),
          [&](double shifted) { return this->Displace(getPosition(shifted)); });
        derivative[axis] = IsUndefined(derivative[axis]) ? glm::dvec3(0.0) : derivative[axis];
      }
      return derivative;
    }
    // Differences are taken along the axes of the field, so that none crosses its border. Discarded
    // voxels outside have the derivative at the nearest point of the border, since cells there are
    // interpolated.
    glm::dmat3 alongField(0.0);
    for (int axis = 0; axis < 3; ++axis)
    {
      const double halfStep = 0.5 *
        std::max({ std::abs(this->Transform.Matrix[0][axis]),
          std::abs(this->Transform.Matrix[1][axis]), std::abs(this->Transform.Matrix[2][axis]) });
      const glm::dvec3 middle = glm::clamp(position, glm::dvec3(0.0), this->Transform.Last);
      alongField[axis] = this->GetSlopeAt(middle, axis, halfStep);
      if (IsUndefined(alongField[axis]))
      {
        alongField[axis] = this->GetSlopeBeside(middle, axis, halfStep);
      }
    }
    return alongField * this->Transform.Matrix;
  }

private:
  // The derivative along an axis of the field; NaN if it is undefined on both sides.
  glm::dvec3 GetSlopeAt(const glm::dvec3& middle, int axis, double halfStep) const
  {
    return GetSlope(std::max(middle[axis] - halfStep, 0.0), middle[axis],
      std::min(middle[axis] + halfStep, this->Transform.Last[axis]),
      [&](double shifted)
      {
        glm::dvec3 moved = middle;
        moved[axis] = shifted;
        return this->Interpolate(moved);
      });
  }

  // The mean of the defined derivatives along an axis of the field at the positions one point
  // aside; 0 if there are none.
  glm::dvec3 GetSlopeBeside(const glm::dvec3& middle, int axis, double halfStep) const
  {
    glm::dvec3 sum(0.0);
    double count = 0.0;
    for (int neighbor = 0; neighbor < 9 && this->Transform.Last[axis] > 0.0; ++neighbor)
    {
      glm::dvec3 moved = middle;
      moved[(axis + 1) % 3] += neighbor % 3 - 1;
      moved[(axis + 2) % 3] += neighbor / 3 - 1;
      moved = glm::clamp(moved, glm::dvec3(0.0), this->Transform.Last);
      const glm::dvec3 slope = this->GetSlopeAt(moved, axis, halfStep);
      if (!IsUndefined(slope))
      {
        sum += slope;
        count += 1.0;
      }
    }
    return count > 0.0 ? sum / count : sum;
  }

  glm::dvec3 GetPoint(std::int64_t point) const
  {
    if (!this->Undefined.empty() && this->Undefined[static_cast<std::size_t>(point)] != 0)
    {
      return glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    }
    return this->IsMapped ? GetVector(this->Field, point) : GetVector(this->Field.Vectors, point);
  }
  // Returns NaN if an undefined point has a weight other than 0.
  glm::dvec3 Interpolate(const glm::dvec3& position) const
  {
    const auto getPoint = [this](std::int64_t point) { return this->GetPoint(point); };
    const glm::dvec3 vector = deformvolume::Interpolate(this->Field, position, getPoint);
    if (!IsUndefined(vector))
    {
      return vector;
    }
    // The weight of the undefined point may be a rounding error: round to the nearest point.
    const glm::dvec3 nearest = glm::round(position);
    const auto isNear =
      glm::lessThanEqual(glm::abs(position - nearest), glm::dvec3(FieldTolerance));
    return deformvolume::Interpolate(this->Field, glm::mix(position, nearest, isNear), getPoint);
  }
  glm::dvec3 Displace(const glm::dvec3& position) const
  {
    const double weight = GetWeightBeyond(this->Field, position, FieldTolerance);
    return weight > 0.0
      ? weight * this->Interpolate(glm::clamp(position, glm::dvec3(0.0), this->Transform.Last))
      : glm::dvec3(0.0); // even if the point on the border is undefined
  }

  const DisplacementField& Field;
  const bool IsMapped; // whether the matrix of the field is applied to the vectors
  const std::vector<unsigned char> Undefined;
  const FieldTransform Transform;
};

} // namespace

void VoxelJacobians::SetMapping(const Extent& voxels, const glm::dvec3& spacing,
  const StaticMapping& mapping, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra)
{
  this->Voxels = voxels;
  this->Faded = mapping.Faded;
  const auto count = static_cast<std::size_t>(GetNumberOfPoints(voxels));
  std::vector<VertexLink> links = mapping.Links;
  if (links.empty())
  {
    links.assign(count, MakeLink(-1, glm::dvec3(0.0)));
    const std::int64_t width = GetSize(voxels, 0);
    ParallelForItems(mapping.Runs.RowBegins.size() - 1, 64,
      [&](std::size_t row)
      {
        const std::uint32_t past = mapping.Runs.RowBegins[row + 1];
        for (std::uint32_t i = mapping.Runs.RowBegins[row]; i < past; ++i)
        {
          const VertexRun& run = mapping.Runs.Runs[i];
          const std::int64_t last = i + 1 < past ? mapping.Runs.Runs[i + 1].Begin : width;
          for (std::int64_t x = run.Begin; run.Tetrahedron >= 0 && x < last; ++x)
          {
            links[row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)].Tetrahedron =
              mapping.Runs.Tetrahedra[static_cast<std::size_t>(run.Tetrahedron)].Tetrahedron;
          }
        }
      });
  }
  if (this->Faded.IsEmpty())
  {
    ExtrapolateLinks(voxels, spacing, restPoints, tetrahedra, links, [](double) {});
  }
  this->Owners.resize(count);
  const auto mostTetrahedra = static_cast<std::int32_t>(tetrahedra.size());
  for (std::size_t i = 0; i < count; ++i)
  {
    this->Owners[i] = links[i].Tetrahedron < mostTetrahedra ? links[i].Tetrahedron : -1;
  }
  this->Links = this->Faded.IsEmpty() ? std::vector<VertexLink>() : std::move(links);
}

void VoxelJacobians::Compute(const OutputMap& toOutput, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements, float* jacobians)
{
  const glm::dmat3 atRest = OutputTransform(toOutput).GetMatrix();
  const double volume = glm::determinant(atRest);
  std::vector<float> ofTetrahedra(tetrahedra.size());
  ParallelForItems(tetrahedra.size(), 4096,
    [&](std::size_t i)
    {
      BarycentricMap map;
      if (!map.SetTetrahedron(tetrahedra[i], restPoints))
      {
        return; // no voxel is linked to a flat tetrahedron
      }
      glm::dmat3 derivative = atRest;
      for (int node = 0; node < 4; ++node)
      {
        derivative +=
          glm::outerProduct(GetVector(displacements, tetrahedra[i][static_cast<std::size_t>(node)]),
            map.GetGradient(node));
      }
      ofTetrahedra[i] = static_cast<float>(glm::determinant(derivative) / volume);
    });
  ParallelForItems(this->Owners.size(), 1 << 16,
    [&](std::size_t i)
    {
      const std::int32_t owner = this->Owners[i];
      jacobians[i] = owner >= 0 ? ofTetrahedra[static_cast<std::size_t>(owner)] : 1.0F;
    });
  if (!this->Faded.IsEmpty())
  {
    this->ComputeOutside(toOutput, tetrahedra, displacements, jacobians);
  }
}

void VoxelJacobians::ComputeOutside(const OutputMap& toOutput,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements, float* jacobians) const
{
  const glm::dmat3 atRest = OutputTransform(toOutput).GetMatrix();
  const double volume = glm::determinant(atRest);
  const std::array<std::int64_t, 3> steps{ { 1, GetSize(this->Voxels, 0),
    GetSize(this->Voxels, 0) * GetSize(this->Voxels, 1) } };
  const auto displace = [&](std::int64_t voxel)
  {
    return this->Faded.Displace(
      this->Links[static_cast<std::size_t>(voxel)], tetrahedra, displacements);
  };
  ForEachVoxel(this->Voxels,
    [&](const glm::ivec3& index, std::int64_t voxel)
    {
      if (this->Owners[static_cast<std::size_t>(voxel)] >= 0)
      {
        return;
      }
      glm::dmat3 derivative = atRest;
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const int at = index[static_cast<int>(axis)];
        const std::int64_t low = at > this->Voxels[2 * axis] ? voxel - steps[axis] : voxel;
        const std::int64_t high = at < this->Voxels[2 * axis + 1] ? voxel + steps[axis] : voxel;
        const glm::dvec3 change = displace(high) - displace(low);
        derivative[static_cast<int>(axis)] +=
          change / static_cast<double>(std::max<std::int64_t>(1, (high - low) / steps[axis]));
      }
      jacobians[voxel] = static_cast<float>(glm::determinant(derivative) / volume);
    });
}

void ComputeFieldJacobians(const VoxelGrid& voxelGrid, const DisplacementField& field,
  const std::vector<unsigned char>& undefined, float* jacobians)
{
  const glm::dmat3 atRest = GetOutputTransform(voxelGrid).GetMatrix();
  const double volume = glm::determinant(atRest);
  const DerivedField derived(field, true, undefined);
  ForEachVoxel(voxelGrid.VertexExtent,
    [&](const glm::ivec3& index, std::int64_t voxel)
    {
      jacobians[voxel] = static_cast<float>(
        glm::determinant(atRest + derived.GetDerivative(glm::dvec3(index))) / volume);
    });
}

void ComputeInverseFieldJacobians(
  const Extent& output, const DisplacementField& inverse, float* jacobians)
{
  const DerivedField derived(inverse, false);
  ForEachVoxel(output,
    [&](const glm::ivec3& index, std::int64_t voxel)
    {
      jacobians[voxel] = static_cast<float>(
        1.0 / glm::determinant(glm::dmat3(1.0) + derived.GetDerivative(glm::dvec3(index))));
    });
}

} // namespace deformvolume
