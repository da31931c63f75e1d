// SPDX-License-Identifier: BSD-3-Clause
#include "RasterReference.h"

#include "OutputPlace.h"

#include <algorithm>
#include <cmath>
#include <map>

using namespace deformvolume;

namespace reference
{
namespace
{

__extension__ typedef __int128 Wide;
using Point = std::array<std::int64_t, 3>;

// Both results are accepted if a rest coordinate is nearer than this to a decision boundary, in
// voxels. The error of rest coordinates in the kernels is about 2^-22 voxel.
constexpr long double Margin = 1e-5L;

Wide Determinant(const Point& a, const Point& b, const Point& c, const Point& d)
{
  Wide m[3][3];
  for (int axis = 0; axis < 3; ++axis)
  {
    m[0][axis] = b[axis] - a[axis];
    m[1][axis] = c[axis] - a[axis];
    m[2][axis] = d[axis] - a[axis];
  }
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
    m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
    m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

int GetRestSign(const RasterCase& c, const Tetrahedron& t)
{
  const glm::dvec3 a = c.RestNodes[t[0]];
  // ToOutput may be a reflection.
  const double volume = c.VoxelGrid.ToOutput.GetDeterminant() *
    glm::dot(c.RestNodes[t[1]] - a, glm::cross(c.RestNodes[t[2]] - a, c.RestNodes[t[3]] - a));
  return (volume > 0.0) - (volume < 0.0);
}

enum class Answer
{
  No,
  Yes,
  Undecided
};

Answer IsBlanked(const RasterCase& c, const std::array<long double, 3>& rest, bool cubic)
{
  Answer answer = Answer::No;
  for (const auto& weight : GetWeights(c.VoxelGrid.VertexExtent, rest, cubic))
  {
    if (c.Blanked[weight.first] != 0 && weight.second != 0.0L)
    {
      if (std::fabs(weight.second) > Margin)
      {
        return Answer::Yes;
      }
      answer = Answer::Undecided;
    }
  }
  return answer;
}

// Whether an active tetrahedron contains a rest coordinate. Local coordinates are mirrored in odd
// cells. The corner tetrahedra 0 to 3 contain points whose L1 distance from 001, 111, 100 and 010
// is less than 1. The central tetrahedron contains the remaining points.
Answer IsActive(const RasterCase& c, const std::array<long double, 3>& rest)
{
  const Extent& extent = c.VoxelGrid.VertexExtent;
  const int corners[4][3] = { { 0, 0, 1 }, { 1, 1, 1 }, { 1, 0, 0 }, { 0, 1, 0 } };
  long double best = -1e9L; // the largest depth in an active tetrahedron
  for (std::int64_t z = 0; z < GetSize(extent, 2) - 1; ++z)
  {
    for (std::int64_t y = 0; y < GetSize(extent, 1) - 1; ++y)
    {
      for (std::int64_t x = 0; x < GetSize(extent, 0) - 1; ++x)
      {
        const std::array<std::int64_t, 3> cell{ { x, y, z } };
        long double depth = 1e9L;
        std::array<long double, 3> local{};
        for (int axis = 0; axis < 3; ++axis)
        {
          local[axis] = rest[axis] - static_cast<long double>(cell[axis]);
          depth = std::min({ depth, local[axis], 1.0L - local[axis] });
          if ((cell[axis] + extent[2 * axis]) % 2 != 0)
          {
            local[axis] = 1.0L - local[axis];
          }
        }
        if (depth < -Margin)
        {
          continue;
        }
        const std::int64_t index =
          (z * (GetSize(extent, 1) - 1) + y) * (GetSize(extent, 0) - 1) + x;
        long double central = depth;
        for (int t = 0; t < 4; ++t)
        {
          long double distance = 0.0L;
          for (int axis = 0; axis < 3; ++axis)
          {
            distance += std::fabs(local[axis] - corners[t][axis]);
          }
          central = std::min(central, distance - 1.0L);
          if (c.Active[index] >> t & 1)
          {
            best = std::max(best, std::min(depth, 1.0L - distance));
          }
        }
        if (c.Active[index] >> 4 & 1)
        {
          best = std::max(best, central);
        }
      }
    }
  }
  // A point exactly on a face is inside. A point very near a face is undecided.
  return best >= 0.0L && (best == 0.0L || best > Margin) ? Answer::Yes
    : best < -Margin                                     ? Answer::No
                                                         : Answer::Undecided;
}

void Take(const RasterCase& c, int tetrahedron, const std::array<long double, 3>& rest, bool cubic,
  RasterVoxel& voxel)
{
  bool open = false;
  std::array<long double, 3> clamped = rest;
  for (int axis = 0; axis < 3; ++axis)
  {
    const long double most = static_cast<long double>(GetSize(c.VoxelGrid.VertexExtent, axis) - 1);
    const long double tolerance = FindRestTolerance(c.VoxelGrid.ToOutput, axis);
    const long double outside = std::max(-rest[axis], rest[axis] - most) - tolerance;
    if (outside > Margin)
    {
      return;
    }
    open |= outside > -Margin;
    clamped[axis] = std::min(std::max(rest[axis], 0.0L), most);
  }
  for (const Answer answer : { c.Active.empty() ? Answer::Yes : IsActive(c, clamped),
         c.Blanked.empty()                                     ? Answer::Yes
           : IsBlanked(c, clamped, cubic) == Answer::Undecided ? Answer::Undecided
           : IsBlanked(c, clamped, cubic) == Answer::Yes       ? Answer::No
                                                               : Answer::Yes })
  {
    if (answer == Answer::No)
    {
      return;
    }
    open |= answer == Answer::Undecided;
  }
  voxel.Uncertain |= open;
  voxel.Covered = true;
  voxel.Tetrahedron = tetrahedron;
  voxel.Rest = clamped;
}

} // namespace

RasterResult Rasterize(const RasterCase& c, bool cubic)
{
  RasterResult result;
  result.Voxels.resize(GetNumberOfPoints(c.Output));
  std::vector<int> strict(result.Voxels.size());
  std::vector<Point> positions;
  for (std::size_t node = 0; node < c.RestNodes.size(); ++node)
  {
    Point position{};
    for (int axis = 0; axis < 3; ++axis)
    {
      position[axis] = static_cast<std::int64_t>(std::nearbyint(256.0 *
        (PlaceInOutput(c.VoxelGrid.ToOutput, c.RestNodes[node])[axis] +
          double{ c.Displacements[3 * node + axis] })));
    }
    positions.push_back(position);
  }
  for (const bool inverted : { false, true })
  {
    for (std::size_t t = 0; t < c.Tetrahedra.size(); ++t)
    {
      const Tetrahedron& nodes = c.Tetrahedra[t];
      std::array<Point, 4> corners{};
      std::array<int, 6> box = c.Output;
      for (int k = 0; k < 4; ++k)
      {
        corners[k] = positions[nodes[k]];
      }
      for (int axis = 0; axis < 3; ++axis)
      {
        std::int64_t low = corners[0][axis];
        std::int64_t high = low;
        for (const Point& corner : corners)
        {
          low = std::min(low, corner[axis]);
          high = std::max(high, corner[axis]);
        }
        box[2 * axis] = std::max(box[2 * axis], static_cast<int>(std::floor(double(low) / 256.0)));
        box[2 * axis + 1] =
          std::min(box[2 * axis + 1], static_cast<int>(std::ceil(double(high) / 256.0)));
      }
      const int restSign = GetRestSign(c, nodes);
      const Wide volume = Determinant(corners[0], corners[1], corners[2], corners[3]);
      if (restSign == 0 || volume == 0 || ((volume > 0) != (restSign > 0)) != inverted)
      {
        continue;
      }
      result.NumberOfInvertedTetrahedra += inverted;
      for (int z = box[4]; z <= box[5]; ++z)
      {
        for (int y = box[2]; y <= box[3]; ++y)
        {
          for (int x = box[0]; x <= box[1]; ++x)
          {
            const std::array<int, 3> index{ { x, y, z } };
            const Point sample{ { 256 * std::int64_t{ x }, 256 * std::int64_t{ y },
              256 * std::int64_t{ z } } };
            std::array<long double, 4> weights{};
            bool inside = true;
            bool interior = true;
            for (int k = 0; k < 4; ++k)
            {
              std::array<Point, 4> moved = corners;
              moved[k] = sample;
              const Wide part = Determinant(moved[0], moved[1], moved[2], moved[3]);
              inside &= part == 0 || (part > 0) == (volume > 0);
              interior &= part != 0;
              weights[k] = static_cast<long double>(part) / static_cast<long double>(volume);
            }
            if (!inside)
            {
              continue;
            }
            const std::size_t voxel = static_cast<std::size_t>(
              ((z - c.Output[4]) * GetSize(c.Output, 1) + (y - c.Output[2])) *
                GetSize(c.Output, 0) +
              (x - c.Output[0]));
            strict[voxel] += interior;
            if (result.Voxels[voxel].Covered || result.Voxels[voxel].Uncertain)
            {
              continue;
            }
            std::array<long double, 3> rest{};
            for (int axis = 0; axis < 3; ++axis)
            {
              long double displacement = 0.0L;
              for (int k = 0; k < 4; ++k)
              {
                displacement += weights[k] * c.Displacements[3 * nodes[k] + axis];
              }
              rest[axis] = index[axis] - displacement;
            }
            rest = FindRestIndex(c.VoxelGrid.ToOutput, rest);
            for (int axis = 0; axis < 3; ++axis)
            {
              rest[axis] -= c.VoxelGrid.VertexExtent[2 * axis];
            }
            Take(c, static_cast<int>(t), rest, cubic, result.Voxels[voxel]);
          }
        }
      }
    }
  }
  result.NumberOfOverlappedVoxels =
    std::count_if(strict.begin(), strict.end(), [](int times) { return times > 1; });
  return result;
}

std::vector<std::pair<std::int64_t, long double>> GetWeights(
  const Extent& volume, const std::array<long double, 3>& rest, bool cubic)
{
  std::array<std::vector<std::pair<std::int64_t, long double>>, 3> axes;
  for (int axis = 0; axis < 3; ++axis)
  {
    const std::int64_t size = GetSize(volume, axis);
    const auto whole = static_cast<std::int64_t>(std::floor(rest[axis]));
    std::map<std::int64_t, long double> ofVoxels;
    for (std::int64_t voxel = whole - 1; voxel <= whole + 2; ++voxel)
    {
      // The Catmull-Rom and the linear interpolation kernel, as functions of the distance.
      const long double x = std::fabs(rest[axis] - static_cast<long double>(voxel));
      long double weight = std::max(0.0L, 1.0L - x);
      if (cubic)
      {
        weight = x < 1.0L ? 1.5L * x * x * x - 2.5L * x * x + 1.0L
          : x < 2.0L      ? -0.5L * x * x * x + 2.5L * x * x - 4.0L * x + 2.0L
                          : 0.0L;
      }
      // A voxel beyond the border is extrapolated linearly from the two voxels next to it.
      if (voxel < 0 || voxel >= size)
      {
        const std::int64_t border = voxel < 0 ? 0 : size - 1;
        ofVoxels[border] += 2.0L * weight;
        ofVoxels[voxel < 0 ? 1 : size - 2] -= weight;
      }
      else
      {
        ofVoxels[voxel] += weight;
      }
    }
    for (const auto& weight : ofVoxels)
    {
      if (weight.second != 0.0L)
      {
        axes[axis].push_back(weight);
      }
    }
  }
  std::vector<std::pair<std::int64_t, long double>> weights;
  for (const auto& z : axes[2])
  {
    for (const auto& y : axes[1])
    {
      for (const auto& x : axes[0])
      {
        weights.emplace_back(
          (z.first * GetSize(volume, 1) + y.first) * GetSize(volume, 0) + x.first,
          x.second * y.second * z.second);
      }
    }
  }
  return weights;
}

} // namespace reference
