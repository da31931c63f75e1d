// SPDX-License-Identifier: BSD-3-Clause
#ifndef CuttingReference_h
#define CuttingReference_h

#include "CellBricks.h"
#include "Sheet.h"
#include "TetrahedronSet.h"
#include "VertexPositions.h"

#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

/// A slow reference for cutting. It uses other methods than the engine, without bricks and bounding
/// boxes, and integers of 128 bits.
namespace reference
{

using Place = std::array<std::int64_t, 3>;
/// One byte per cell; bit i is tetrahedron i.
using Mask = std::vector<unsigned char>;

/// The structured indices of the vertices of tetrahedron t of a cell. Tetrahedra are numbered as in
/// the literature.
std::array<Place, 4> GetTetrahedron(const Place& cell, int t);

/// Vertices at arbitrary positions, some of them without a position.
class FreePositions : public deformvolume::VertexPositions
{
public:
  explicit FreePositions(const deformvolume::Extent& vertices);

  /// Moves each vertex by up to `steps` steps on each axis, to multiples of a unit.
  void Shake(std::mt19937& random, int steps, int unit);

  std::size_t GetNumber(const Place& vertex) const;
  deformvolume::SnappedBox GetBox(std::size_t brick) const override;
  deformvolume::SnappedBox GetBox() const override;
  void Find(const deformvolume::Extent& vertices, deformvolume::SnappedPoint* positions,
    bool* hasPosition) const override;

  std::vector<deformvolume::SnappedPoint> Points;
  std::vector<bool> Has;
};

/// The tetrahedra that at least one triangle crosses: those that no direction separates from the
/// triangle.
Mask Cut(
  const FreePositions& positions, const std::vector<deformvolume::SnappedTriangle>& triangles);

/// Whether a point, in quarters of a step, lies in a tetrahedron of points in steps. The point is
/// moved by (e, e^2, e^3).
bool Holds(const std::array<deformvolume::SnappedPoint, 4>& tetrahedron,
  const deformvolume::SnappedPoint& point);

/// Converts a set to a mask.
Mask GetMask(const deformvolume::CellBricks& bricks, const deformvolume::TetrahedronSet& set);

int Count(const Mask& mask);

/// For each tetrahedron (5 * cell + t) that is not switched off, the number of its part: tetrahedra
/// of a part are connected through faces. -1 for other tetrahedra.
std::vector<int> FindPieces(
  const deformvolume::Extent& vertices, const Mask& switchedOff, int& numberOfPieces);

} // namespace reference

#endif
