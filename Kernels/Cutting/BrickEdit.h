// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBrickEdit_h
#define DeformVolumeBrickEdit_h

#include "CellBricks.h"
#include "EditProgress.h"
#include "SnappedPoint.h"
#include "TetrahedronSet.h"
#include "VertexPositions.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <functional>

namespace deformvolume
{

/// Work data of an edit for one brick of cells: the positions of its vertices, and the tetrahedra
/// that the edit hits.
class BrickEdit
{
public:
  static constexpr std::size_t MaxVertices = 729;
  /// The vertices of each tetrahedron of a cell, as indices into the arrays of vertices.
  using CellTetrahedra = std::array<std::array<std::size_t, 4>, 5>;

  /// Sets the brick. Does not change positions and hits.
  void Set(const CellBricks& bricks, std::size_t brick);
  /// Sets the brick and the positions of its vertices.
  void Set(const VertexPositions& positions, std::size_t brick);

  const Extent& GetVertices() const { return this->Vertices; }
  std::size_t GetNumberOfVertices() const
  {
    return static_cast<std::size_t>(GetNumberOfPoints(this->Vertices));
  }
  const SnappedPoint& GetPosition(std::size_t vertex) const { return this->Positions[vertex]; }
  /// Copies the positions of all vertices, in continuous structured indices.
  void CopyPoints(std::array<glm::dvec3, MaxVertices>& points) const;
  bool HasPosition(std::size_t vertex) const { return this->HasPositions[vertex]; }
  /// Whether all vertices of a tetrahedron have positions.
  bool HasPosition(const std::array<std::size_t, 4>& vertices) const
  {
    return this->HasPositions[vertices[0]] && this->HasPositions[vertices[1]] &&
      this->HasPositions[vertices[2]] && this->HasPositions[vertices[3]];
  }

  /// Calls function(x, y, z, index) for all cells of the brick. x, y and z are the indices of the
  /// cell within the brick; index is that of TetrahedronSet::GetIndex().
  template <typename Function>
  void ForEachCell(Function&& function) const
  {
    ForEachPoint({ { 0, this->Size[0] - 1, 0, this->Size[1] - 1, 0, this->Size[2] - 1 } },
      [&](int x, int y, int z) { function(x, y, z, TetrahedronSet::GetIndex(x, y, z)); });
  }

  /// Returns the first vertex of a cell. GetSteps() returns the offsets to the next vertex on each
  /// axis.
  std::size_t GetVertex(int x, int y, int z) const
  {
    return (static_cast<std::size_t>(z) * this->Steps[2]) +
      static_cast<std::size_t>(y) * this->Steps[1] + static_cast<std::size_t>(x);
  }
  const std::array<std::size_t, 3>& GetSteps() const { return this->Steps; }
  CellTetrahedra GetTetrahedra(int x, int y, int z) const;

  bool IsHit() const { return this->HasHits; }
  unsigned char GetHits(std::size_t index) const { return this->Hits[index]; }
  void Hit(std::size_t index, int tetrahedron)
  {
    this->Hits[index] = static_cast<unsigned char>(this->Hits[index] | 1U << tetrahedron);
    this->HasHits = true;
  }

  /// Hits the tetrahedra whose vertices have positions, and for which isToHit(vertices) returns
  /// true. It is called for all tetrahedra of the brick, in the order of ForEachCell().
  template <typename IsToHit>
  void HitIf(IsToHit&& isToHit)
  {
    this->ForEachCell(
      [&](int x, int y, int z, std::size_t index)
      {
        const CellTetrahedra tetrahedra = this->GetTetrahedra(x, y, z);
        for (std::size_t t = 0; t < tetrahedra.size(); ++t)
        {
          if (isToHit(tetrahedra[t]) && this->HasPosition(tetrahedra[t]))
          {
            this->Hit(index, static_cast<int>(t));
          }
        }
      });
  }
  /// Calls a function for the bricks 0 to `bricks` - 1 in parallel, and returns the tetrahedra that
  /// it hits. Throws Aborted if `progress` returns false.
  static TetrahedronSet ForEachBrick(std::size_t bricks,
    const std::function<void(std::size_t brick, BrickEdit& edit)>& function,
    const EditProgress& progress);

private:
  Extent Vertices = EmptyExtent;
  std::array<int, 3> Size{ { 0, 0, 0 } };          // number of cells on each axis
  std::array<std::size_t, 3> Steps{ { 0, 0, 0 } }; // offset to the next vertex on each axis
  std::array<SnappedPoint, MaxVertices> Positions;
  std::array<bool, MaxVertices> HasPositions;
  TetrahedronSet::Block Hits{};
  bool HasHits = false;
};

} // namespace deformvolume

#endif
