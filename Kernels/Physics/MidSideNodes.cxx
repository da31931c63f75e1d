// SPDX-License-Identifier: BSD-3-Clause
#include "MidSideNodes.h"

#include "BoundaryFaces.h"
#include "ElasticBody.h"
#include "Error.h"
#include "FaceNeighbors.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>

namespace deformvolume
{
namespace
{

// Identifies an edge by its ends, the lower one first.
std::uint64_t GetKey(const Tetrahedron& corners, std::size_t edge)
{
  const auto [least, most] =
    std::minmax(corners[TetrahedronEdges[edge][0]], corners[TetrahedronEdges[edge][1]]);
  return static_cast<std::uint64_t>(least) << 32 | static_cast<std::uint64_t>(most);
}

struct Edge
{
  std::uint64_t Key;
  std::int32_t Node;
};

// Calls take(tetrahedron, edge) for all edges of all tetrahedra.
template <typename Take>
void ForEdges(std::size_t tetrahedra, Take&& take)
{
  for (std::size_t t = 0; t < tetrahedra; ++t)
  {
    for (std::size_t edge = 0; edge < 6; ++edge)
    {
      take(t, edge);
    }
  }
}

// Lists each edge once, sorted by keys, with its mid-side node or -1.
std::vector<Edge> FindEdges(const ElasticBody& body)
{
  std::vector<Edge> edges;
  edges.reserve(6 * body.Tetrahedra.size());
  ForEdges(body.Tetrahedra.size(),
    [&](std::size_t t, std::size_t edge) {
      edges.push_back({ GetKey(body.Tetrahedra[t], edge), body.MidSides[t][edge] });
    });
  std::sort(edges.begin(), edges.end(),
    [](const Edge& a, const Edge& b) { return a.Key != b.Key ? a.Key < b.Key : a.Node > b.Node; });
  std::size_t withTwo = 0;
  std::uint64_t first = 0;
  for (std::size_t i = 1; i < edges.size(); ++i)
  {
    if (edges[i].Key == edges[i - 1].Key && edges[i].Node != edges[i - 1].Node &&
      edges[i].Node >= 0)
    {
      first = withTwo == 0 ? edges[i].Key : first;
      ++withTwo;
    }
  }
  if (withTwo > 0)
  {
    throw Error("The mesh at rest has " + std::to_string(withTwo) +
      (withTwo == 1 ? " edge" : " edges") +
      " with more than one mid-side node. The first is between the nodes " +
      std::to_string(first >> 32) + " and " + std::to_string(first & 0xffffffffu) +
      ". Merge the mid-side nodes of each edge.");
  }
  edges.erase(std::unique(edges.begin(), edges.end(),
                [](const Edge& a, const Edge& b) { return a.Key == b.Key; }),
    edges.end());
  return edges;
}

// A boundary face of a four-node tetrahedron, with forces at all three corners.
struct LoadedFace
{
  std::size_t Tetrahedron;
  std::size_t Opposite; // the corner of the tetrahedron that is opposite the face
  std::array<std::int32_t, 3> Corners;
  double Area;
};

std::vector<LoadedFace> FindLoadedFaces(
  const ElasticBody& body, const std::vector<glm::dvec3>& forces)
{
  std::vector<LoadedFace> loaded;
  const FaceNeighbors neighbors(body.Tetrahedra, body.Points.size());
  for (std::size_t face = 0; face < neighbors.GetNumberOfFaces(); ++face)
  {
    const std::size_t t = face / 4;
    const auto corners =
      TetrahedronFace{ 0, static_cast<std::int32_t>(face % 4) }.GetNodes(body.Tetrahedra[t]);
    const auto at = [&](const std::vector<glm::dvec3>& vectors, std::size_t i)
    { return vectors[static_cast<std::size_t>(corners[i])]; };
    const glm::dvec3 none(0.0);
    if (neighbors.GetNext(face) == face && body.MidSides[t][0] < 0 && at(forces, 0) != none &&
      at(forces, 1) != none && at(forces, 2) != none)
    {
      const glm::dvec3 origin = at(body.Points, 0);
      const double area =
        0.5 * glm::length(glm::cross(at(body.Points, 1) - origin, at(body.Points, 2) - origin));
      loaded.push_back({ t, face % 4, corners, area });
    }
  }
  return loaded;
}

// Passes the forces at the corners of faces on to the mid-side nodes of the faces.
void PassForcesOn(
  const ElasticBody& body, const std::vector<LoadedFace>& faces, std::vector<glm::dvec3>& forces)
{
  std::vector<double> areas(forces.size(), 0.0);
  for (const LoadedFace& face : faces)
  {
    for (const std::int32_t corner : face.Corners)
    {
      areas[static_cast<std::size_t>(corner)] += face.Area;
    }
  }
  std::vector<glm::dvec3> passed(body.Points.size(), glm::dvec3(0.0));
  for (const LoadedFace& face : faces)
  {
    for (std::size_t edge = 0; edge < 6; ++edge)
    {
      const auto [a, b] = TetrahedronEdges[edge];
      for (const std::size_t end : { a, b })
      {
        const auto corner = static_cast<std::size_t>(body.Tetrahedra[face.Tetrahedron][end]);
        if (a != face.Opposite && b != face.Opposite)
        {
          // Each corner is an end of two edges of the face.
          passed[static_cast<std::size_t>(body.MidSides[face.Tetrahedron][edge])] +=
            0.5 * face.Area / areas[corner] * forces[corner];
        }
      }
    }
  }
  for (std::size_t node = 0; node < forces.size(); ++node)
  {
    passed[node] += areas[node] > 0.0 ? glm::dvec3(0.0) : forces[node];
  }
  forces = std::move(passed);
}

} // namespace

std::vector<std::array<std::int32_t, 2>> AddMidSideNodes(
  ElasticBody& body, std::vector<glm::dvec3>* forces)
{
  body.MidSides.resize(body.Tetrahedra.size(), { { -1, -1, -1, -1, -1, -1 } });
  const bool hasForces = forces && !forces->empty();
  const std::vector<LoadedFace> loadedFaces =
    hasForces ? FindLoadedFaces(body, *forces) : std::vector<LoadedFace>();
  std::vector<Edge> edges = FindEdges(body);
  std::vector<std::array<std::int32_t, 2>> ends;
  for (Edge& edge : edges)
  {
    if (edge.Node >= 0)
    {
      continue;
    }
    const auto a = static_cast<std::size_t>(edge.Key >> 32);
    const auto b = static_cast<std::size_t>(edge.Key & 0xffffffffu);
    if (body.Points.size() > std::numeric_limits<std::int32_t>::max())
    {
      throw Error(
        "The mesh has too many edges: with a node in the middle of each there are more than "
        "2,147,483,648 nodes. Use a coarser mesh.");
    }
    edge.Node = static_cast<std::int32_t>(body.Points.size());
    body.Points.push_back(0.5 * (body.Points[a] + body.Points[b]));
    if (!body.Fixed.empty())
    {
      body.Fixed.push_back(body.Fixed[a] != 0 && body.Fixed[b] != 0 ? 1 : 0);
    }
    ends.push_back({ { static_cast<std::int32_t>(a), static_cast<std::int32_t>(b) } });
  }
  ForEdges(body.Tetrahedra.size(),
    [&](std::size_t t, std::size_t edge)
    {
      body.MidSides[t][edge] = std::lower_bound(edges.begin(), edges.end(),
        GetKey(body.Tetrahedra[t], edge),
        [](const Edge& a, std::uint64_t key)
        { return a.Key < key; })->Node;
    });
  if (hasForces)
  {
    PassForcesOn(body, loadedFaces, *forces);
  }
  return ends;
}

std::vector<std::int32_t> SplitMidSideNodes(const std::vector<Tetrahedron>& tetrahedra,
  std::int32_t numberOfNodes, std::vector<MidSideNodes>& midSides)
{
  std::vector<std::int32_t> origins;
  std::unordered_map<std::uint64_t, std::int32_t> nodeOfEdge;
  nodeOfEdge.reserve(2 * tetrahedra.size());
  std::vector<bool> isTaken(static_cast<std::size_t>(numberOfNodes), false);
  ForEdges(tetrahedra.size(),
    [&](std::size_t t, std::size_t edge)
    {
      std::int32_t& node = midSides[t][edge];
      const auto [found, isNew] = nodeOfEdge.try_emplace(GetKey(tetrahedra[t], edge), node);
      if (isNew && isTaken[static_cast<std::size_t>(node)])
      {
        found->second = numberOfNodes + static_cast<std::int32_t>(origins.size());
        origins.push_back(node);
      }
      isTaken[static_cast<std::size_t>(node)] = true;
      node = found->second;
    });
  return origins;
}

} // namespace deformvolume
