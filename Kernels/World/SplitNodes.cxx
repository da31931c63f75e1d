// SPDX-License-Identifier: BSD-3-Clause
#include "SplitNodes.h"

#include "CoincidentPoints.h"
#include "FaceNeighbors.h"
#include "IndexBounds.h"
#include "MeshAtRest.h"
#include "StaticMapping.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cstddef>

namespace deformvolume
{

namespace
{

// Returns for each node whether coincident faces have different nodes at its position. lowest: the
// lowest node at the position of each node.
std::vector<unsigned char> FindSplitPositions(
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<std::int32_t>& lowest)
{
  std::vector<Tetrahedron> joined = tetrahedra;
  for (Tetrahedron& tetrahedron : joined)
  {
    for (std::int32_t& node : tetrahedron)
    {
      node = lowest[static_cast<std::size_t>(node)];
    }
  }
  const FaceNeighbors neighbors(joined, lowest.size());
  std::vector<unsigned char> isSplit(lowest.size(), 0);
  for (std::size_t face = 0; face < neighbors.GetNumberOfFaces(); ++face)
  {
    const Tetrahedron& nodes = tetrahedra[face / 4];
    const Tetrahedron& others = tetrahedra[neighbors.GetNext(face) / 4];
    for (std::size_t k = 0; k < 4; ++k)
    {
      if (k != face % 4 && std::find(others.begin(), others.end(), nodes[k]) == others.end())
      {
        isSplit[static_cast<std::size_t>(joined[face / 4][k])] = 1;
      }
    }
  }
  return isSplit;
}

} // namespace

void SplitNodes::Update(const MeshAtRest& mesh, bool onFaces)
{
  if (this->Owner == mesh.Owner && this->Connectivity == mesh.ConnectivityVersion &&
    this->OnFaces == onFaces)
  {
    return;
  }
  this->Owner = mesh.Owner;
  this->Connectivity = mesh.ConnectivityVersion;
  this->OnFaces = onFaces;
  this->Pairs.clear();
  const std::vector<std::int32_t> lowest = FindCoincidentPoints(mesh.Points);
  constexpr std::int32_t unused = -1;
  std::vector<std::int32_t> used(lowest.size(), unused); // the first used node at each position
  std::vector<unsigned char> isKnown(lowest.size(), 0);
  for (const Tetrahedron& tetrahedron : mesh.Tetrahedra)
  {
    for (const std::int32_t node : tetrahedron)
    {
      std::int32_t& first = used[static_cast<std::size_t>(lowest[static_cast<std::size_t>(node)])];
      first = first == unused ? node : first;
      unsigned char& known = isKnown[static_cast<std::size_t>(node)];
      if (first != node && known == 0)
      {
        this->Pairs.push_back({ first, node, mesh.Points[static_cast<std::size_t>(node)] });
      }
      known = 1;
    }
  }
  if (onFaces && !this->Pairs.empty())
  {
    const std::vector<unsigned char> isSplit = FindSplitPositions(mesh.Tetrahedra, lowest);
    this->Pairs.erase(std::remove_if(this->Pairs.begin(), this->Pairs.end(),
                        [&](const Pair& pair)
                        {
                          const std::int32_t node = lowest[static_cast<std::size_t>(pair.First)];
                          return isSplit[static_cast<std::size_t>(node)] == 0;
                        }),
      this->Pairs.end());
  }
}

std::string SplitNodes::Describe(const float* displacements, const Extent& voxels) const
{
  // The nodes at the ends of a gap may not have moved, and lie between the voxels.
  IndexBounds split;
  bool isTorn = false;
  for (const Pair& pair : this->Pairs)
  {
    split.Add(pair.Position);
    isTorn = isTorn ||
      glm::distance(GetVector(displacements, pair.First), GetVector(displacements, pair.Second)) >
        1.0;
  }
  const IndexBounds box = GetBox(voxels);
  const bool isBetween =
    glm::all(glm::lessThan(split.Min, box.Max)) && glm::all(glm::greaterThan(split.Max, box.Min));
  return isTorn && isBetween
    ? "The deformation mesh is split: nodes with one position at rest move more "
      "than an output voxel apart, and the volume is stretched over the gap."
    : "";
}

std::string DescribeOverlap(const StaticMapping& mapping)
{
  if (!mapping.SharedVoxel)
  {
    return "";
  }
  const glm::i64vec3& voxel = *mapping.SharedVoxel;
  return "Bodies of the deformation mesh overlap at rest, for example at the voxel (" +
    std::to_string(voxel.x) + ", " + std::to_string(voxel.y) + ", " + std::to_string(voxel.z) +
    "). Voxels in two bodies follow the one with less volume. If the bodies move apart, the volume "
    "on their surfaces is shown twice, or stretched. Remove the cells of one body from the "
    "overlap.";
}

} // namespace deformvolume
