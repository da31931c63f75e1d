// SPDX-License-Identifier: BSD-3-Clause
#include "MeshSplit.h"

#include "Error.h"
#include "FaceNeighbors.h"
#include "IndexBounds.h"
#include "MeshChecks.h"
#include "NodeParts.h"
#include "ParallelFor.h"
#include "SheetCrossings.h"
#include "SplitRegion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace deformvolume
{
namespace
{

constexpr std::size_t TetrahedraOfPart = 65536;
constexpr std::size_t FacesOfPart = 8192;

void CheckSheet(
  const std::vector<glm::dvec3>& points, const std::vector<Sheet::Triangle>& triangles)
{
  for (std::size_t t = 0; t < triangles.size(); ++t)
  {
    for (const std::int64_t point : triangles[t])
    {
      if (point < 0 || point >= static_cast<std::int64_t>(points.size()))
      {
        throw Error("Triangle " + std::to_string(t) + " of the sheet has the point " +
          std::to_string(point) + ", but there are " + std::to_string(points.size()) +
          ". Correct the triangle.");
      }
      if (!IsFinite(points[static_cast<std::size_t>(point)]))
      {
        throw Error("Point " + std::to_string(point) +
          " of the sheet is not finite. Give all of its points finite coordinates.");
      }
    }
  }
}

void CheckPairs(const std::vector<TetrahedronPair>& pairs, std::size_t numberOfTetrahedra)
{
  for (const TetrahedronPair& pair : pairs)
  {
    for (const std::int32_t t : pair)
    {
      if (t < 0 || static_cast<std::size_t>(t) >= numberOfTetrahedra)
      {
        throw Error("A pair of tetrahedra that have not parted has the tetrahedron " +
          std::to_string(t) + ", but there are " + std::to_string(numberOfTetrahedra) +
          ". Give each mesh the pairs of its own cuts.");
      }
    }
  }
}

// Finds the bounding box of the nodes of tetrahedra, and checks the mesh in the same pass.
MeshSteps FindSteps(
  const std::vector<glm::dvec3>& positions, const std::vector<Tetrahedron>& tetrahedra)
{
  std::vector<IndexBounds> parts((tetrahedra.size() + TetrahedraOfPart - 1) / TetrahedraOfPart);
  ParallelForParts(tetrahedra.size(), TetrahedraOfPart,
    [&](std::size_t begin, std::size_t end)
    {
      CheckTetrahedra(tetrahedra.data(), begin, end, positions.size());
      IndexBounds bounds;
      for (std::size_t t = begin; t < end; ++t)
      {
        for (const std::int32_t node : tetrahedra[t])
        {
          const glm::dvec3& position = positions[static_cast<std::size_t>(node)];
          // Adding and multiplying is a quick test: the product is 0 only for finite coordinates.
          // Sums can overflow, hence the second test.
          if (!((position.x + position.y + position.z) * 0.0 == 0.0) && !IsFinite(position))
          {
            throw Error("The position of node " + std::to_string(node) +
              " of the deformation mesh is not finite.");
          }
          bounds.Add(position);
        }
      }
      parts[begin / TetrahedraOfPart] = bounds;
    });
  IndexBounds all;
  for (const IndexBounds& part : parts)
  {
    all.Add(part);
  }
  return MeshSteps(all.Min, all.Max);
}

enum SplitState : unsigned char
{
  Whole = 0,
  SplitNow = 1,
  SplitBefore = 2
};

std::vector<unsigned char> FindSplitFaces(const SplitRegion& region, const FaceNeighbors& neighbors,
  const SheetCrossings& crossings, const std::vector<TetrahedronPair>& unparted)
{
  std::vector<unsigned char> states(neighbors.GetNumberOfFaces(), Whole);
  for (const TetrahedronPair& pair : unparted)
  {
    const std::size_t t = region.Find(static_cast<std::size_t>(pair[0]));
    const std::size_t other = region.Find(static_cast<std::size_t>(pair[1]));
    for (std::size_t face = 4 * t; t < region.GetNumberOfTetrahedra() && face < 4 * t + 4; ++face)
    {
      const std::size_t next = neighbors.GetNext(face);
      if (next / 4 == other && neighbors.IsShared(face))
      {
        states[face] = states[next] = SplitBefore;
      }
    }
  }
  ParallelForItems(states.size(), FacesOfPart,
    [&](std::size_t face)
    {
      // Handle each pair of faces once, so that no two threads write to the same state.
      const std::size_t next = neighbors.GetNext(face);
      if (next > face && neighbors.IsShared(face) && states[face] == Whole &&
        (region.IsNear(face / 4) || region.IsNear(next / 4)) &&
        crossings.IsCrossedOddly(region.GetCentroid(face / 4), region.GetCentroid(next / 4)))
      {
        states[face] = states[next] = SplitNow;
      }
    });
  return states;
}

std::vector<unsigned char> MarkNodesOfSplitFaces(
  const SplitRegion& region, const std::vector<unsigned char>& states)
{
  std::vector<unsigned char> marks(region.GetNumberOfNodes(), 0);
  for (std::size_t face = 0; face < states.size(); ++face)
  {
    for (std::size_t i = 0; i < 4 && states[face] == SplitNow; ++i)
    {
      unsigned char& mark = marks[static_cast<std::size_t>(region.GetTetrahedra()[face / 4][i])];
      mark = i != face % 4 ? 1 : mark;
    }
  }
  return marks;
}

// Copies the nodes of parts, and gives the copies to the tetrahedra of these parts.
void SplitNodes(
  const SplitRegion& region, const NodeParts& parts, std::size_t numberOfNodes, MeshSplit& split)
{
  // For each node of the region, the number of its first copy minus 1. Part p > 0 of a node gets
  // the node copies[node] + p.
  std::vector<std::size_t> copies(region.GetNumberOfNodes());
  for (std::size_t node = 0; node < copies.size(); ++node)
  {
    copies[node] = numberOfNodes + split.Origins.size() - 1;
    split.Origins.insert(split.Origins.end(), static_cast<std::size_t>(parts.NumberOfCopies[node]),
      region.GetNode(node));
  }
  if (numberOfNodes + split.Origins.size() >
    static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
  {
    throw Error("The mesh would have more nodes than 2^31 after the cut. Cut a smaller mesh.");
  }
  for (std::size_t t = 0; t < region.GetNumberOfTetrahedra(); ++t)
  {
    bool isChanged = false;
    Tetrahedron& nodes = split.Tetrahedra[region.GetNumber(t)];
    for (std::size_t k = 0; k < 4; ++k)
    {
      const std::int32_t part = parts.PartOfCorner[4 * t + k];
      if (part > 0)
      {
        nodes[k] =
          static_cast<std::int32_t>(copies[static_cast<std::size_t>(region.GetTetrahedra()[t][k])] +
            static_cast<std::size_t>(part));
        isChanged = true;
      }
    }
    if (isChanged)
    {
      split.Changed.push_back(region.GetNumber(t));
    }
  }
}

bool HaveCommonFace(const Tetrahedron& a, const Tetrahedron& b)
{
  return std::count_if(a.begin(), a.end(),
           [&](std::int32_t node) { return std::find(b.begin(), b.end(), node) != b.end(); }) >= 3;
}

// Keeps the pairs whose tetrahedra still share a face.
std::vector<TetrahedronPair> FindUnparted(
  std::vector<TetrahedronPair> pairs, const std::vector<Tetrahedron>& tetrahedra)
{
  for (TetrahedronPair& pair : pairs)
  {
    std::sort(pair.begin(), pair.end());
  }
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                [&](const TetrahedronPair& pair)
                {
                  return pair[0] == pair[1] ||
                    !HaveCommonFace(tetrahedra[static_cast<std::size_t>(pair[0])],
                      tetrahedra[static_cast<std::size_t>(pair[1])]);
                }),
    pairs.end());
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

void SplitNodesInRegion(const SplitRegion& region, const SheetCrossings& crossings,
  std::size_t numberOfNodes, const std::vector<TetrahedronPair>& unparted, MeshSplit& split)
{
  const FaceNeighbors neighbors(region.GetTetrahedra(), region.GetNumberOfNodes());
  const std::vector<unsigned char> states = FindSplitFaces(region, neighbors, crossings, unparted);
  const NodeParts parts =
    FindNodeParts(region.GetTetrahedra(), neighbors, states, MarkNodesOfSplitFaces(region, states));
  SplitNodes(region, parts, numberOfNodes, split);
  for (std::size_t face = 0; face < states.size(); ++face)
  {
    const std::size_t next = neighbors.GetNext(face);
    if (states[face] == SplitNow && face < next)
    {
      ++split.NumberOfFaces;
      split.StillConnected.push_back({ { static_cast<std::int32_t>(region.GetNumber(face / 4)),
        static_cast<std::int32_t>(region.GetNumber(next / 4)) } });
    }
  }
}

void CheckCount(std::size_t numberOfTetrahedra)
{
  // FaceNeighbors numbers faces with 32 bits, four for each tetrahedron.
  if (numberOfTetrahedra > std::size_t{ 1 } << 30)
  {
    throw Error("The mesh has " + std::to_string(numberOfTetrahedra) +
      " tetrahedra. Meshes of at most 2^30 can be cut along their faces.");
  }
}

} // namespace

MeshSplit SplitMesh(const std::vector<glm::dvec3>& positions,
  const std::vector<Tetrahedron>& tetrahedra, const std::vector<glm::dvec3>& sheetPoints,
  const std::vector<std::array<std::int64_t, 3>>& sheetTriangles,
  const std::vector<TetrahedronPair>& unparted)
{
  CheckCount(tetrahedra.size());
  CheckSheet(sheetPoints, sheetTriangles);
  CheckPairs(unparted, tetrahedra.size());
  const MeshSteps steps = FindSteps(positions, tetrahedra);
  MeshSplit split;
  split.Tetrahedra = tetrahedra;
  split.StillConnected = unparted;
  if (steps.IsValid())
  {
    const SheetCrossings crossings(steps, sheetPoints, sheetTriangles);
    if (!crossings.IsEmpty())
    {
      const SplitRegion region(positions, tetrahedra, steps, crossings);
      SplitNodesInRegion(region, crossings, positions.size(), unparted, split);
    }
  }
  split.StillConnected = FindUnparted(std::move(split.StillConnected), split.Tetrahedra);
  return split;
}

} // namespace deformvolume
