// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelJacobians.h"

#include "BarycentricMap.h"
#include "IndexBounds.h"
#include "LinkExtrapolation.h"
#include "ParallelFor.h"
#include "VolumeRatios.h"

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace deformvolume
{

namespace
{

constexpr std::int32_t NoTetrahedron = std::numeric_limits<std::int32_t>::min();

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
  return high > low ? (after - before) / (high - low) : glm::dvec3(NotDefined);
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

  // Returns the displacement of a voxel. NaN if it is undefined, or if the voxel is discarded or
  // outside within FieldTolerance: there it would be that of the border.
  glm::dvec3 DisplaceVoxel(const glm::dvec3& index) const
  {
    constexpr double rounding = 1e-6;
    const glm::dvec3 position = this->Transform.ToField(index);
    const glm::dvec3 beyond = glm::max(-position, position - this->Transform.Last);
    return this->Field.Extrapolate || std::max({ beyond.x, beyond.y, beyond.z }) <= rounding
      ? this->Displace(position)
      : glm::dvec3(NotDefined);
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
      return glm::dvec3(NotDefined);
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

// A deformation by a mesh, for PlaneRatios.
struct MeshSource
{
  glm::dvec3 Displace(std::int64_t voxel, const glm::ivec3& index)
  {
    const std::int32_t owner = this->GetOwner(voxel);
    if (owner < 0)
    {
      return this->Faded.IsEmpty()
        ? glm::dvec3(NotDefined)
        : this->Faded.Displace(
            this->Links[static_cast<std::size_t>(voxel)], this->Tetrahedra, this->Displacements);
    }
    if (owner != this->Last)
    {
      const Tetrahedron& nodes = this->Tetrahedra[static_cast<std::size_t>(owner)];
      this->Map.SetTetrahedron(nodes, this->RestPoints); // no voxel is linked to a flat one
      this->End = GetVector(this->Displacements, nodes[3]);
      for (std::size_t k = 0; k < 3; ++k)
      {
        this->Differences[static_cast<int>(k)] =
          GetVector(this->Displacements, nodes[k]) - this->End;
      }
      this->Last = owner;
    }
    return this->End + this->Differences * this->Map.GetWeights(glm::dvec3(index));
  }

  double GetRatioOfCell(const std::array<std::int64_t, 8>& vertices) const
  {
    const std::int32_t owner = this->GetOwner(vertices[0]);
    return owner >= 0 &&
        std::all_of(vertices.begin(), vertices.end(),
          [&](std::int64_t vertex) { return this->GetOwner(vertex) == owner; })
      ? double{ this->Jacobians[vertices[0]] }
      : NotDefined;
  }

  // Whether the tetrahedra of two voxels have coincident nodes, but none in common.
  bool IsBridge(std::int64_t a, std::int64_t b) const
  {
    const std::int32_t owners[2] = { this->GetOwner(a), this->GetOwner(b) };
    if (owners[0] < 0 || owners[1] < 0 || owners[0] == owners[1])
    {
      return false;
    }
    bool areCoincident = false;
    for (const std::int32_t node : this->Tetrahedra[static_cast<std::size_t>(owners[0])])
    {
      for (const std::int32_t other : this->Tetrahedra[static_cast<std::size_t>(owners[1])])
      {
        if (node == other)
        {
          return false;
        }
        areCoincident = areCoincident ||
          this->RestPoints[static_cast<std::size_t>(node)] ==
            this->RestPoints[static_cast<std::size_t>(other)];
      }
    }
    return areCoincident;
  }

  double GetOtherwise(std::int64_t voxel, const glm::ivec3&) const
  {
    return this->Jacobians[voxel];
  }

  std::int32_t GetOwner(std::int64_t voxel) const
  {
    return this->Owners[static_cast<std::size_t>(voxel)];
  }

  const std::vector<std::int32_t>& Owners;
  const std::vector<VertexLink>& Links;
  const FadedLinks& Faded;
  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
  const float* Displacements;
  const float* Jacobians;
  // The map of the last tetrahedron: neighboring voxels often have the same one.
  std::int32_t Last = NoTetrahedron;
  BarycentricMap Map{};
  glm::dvec3 End{ 0.0 };
  glm::dmat3 Differences{ 0.0 };
};

// A deformation by a field, for PlaneRatios.
struct FieldSource
{
  glm::dvec3 Displace(std::int64_t, const glm::ivec3& index) const
  {
    return this->Field.DisplaceVoxel(glm::dvec3(index));
  }
  double GetRatioOfCell(const std::array<std::int64_t, 8>&) const { return NotDefined; }
  bool IsBridge(std::int64_t, std::int64_t) const { return false; }
  double GetOtherwise(std::int64_t, const glm::ivec3& index) const
  {
    return glm::determinant(this->AtRest + this->Field.GetDerivative(glm::dvec3(index))) /
      glm::determinant(this->AtRest);
  }

  const DerivedField& Field;
  const glm::dmat3& AtRest;
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
  const auto mostTetrahedra = static_cast<std::int32_t>(tetrahedra.size());
  std::vector<bool> areDiscarded(count);
  std::transform(links.begin(), links.end(), areDiscarded.begin(),
    [](const VertexLink& link) { return link.Tetrahedron < 0; });
  if (this->Faded.IsEmpty())
  {
    ExtrapolateLinks(voxels, spacing, restPoints, tetrahedra, links, [](double) {});
  }
  this->Owners.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::int32_t owner = links[i].Tetrahedron;
    const bool isOfMesh = owner >= 0 && owner < mostTetrahedra;
    this->Owners[i] = !isOfMesh ? NoTetrahedron : areDiscarded[i] ? ~owner : owner;
  }
  this->Links = this->Faded.IsEmpty() ? std::vector<VertexLink>() : std::move(links);
  this->Crossed = mapping.Boundary.Crossed;
}

void VoxelJacobians::Compute(const OutputMap& toOutput, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements,
  const HiddenTetrahedra& hidden, float* jacobians, float* ratios) const
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
      jacobians[i] = owner == NoTetrahedron
        ? 1.0F
        : ofTetrahedra[static_cast<std::size_t>(owner < 0 ? ~owner : owner)];
    });
  std::vector<float> ratiosOfKept;
  if (!this->Faded.IsEmpty() && !ratios)
  {
    ratiosOfKept.resize(this->Owners.size());
    ratios = ratiosOfKept.data();
  }
  if (ratios)
  {
    ComputeRatios(this->Voxels, atRest, hidden, this->Crossed,
      MeshSource{
        this->Owners, this->Links, this->Faded, restPoints, tetrahedra, displacements, jacobians },
      ratios);
  }
  for (std::size_t i = 0; i < this->Owners.size() && !this->Faded.IsEmpty(); ++i)
  {
    jacobians[i] = this->Owners[i] == NoTetrahedron ? ratios[i] : jacobians[i];
  }
}

void ComputeFieldJacobians(const VoxelGrid& voxelGrid, const DisplacementField& field,
  const std::vector<unsigned char>& undefined, const HiddenTetrahedra& hidden, float* jacobians)
{
  const glm::dmat3 atRest = GetOutputTransform(voxelGrid).GetMatrix();
  const DerivedField derived(field, true, undefined);
  ComputeRatios(
    voxelGrid.VertexExtent, atRest, hidden, {}, FieldSource{ derived, atRest }, jacobians);
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
