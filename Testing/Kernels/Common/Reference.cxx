// SPDX-License-Identifier: BSD-3-Clause
#include "Reference.h"

#include "CutReference.h"

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

/// The eight vertices of a cell, numbered 1 to 8 as in the literature, as offsets from the cell.
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

/// Barycentric weights of a point times the volume. All of them have the sign of the volume.
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

/// Whether the point, moved by (e, e^2, e^3), lies inside. A weight is an affine function of the
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

/// isDivided: whether the candidate owns only the samples on its side of a smooth cut.
void AddTetrahedron(Containing candidate, bool isDivided, const SamplingMesh& mesh,
  const Box& output, std::int64_t sign, Result& result)
{
  const std::array<Position, 4>& points = candidate.Points;
  const std::vector<float>& distances = mesh.Distances;
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
        if (!distances.empty() && candidate.Interpolate(distances.data(), 1, 0) < 0.0L)
        {
          continue;
        }
        if (isDivided &&
          (candidate.Interpolate(mesh.CutDistances.data(), 1, 0) < 0.0L) != (candidate.Side == 1))
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

/// Which simplices of the voxel grid have a tetrahedron that writes the voxels in them, by the fill
/// rule for the undeformed voxel grid.
class Ownership
{
public:
  explicit Ownership(const SamplingMesh& mesh)
    : Mesh(mesh)
  {
  }

  /// group: all tetrahedra that contain a voxel in the same simplex.
  bool IsOwned(const std::vector<const Containing*>& group) const
  {
    bool interior = false;
    bool regular = true;
    for (const std::int64_t vertex : GetSimplex(*group.front()))
    {
      const Position place = this->GetPlace(vertex);
      const bool isRegular = this->IsRegular(place);
      regular = regular && isRegular;
      interior = interior || (isRegular && !this->IsOnBorder(place));
    }
    const bool inside = GetSimplex(*group.front()).size() == 4;
    if (inside || interior)
    {
      return std::any_of(
        group.begin(), group.end(), [](const Containing* c) { return c->Generic; });
    }
    // On other parts of the border of the sampling mesh one tetrahedron of the group is chosen,
    // even if others are missing.
    return !regular || this->HasOwnerByIndex(group);
  }

private:
  static std::vector<std::int64_t> GetSimplex(const Containing& containing)
  {
    std::vector<std::int64_t> vertices;
    for (int k = 0; k < 4; ++k)
    {
      if (containing.Numerators[k] > 0)
      {
        vertices.push_back(containing.Vertices[k]);
      }
    }
    return vertices;
  }

  /// Returns the index of a vertex on each axis, counted from the first voxel.
  Position GetPlace(std::int64_t vertex) const
  {
    const std::int64_t x = GetSize(this->Mesh.Voxels, 0);
    const std::int64_t y = GetSize(this->Mesh.Voxels, 1);
    return { { vertex % x, vertex / x % y, vertex / (x * y) } };
  }

  bool IsOnBorder(const Position& place) const
  {
    bool border = false;
    for (int axis = 0; axis < 3; ++axis)
    {
      border = border || place[axis] == 0 || place[axis] == GetSize(this->Mesh.Voxels, axis) - 1;
    }
    return border;
  }

  /// Whether all voxels and tetrahedra around a vertex exist, of those that lie within the volume.
  bool IsRegular(const Position& place) const
  {
    const Box& box = this->Mesh.Voxels;
    const std::int64_t size[3] = { GetSize(box, 0), GetSize(box, 1), GetSize(box, 2) };
    bool regular = true;
    for (int step = 0; step < 27; ++step)
    {
      const std::int64_t x = place[0] + step % 3 - 1;
      const std::int64_t y = place[1] + step / 3 % 3 - 1;
      const std::int64_t z = place[2] + step / 9 - 1;
      const bool lower = x >= 0 && y >= 0 && z >= 0;
      if (lower && x < size[0] && y < size[1] && z < size[2])
      {
        regular = regular &&
          (this->Mesh.Present.empty() || this->Mesh.Present[(z * size[1] + y) * size[0] + x]) &&
          (this->Mesh.Distances.empty() ||
            !(this->Mesh.Distances[(z * size[1] + y) * size[0] + x] < 0.0F));
      }
      const bool isCell = step % 3 < 2 && step / 3 % 3 < 2 && step / 9 < 2;
      if (isCell && lower && x < size[0] - 1 && y < size[1] - 1 && z < size[2] - 1)
      {
        regular = regular &&
          (this->Mesh.Active.empty() ||
            (this->Mesh.Active[(z * (size[1] - 1) + y) * (size[0] - 1) + x] & 31) == 31);
      }
    }
    return regular;
  }

  /// On the border of the volume, the owner is in the cell with the simplex on its low sides, or in
  /// the last cell on an axis. It is the first tetrahedron of that cell that has the simplex and is
  /// not flat.
  bool HasOwnerByIndex(const std::vector<const Containing*>& group) const
  {
    const std::vector<std::int64_t> simplex = GetSimplex(*group.front());
    Position owner{};
    for (int axis = 0; axis < 3; ++axis)
    {
      owner[axis] = GetSize(this->Mesh.Voxels, axis) - 2;
      for (const std::int64_t vertex : simplex)
      {
        owner[axis] = std::min(owner[axis], this->GetPlace(vertex)[axis]);
      }
    }
    const std::int64_t cell = (owner[2] * (GetSize(this->Mesh.Voxels, 1) - 1) + owner[1]) *
        (GetSize(this->Mesh.Voxels, 0) - 1) +
      owner[0];
    const auto vertices = NumberVertices(static_cast<int>(this->Mesh.Voxels[0] + owner[0]),
      static_cast<int>(this->Mesh.Voxels[2] + owner[1]),
      static_cast<int>(this->Mesh.Voxels[4] + owner[2]));
    for (int t = 0; t < 5; ++t)
    {
      std::set<std::int64_t> ids;
      for (int k = 0; k < 4; ++k)
      {
        const Offset& offset = vertices[NumbersOfTetrahedra[t][k]];
        ids.insert(((owner[2] + offset[2]) * GetSize(this->Mesh.Voxels, 1) + owner[1] + offset[1]) *
            GetSize(this->Mesh.Voxels, 0) +
          owner[0] + offset[0]);
      }
      if (std::all_of(simplex.begin(), simplex.end(),
            [&ids](std::int64_t vertex) { return ids.count(vertex) > 0; }))
      {
        return std::any_of(group.begin(), group.end(),
          [&](const Containing* c) { return c->Cell == cell && c->Tetrahedron == t; });
      }
    }
    return false;
  }

  const SamplingMesh& Mesh;
};

/// Sorts the tetrahedra that contain the voxel in the owned simplex to the front, if exactly one
/// simplex is owned.
void PreferOwned(const Ownership& ownership, std::vector<Containing>& containing)
{
  std::vector<std::vector<const Containing*>> groups;
  for (const Containing& one : containing)
  {
    const auto group = std::find_if(groups.begin(), groups.end(),
      [&one](const std::vector<const Containing*>& g) { return g.front()->SharesSimplex(one); });
    if (group == groups.end())
    {
      groups.push_back({ &one });
    }
    else
    {
      group->push_back(&one);
    }
  }
  const auto isOwned = [&ownership](const std::vector<const Containing*>& group)
  { return ownership.IsOwned(group); };
  if (groups.size() > 1 && std::count_if(groups.begin(), groups.end(), isOwned) == 1)
  {
    const Containing first = *std::find_if(groups.begin(), groups.end(), isOwned)->front();
    std::stable_partition(containing.begin(), containing.end(),
      [&first](const Containing& one) { return one.SharesSimplex(first); });
  }
}

} // namespace

