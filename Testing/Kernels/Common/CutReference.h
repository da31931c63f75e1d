// SPDX-License-Identifier: BSD-3-Clause
// Which tetrahedra a smooth cut divides, and where their vertices are as seen from each side, found
// once more on the host: with sets of vertices and edges of the whole mesh, where the kernels look
// at bits round one vertex.
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
  /// tetrahedra: all of the mesh.
  CutReference(const SamplingMesh& mesh, const std::vector<MeshTetrahedron>& tetrahedra);

  bool IsDivided(const MeshTetrahedron& tetrahedron) const;
  /// Where a vertex of a divided tetrahedron is as seen from a side: 1 where distances are
  /// negative, else 0.
  Position GetPosition(std::int64_t vertex, int side) const;
  int GetSide(std::int64_t vertex) const { return this->Mesh.CutDistances[vertex] < 0.0F ? 1 : 0; }

private:
  using Edge = std::pair<std::int64_t, std::int64_t>;

  bool IsPlaced(std::int64_t vertex) const
  {
    return this->Mesh.Present.empty() || this->Mesh.Present[vertex];
  }
  bool HasEdge(std::int64_t a, std::int64_t b) const { return this->Edges.count({ a, b }) > 0; }
  /// The vertex that is as far beyond b as b is beyond a, or -1.
  std::int64_t Continue(std::int64_t a, std::int64_t b) const;

  const SamplingMesh& Mesh;
  std::set<std::int64_t> CrossedVertices;
  std::set<Edge> Edges;                                 // of active tetrahedra, both ways
  std::set<Edge> WholeEdges;                            // of those that are not divided
  std::map<std::int64_t, std::set<std::int64_t>> Apart; // on the other side, in divided tetrahedra
};

} // namespace reference

#endif
