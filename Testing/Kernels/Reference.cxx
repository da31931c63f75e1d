// SPDX-License-Identifier: BSD-3-Clause
#include "Reference.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace reference
{
namespace
{

using Offset = std::array<int, 3>;

/// The eight vertices of a cell by their numbers in the literature, 1 to 8, as offsets to the cell.
std::array<Offset, 9> NumberVertices(int x, int y, int z)
{
  std::array<Offset, 9> vertices{ { { 0, 0, 0 }, { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, { 1, 0, 1 },
    { 0, 1, 0 }, { 1, 1, 0 }, { 0, 1, 1 }, { 1, 1, 1 } } };
  const auto swapPairs = [&vertices](std::array<std::pair<int, int>, 4> pairs)
  {
    for (const auto& [first, second] : pairs)
    {
      std::swap(vertices[first], vertices[second]);
    }
  };
  if (x % 2 != 0)
  {
    swapPairs({ { { 1, 2 }, { 3, 4 }, { 5, 6 }, { 7, 8 } } });
  }
  if (y % 2 != 0)
  {
    swapPairs({ { { 1, 5 }, { 2, 6 }, { 3, 7 }, { 4, 8 } } });
  }
  if (z % 2 != 0)
  {
    swapPairs({ { { 1, 3 }, { 2, 4 }, { 5, 7 }, { 6, 8 } } });
  }
  return vertices;
}

constexpr int NumbersOfTetrahedra[5][4] = { { 1, 3, 4, 7 }, { 7, 8, 4, 6 }, { 4, 2, 1, 6 },
  { 1, 5, 7, 6 }, { 7, 4, 6, 1 } };

/// Six times the signed volume.
std::int64_t GetVolume(const std::array<Position, 4>& points)
{
  Position e[3];
  for (int k = 0; k < 3; ++k)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      e[k][axis] = points[k + 1][axis] - points[0][axis];
      if (std::abs(e[k][axis]) > (std::int64_t(1) << 18))
      {
        throw std::range_error("The reference is exact up to 1024 voxels only.");
      }
    }
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
    e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
    e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/// Barycentric weights of a point times the volume, all as signed as the volume.
std::array<std::int64_t, 4> GetWeights(const std::array<Position, 4>& points, const Position& p)
{
  std::array<std::int64_t, 4> weights{};
  for (int k = 0; k < 4; ++k)
  {
    std::array<Position, 4> replaced = points;
    replaced[k] = p;
    weights[k] = GetVolume(replaced);
  }
  return weights;
}

/// Whether the point moved by (e, e^2, e^3) lies inside. A weight is an affine function of the
/// point, so its slopes are its differences over one unit.
bool ContainsPerturbed(const std::array<Position, 4>& points, const Position& p, std::int64_t sign)
{
  const auto weights = GetWeights(points, p);
  std::array<std::array<std::int64_t, 4>, 3> moved{};
  for (int axis = 0; axis < 3; ++axis)
  {
    Position q = p;
    ++q[axis];
    moved[axis] = GetWeights(points, q);
  }
  for (int k = 0; k < 4; ++k)
  {
    const std::array<std::int64_t, 4> expansion{ { sign * weights[k],
      sign * (moved[0][k] - weights[k]), sign * (moved[1][k] - weights[k]),
      sign * (moved[2][k] - weights[k]) } };
    if (expansion < std::array<std::int64_t, 4>{ { 0, 0, 0, 0 } })
    {
      return false;
    }
  }
  return true;
}

std::int64_t CeilToVoxel(std::int64_t position)
{
  return position >= 0 ? (position + 255) / 256 : -((-position) / 256);
}

void AddTetrahedron(const std::array<Position, 4>& points, Containing candidate, const Box& output,
  std::int64_t sign, Result& result)
{
  std::array<std::int64_t, 3> low{};
  std::array<std::int64_t, 3> high{};
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto [least, most] =
      std::minmax({ points[0][axis], points[1][axis], points[2][axis], points[3][axis] });
    low[axis] = std::max<std::int64_t>(CeilToVoxel(least), output[2 * axis]);
    high[axis] = std::min<std::int64_t>(-CeilToVoxel(-most), output[2 * axis + 1]);
  }
  for (std::int64_t z = low[2]; z <= high[2]; ++z)
  {
    for (std::int64_t y = low[1]; y <= high[1]; ++y)
    {
      for (std::int64_t x = low[0]; x <= high[0]; ++x)
      {
        const Position p{ { x * 256, y * 256, z * 256 } };
        const auto weights = GetWeights(points, p);
        for (int k = 0; k < 4; ++k)
        {
          candidate.Numerators[k] = sign * weights[k];
        }
        if (*std::min_element(candidate.Numerators.begin(), candidate.Numerators.end()) < 0)
        {
          continue;
        }
        candidate.Generic = ContainsPerturbed(points, p, sign);
        const std::int64_t voxel =
          ((z - output[4]) * GetSize(output, 1) + (y - output[2])) * GetSize(output, 0) +
          (x - output[0]);
        result.Voxels[voxel].push_back(candidate);
      }
    }
  }
}

} // namespace

bool Containing::operator<(const Containing& other) const
{
  return std::make_tuple(this->Inverted, this->Cell, this->Tetrahedron) <
    std::make_tuple(other.Inverted, other.Cell, other.Tetrahedron);
}

std::int64_t Containing::GetNearestVertex() const
{
  int best = 0;
  for (int k = 1; k < 4; ++k)
  {
    if (this->Numerators[k] > this->Numerators[best] ||
      (this->Numerators[k] == this->Numerators[best] && this->Vertices[k] < this->Vertices[best]))
    {
      best = k;
    }
  }
  return this->Vertices[best];
}

bool Containing::SharesSimplex(const Containing& other) const
{
  std::set<std::int64_t> mine;
  std::set<std::int64_t> others;
  for (int k = 0; k < 4; ++k)
  {
    if (this->Numerators[k] > 0)
    {
      mine.insert(this->Vertices[k]);
    }
    if (other.Numerators[k] > 0)
    {
      others.insert(other.Vertices[k]);
    }
  }
  return mine == others;
}

std::int64_t Containing::GetSingleVertex() const
{
  const std::int64_t nearest = this->GetNearestVertex();
  return std::count(this->Numerators.begin(), this->Numerators.end(), 0) == 3 ? nearest : -1;
}

Result Resample(const SamplingMesh& mesh, const Box& output)
{
  Result result;
  result.Voxels.resize(GetNumberOfVoxels(output));
  const Box& box = mesh.Voxels;
  std::int64_t cell = -1;
  for (int z = box[4]; z < box[5]; ++z)
  {
    for (int y = box[2]; y < box[3]; ++y)
    {
      for (int x = box[0]; x < box[1]; ++x)
      {
        ++cell;
        const auto vertices = NumberVertices(x, y, z);
        for (int t = 0; t < 5; ++t)
        {
          bool active = mesh.Active.empty() || (mesh.Active[cell] >> t & 1) != 0;
          Containing candidate;
          candidate.Cell = cell;
          candidate.Tetrahedron = t;
          std::array<Position, 4> points{};
          std::array<Position, 4> rest{};
          for (int k = 0; k < 4; ++k)
          {
            const Offset& offset = vertices[NumbersOfTetrahedra[t][k]];
            rest[k] = { { x + offset[0], y + offset[1], z + offset[2] } };
            const std::int64_t vertex =
              ((rest[k][2] - box[4]) * GetSize(box, 1) + (rest[k][1] - box[2])) * GetSize(box, 0) +
              (rest[k][0] - box[0]);
            candidate.Vertices[k] = vertex;
            active = active && (mesh.Present.empty() || mesh.Present[vertex]);
            points[k] = mesh.Positions[vertex];
          }
          if (!active)
          {
            continue;
          }
          const std::int64_t volume = GetVolume(points);
          if (volume == 0)
          {
            ++result.NumberOfFlatTetrahedra;
            continue;
          }
          candidate.Inverted = (volume > 0) != (GetVolume(rest) > 0);
          candidate.Denominator = std::abs(volume);
          result.NumberOfInvertedTetrahedra += candidate.Inverted ? 1 : 0;
          AddTetrahedron(points, candidate, output, volume > 0 ? 1 : -1, result);
        }
      }
    }
  }
  for (auto& containing : result.Voxels)
  {
    std::sort(containing.begin(), containing.end());
    result.NumberOfCoveredVoxels += containing.empty() ? 0 : 1;
    const auto generic = std::count_if(
      containing.begin(), containing.end(), [](const Containing& c) { return c.Generic; });
    result.NumberOfOverlappedVoxels += generic > 1 ? 1 : 0;
    result.NumberOfTouchedVoxels +=
      std::any_of(containing.begin(), containing.end(),
        [&containing](const Containing& c) { return !c.SharesSimplex(containing.front()); })
      ? 1
      : 0;
  }
  return result;
}

} // namespace reference