bool Containing::operator<(const Containing& other) const
{
  return std::make_tuple(this->Inverted, this->Cell, this->Tetrahedron, this->Side) <
    std::make_tuple(other.Inverted, other.Cell, other.Tetrahedron, other.Side);
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
  std::set<std::pair<std::int64_t, Position>> mine;
  std::set<std::pair<std::int64_t, Position>> others;
  for (int k = 0; k < 4; ++k)
  {
    if (this->Numerators[k] > 0)
    {
      mine.insert({ this->Vertices[k], this->Points[k] });
    }
    if (other.Numerators[k] > 0)
    {
      others.insert({ other.Vertices[k], other.Points[k] });
    }
  }
  return mine == others;
}

std::int64_t Containing::GetSingleVertex() const
{
  const std::int64_t nearest = this->GetNearestVertex();
  return std::count(this->Numerators.begin(), this->Numerators.end(), 0) == 3 ? nearest : -1;
}

namespace
{

/// Lists all tetrahedra of the mesh, cell by cell.
std::vector<MeshTetrahedron> ListTetrahedra(const SamplingMesh& mesh)
{
  std::vector<MeshTetrahedron> tetrahedra;
  const Box& box = mesh.Voxels;
  std::int64_t cell = 0;
  for (int z = box[4]; z < box[5]; ++z)
  {
    for (int y = box[2]; y < box[3]; ++y)
    {
      for (int x = box[0]; x < box[1]; ++x, ++cell)
      {
        const auto vertices = NumberVertices(x, y, z);
        for (int t = 0; t < 5; ++t)
        {
          MeshTetrahedron made;
          made.Active = mesh.Active.empty() || (mesh.Active[cell] >> t & 1) != 0;
          made.Crossed = !mesh.Crossed.empty() && (mesh.Crossed[cell] >> t & 1) != 0;
          for (int k = 0; k < 4; ++k)
          {
            const Offset& offset = vertices[NumbersOfTetrahedra[t][k]];
            made.Vertices[k] =
              ((z + offset[2] - box[4]) * GetSize(box, 1) + y + offset[1] - box[2]) *
                GetSize(box, 0) +
              x + offset[0] - box[0];
          }
          tetrahedra.push_back(made);
        }
      }
    }
  }
  return tetrahedra;
}

/// Whether a tetrahedron has all of its vertices, and at least one of them is not on the far side
/// of the boundary.
bool IsThere(const MeshTetrahedron& tetrahedron, const SamplingMesh& mesh)
{
  bool there = tetrahedron.Active;
  bool clipped = !mesh.Distances.empty();
  for (const std::int64_t vertex : tetrahedron.Vertices)
  {
    there = there && (mesh.Present.empty() || mesh.Present[vertex]);
    clipped = clipped && mesh.Distances[vertex] < 0.0F;
  }
  return there && !clipped;
}

} // namespace

