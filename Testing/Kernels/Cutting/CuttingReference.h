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

/// What cutting is compared with: slow, by other methods, without bricks and bounding boxes, and in
/// 128 bits.
namespace reference
{

using Place = std::array<std::int64_t, 3>;
/// One byte a cell, bit i = tetrahedron i.
using Mask = std::vector<unsigned char>;

/// The places of the vertices of tetrahedron t of a cell, after the numbers of the literature:
/// structured indices.
std::array<Place, 4> GetTetrahedron(const Place& cell, int t);

/// Vertices anywhere, some of them without a position.
class FreePositions : public deformvolume::VertexPositions
{
public:
  explicit FreePositions(const deformvolume::Extent& vertices);

  /// Moves vertices by up to so many steps, to multiples of a unit.
  void Shake(std::mt19937& random, int steps, int unit);

  std::size_t GetNumber(const Place& vertex) const;
  deformvolume::SnappedBox GetBox(std::size_t brick) const override;
  deformvolume::SnappedBox GetBox() const override;
  void Find(const deformvolume::Extent& vertices, deformvolume::SnappedPoint* positions,
    bool* hasPosition) const override;

  std::vector<deformvolume::SnappedPoint> Points;
  std::vector<bool> Has;
};

/// Tetrahedra that any of some triangles crosses: there is no direction along which both are apart.
Mask Cut(
  const FreePositions& positions, const std::vector<deformvolume::SnappedTriangle>& triangles);

/// Whether a point, in quarters of a step, lies in a tetrahedron of points in steps. It is moved by
/// (e, e^2, e^3).
bool Holds(const std::array<deformvolume::SnappedPoint, 4>& tetrahedron,
  const deformvolume::SnappedPoint& point);

/// A set as a mask.
Mask GetMask(const deformvolume::CellBricks& bricks, const deformvolume::TetrahedronSet& set);

int Count(const Mask& mask);

/// For each tetrahedron (5 * cell + t) of those that are left the number of the piece that it
/// belongs to, connected through faces; -1 for the others.
std::vector<int> FindPieces(
  const deformvolume::Extent& vertices, const Mask& switchedOff, int& numberOfPieces);

} // namespace reference

#endif
