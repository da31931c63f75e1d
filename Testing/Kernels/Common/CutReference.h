// SPDX-License-Identifier: BSD-3-Clause
// A reference for smooth cuts: which tetrahedra a cut divides, and the positions of their vertices
// as seen from each side. It uses sets of vertices and edges of the whole mesh, whereas the kernels
// look at bits around one vertex.
#ifndef CutReference_h
#define CutReference_h

#include "Reference.h"

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace reference
{

struct MeshTetrahedron
{
  std::array<std::int64_t, 4> Vertices{};
  bool Active = true;
  bool Crossed = false;
};

class CutReference
{
public:
  /// tetrahedra: all tetrahedra of the mesh.
  CutReference(const SamplingMesh& mesh, const std::vector<MeshTetrahedron>& tetrahedra);

  bool IsDivided(const MeshTetrahedron& tetrahedron) const;
  /// The position of a vertex of a divided tetrahedron as seen from a side. side: 1 for negative
  /// distances, else 0.
  Position GetPosition(std::int64_t vertex, int side) const;
  int GetSide(std::int64_t vertex) const { return this->Mesh.CutDistances[vertex] < 0.0F ? 1 : 0; }

private:
  using Edge = std::pair<std::int64_t, std::int64_t>;

  bool IsPlaced(std::int64_t vertex) const
  {
    return this->Mesh.Present.empty() || this->Mesh.Present[vertex];
  }
  bool HasEdge(std::int64_t a, std::int64_t b) const { return this->Edges.count({ a, b }) > 0; }
  /// The vertex that is as far beyond b as b is beyond a; -1 if there is none.
  std::int64_t Continue(std::int64_t a, std::int64_t b) const;

  const SamplingMesh& Mesh;
  std::set<std::int64_t> CrossedVertices;
  std::set<Edge> Edges;      // of active tetrahedra, in both directions
  std::set<Edge> WholeEdges; // of tetrahedra that are not divided
  std::map<std::int64_t, std::set<std::int64_t>>
    Apart; // vertices on the other side, in divided tetrahedra
};

} // namespace reference

#endif