Result Resample(const SamplingMesh& mesh, const Box& output)
{
  Result result;
  result.Voxels.resize(GetNumberOfVoxels(output));
  const std::vector<MeshTetrahedron> tetrahedra = ListTetrahedra(mesh);
  const CutReference cut(mesh, tetrahedra);
  const std::int64_t width = GetSize(mesh.Voxels, 0);
  const std::int64_t height = GetSize(mesh.Voxels, 1);
  for (std::size_t i = 0; i < tetrahedra.size(); ++i)
  {
    const MeshTetrahedron& tetrahedron = tetrahedra[i];
    if (!IsThere(tetrahedron, mesh))
    {
      continue;
    }
    const bool isDivided = cut.IsDivided(tetrahedron);
    bool inverted = false;
    for (int side = 0; side < (isDivided ? 2 : 1); ++side)
    {
      Containing candidate;
      candidate.Cell = static_cast<std::int64_t>(i / 5);
      candidate.Tetrahedron = static_cast<int>(i % 5);
      candidate.Side = side;
      candidate.Vertices = tetrahedron.Vertices;
      std::array<Position, 4> rest{};
      for (int k = 0; k < 4; ++k)
      {
        const std::int64_t vertex = tetrahedron.Vertices[k];
        rest[k] = { { vertex % width, vertex / width % height, vertex / (width * height) } };
        candidate.Points[k] = isDivided ? cut.GetPosition(vertex, side) : mesh.Positions[vertex];
      }
      const std::int64_t volume = GetVolume(candidate.Points);
      if (volume == 0)
      {
        ++result.NumberOfFlatTetrahedra;
        continue;
      }
      candidate.Inverted = ((volume > 0) != (GetVolume(rest) > 0)) != mesh.IsMirrored;
      candidate.Denominator = std::abs(volume);
      inverted = inverted || candidate.Inverted;
      AddTetrahedron(candidate, isDivided, mesh, output, volume > 0 ? 1 : -1, result);
    }
    result.NumberOfInvertedTetrahedra += inverted ? 1 : 0;
  }
  const Ownership ownership(mesh);
  for (auto& containing : result.Voxels)
  {
    std::sort(containing.begin(), containing.end());
    PreferOwned(ownership, containing);
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
