// SPDX-License-Identifier: BSD-3-Clause
#include "MeshBoundary.h"

#include "BarycentricMap.h"
#include "FaceNeighbours.h"
#include "FiveTetrahedra.h"
#include "IndexBounds.h"
#include "ParallelFor.h"
#include "TetrahedronRaster.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace deformvolume
{

namespace
{

using Triangle = std::array<glm::dvec3, 3>;

// Voxels by which a tetrahedron may reach into a cell since its nodes are rounded to 1/256 voxel.
constexpr double Tolerance = 1.0 / 64.0;
// Voxels by which a face may lie within the volume and count as on its border: voxels there are
// still linked.
constexpr double BorderTolerance = 1.0 / 512.0;
// Cells on an axis of a piece at most: edge functions have 64 bits, which hold those of pieces that
// span up to 5,000 output voxels.
constexpr double LargestPiece = 128.0;
// Cells of the volume on an axis of a piece of a field, about: in a piece the field is linear.
constexpr double FieldPiece = 4.0;

// A set of cells in a box of them, a bit each.
class CellSet
{
public:
  // cells: structured indices of the first and the last one on each axis.
  explicit CellSet(const Extent& cells)
    : Cells(cells)
    , Words(static_cast<std::size_t>((GetNumberOfPoints(cells) + 63) / 64))
  {
  }

  const Extent& GetCells() const { return this->Cells; }
  bool IsEmpty() const
  {
    return std::all_of(this->Words.begin(), this->Words.end(),
      [](const std::atomic<std::uint64_t>& word) { return word == 0; });
  }

  // May be called on several threads.
  void Add(std::int64_t x, std::int64_t y, std::int64_t z)
  {
    const std::int64_t number = this->GetRow(y, z) + x - this->Cells[0];
    this->Words[static_cast<std::size_t>(number / 64)].fetch_or(
      std::uint64_t{ 1 } << (number % 64), std::memory_order_relaxed);
  }

  // Whether it has any of the cells of a box that lies within its own.
  bool HasAny(const VoxelBox& box) const
  {
    for (std::int64_t z = box.Min[2]; z <= box.Max[2]; ++z)
    {
      for (std::int64_t y = box.Min[1]; y <= box.Max[1]; ++y)
      {
        const std::int64_t row = this->GetRow(y, z) - this->Cells[0];
        const std::int64_t end = row + box.Max[0] + 1;
        for (std::int64_t cell = row + box.Min[0]; cell < end;)
        {
          const std::uint64_t word =
            this->Words[static_cast<std::size_t>(cell / 64)] >> (cell % 64);
          const std::int64_t left = std::min(end - cell, 64 - cell % 64);
          if (left == 64 ? word != 0 : (word & ((std::uint64_t{ 1 } << left) - 1)) != 0)
          {
            return true;
          }
          cell += left;
        }
      }
    }
    return false;
  }

  // Calls take(x, y, z) for all cells, in ascending order.
  template <typename Take>
  void ForEach(Take&& take) const
  {
    const std::int64_t size[2] = { GetSize(this->Cells, 0), GetSize(this->Cells, 1) };
    for (std::size_t i = 0; i < this->Words.size(); ++i)
    {
      const std::uint64_t word = this->Words[i];
      for (int bit = 0; word != 0 && bit < 64; ++bit)
      {
        if (word >> bit & 1)
        {
          const std::int64_t number = 64 * static_cast<std::int64_t>(i) + bit;
          take(this->Cells[0] + number % size[0], this->Cells[2] + number / size[0] % size[1],
            this->Cells[4] + number / size[0] / size[1]);
        }
      }
    }
  }

private:
  std::int64_t GetRow(std::int64_t y, std::int64_t z) const
  {
    return ((z - this->Cells[4]) * GetSize(this->Cells, 1) + y - this->Cells[2]) *
      GetSize(this->Cells, 0);
  }

  Extent Cells;
  std::vector<std::atomic<std::uint64_t>> Words;
};

// The cells between voxels.
Extent GetCells(const Extent& voxels)
{
  return { { voxels[0], voxels[1] - 1, voxels[2], voxels[3] - 1, voxels[4], voxels[5] - 1 } };
}

// Adds the cells that a triangle crosses within the whole volume, and maybe some beside these.
// tolerance: by which it has to reach into a cell; 0: cells that it touches are added as well.
void AddCells(const Triangle& face, const Extent& whole, double tolerance, CellSet& cells)
{
  const glm::dvec3 normal = glm::cross(face[1] - face[0], face[2] - face[0]);
  int k = 0; // the axis on which the plane rises least
  for (int axis = 1; axis < 3; ++axis)
  {
    k = std::abs(normal[axis]) > std::abs(normal[k]) ? axis : k;
  }
  if (!(std::abs(normal[k]) > 0.0))
  {
    return;
  }
  const int u = (k + 1) % 3;
  const int v = (k + 2) % 3;
  IndexBounds box;
  for (const glm::dvec3& point : face)
  {
    box.Add(point);
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    box.Min[axis] = std::max(box.Min[axis], whole[2 * axis] + BorderTolerance);
    box.Max[axis] = std::min(box.Max[axis], whole[2 * axis + 1] - BorderTolerance);
    if (box.Min[axis] > box.Max[axis])
    {
      return;
    }
  }
  const Extent& all = cells.GetCells();
  const auto getFirst = [&](int axis, double low)
  { return std::max<double>(std::ceil(low + tolerance) - 1.0, all[2 * axis]); };
  const auto getLast = [&](int axis, double high)
  { return std::min<double>(std::floor(high - tolerance), all[2 * axis + 1]); };
  const double slopes[2] = { -normal[u] / normal[k], -normal[v] / normal[k] };
  const double sign = normal[k] > 0.0 ? 1.0 : -1.0;
  glm::dvec3 cell;
  // The lower or the upper side of the cell, as far as it lies in the box of the triangle.
  const auto side = [&](int axis, bool upper)
  { return std::clamp(cell[axis] + (upper ? 1.0 : 0.0), box.Min[axis], box.Max[axis]); };
  for (cell[v] = getFirst(v, box.Min[v]); cell[v] <= getLast(v, box.Max[v]); ++cell[v])
  {
    for (cell[u] = getFirst(u, box.Min[u]); cell[u] <= getLast(u, box.Max[u]); ++cell[u])
    {
      bool meets = true;
      for (int edge = 0; edge < 3 && meets; ++edge)
      {
        const glm::dvec3& from = face[static_cast<std::size_t>(edge)];
        const glm::dvec3& to = face[static_cast<std::size_t>((edge + 1) % 3)];
        const double inward[2] = { -sign * (to[v] - from[v]), sign * (to[u] - from[u]) };
        // The corner of the cell that lies farthest inside.
        const double farthest = inward[0] * (side(u, inward[0] > 0.0) - from[u]) +
          inward[1] * (side(v, inward[1] > 0.0) - from[v]);
        meets = farthest >= 0.0;
      }
      if (!meets)
      {
        continue;
      }
      const auto getHeight = [&](bool high)
      {
        return face[0][k] + slopes[0] * (side(u, (slopes[0] > 0.0) == high) - face[0][u]) +
          slopes[1] * (side(v, (slopes[1] > 0.0) == high) - face[0][v]);
      };
      const double low = std::max(getHeight(false), box.Min[k]);
      const double high = std::min(getHeight(true), box.Max[k]);
      const double last = low <= high ? getLast(k, high) : -std::numeric_limits<double>::infinity();
      for (cell[k] = getFirst(k, low); cell[k] <= last; ++cell[k])
      {
        cells.Add(static_cast<std::int64_t>(cell.x), static_cast<std::int64_t>(cell.y),
          static_cast<std::int64_t>(cell.z));
      }
    }
  }
}

bool IsLess(const glm::dvec3& a, const glm::dvec3& b)
{
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// A face of a tetrahedron, by the places of its nodes at rest in ascending order.
struct Face
{
  Triangle Places;
  bool IsAbove; // on which side of it the tetrahedron lies

  bool operator<(const Face& other) const
  {
    return std::lexicographical_compare(
      this->Places.begin(), this->Places.end(), other.Places.begin(), other.Places.end(), IsLess);
  }
};

// face: as FaceNeighbours numbers them.
Face GetFace(std::size_t face, const std::vector<glm::dvec3>& points,
  const std::vector<Tetrahedron>& tetrahedra)
{
  const Tetrahedron& nodes = tetrahedra[face / 4];
  Face found;
  for (std::size_t i = 0, k = 0; k < 4; ++k)
  {
    if (k != face % 4)
    {
      found.Places[i++] = points[static_cast<std::size_t>(nodes[k])];
    }
  }
  std::sort(found.Places.begin(), found.Places.end(), IsLess);
  const Triangle& q = found.Places;
  found.IsAbove = glm::dot(glm::cross(q[1] - q[0], q[2] - q[0]),
                    points[static_cast<std::size_t>(nodes[face % 4])] - q[0]) > 0.0;
  return found;
}

// The faces that have tetrahedra on one side only. Those that have nodes in common are found first,
// as they are nearly all. tetrahedra: none is flat.
std::vector<Triangle> FindBoundaryFaces(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra)
{
  const FaceNeighbours neighbours(tetrahedra, points.size());
  constexpr std::size_t step = 65536;
  std::vector<std::vector<Face>> parts((neighbours.GetNumberOfFaces() + step - 1) / step);
  ParallelForParts(neighbours.GetNumberOfFaces(), step,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t face = begin; face < end; ++face)
      {
        const std::size_t next = neighbours.GetNext(face);
        const Face here = GetFace(face, points, tetrahedra);
        // More than two in one place may be anything.
        if (next == face || !neighbours.IsShared(face) ||
          GetFace(next, points, tetrahedra).IsAbove == here.IsAbove)
        {
          parts[begin / step].push_back(here);
        }
      }
    });
  std::vector<Face> faces;
  for (const std::vector<Face>& part : parts)
  {
    faces.insert(faces.end(), part.begin(), part.end());
  }
  // Where the mesh is split, or its parts were never joined, faces of different nodes are in one
  // place.
  std::sort(faces.begin(), faces.end());
  std::vector<Triangle> single;
  for (std::size_t i = 0; i < faces.size();)
  {
    std::size_t end = i;
    bool isOnBoth = false;
    for (; end < faces.size() && faces[end].Places == faces[i].Places; ++end)
    {
      isOnBoth = isOnBoth || faces[end].IsAbove != faces[i].IsAbove;
    }
    if (!isOnBoth)
    {
      single.push_back(faces[i].Places);
    }
    i = end;
  }
  return single;
}

// Gives a piece a positive volume at rest.
void Orient(MeshBoundary::Piece& piece)
{
  const std::array<glm::dvec3, 4>& q = piece.Rest;
  if (glm::dot(q[1] - q[0], glm::cross(q[2] - q[0], q[3] - q[0])) < 0.0)
  {
    std::swap(piece.Rest[2], piece.Rest[3]);
    std::swap(piece.Weights[2], piece.Weights[3]);
  }
}

// Finds which cells the faces of a boundary cross, and collects the pieces that meet these.
class BoundaryFinder
{
public:
  BoundaryFinder(const Extent& part, const Extent& whole)
    : Whole(whole)
    , Cells(GetCells(part))
    , Crossed(Widen(this->Cells, GetCells(whole)))
    , Near(this->Cells)
  {
  }

  // Returns whether any cell is crossed. tolerance: see AddCells.
  bool Cross(const std::vector<Triangle>& faces, double tolerance)
  {
    ParallelForParts(faces.size(), 256,
      [&](std::size_t begin, std::size_t end)
      {
        for (std::size_t i = begin; i < end; ++i)
        {
          AddCells(faces[i], this->Whole, tolerance, this->Crossed);
        }
      });
    const Extent& c = this->Cells;
    this->Crossed.ForEach(
      [&](std::int64_t x, std::int64_t y, std::int64_t z)
      {
        for (std::int64_t k = std::max<std::int64_t>(z - 1, c[4]);
             k <= std::min<std::int64_t>(z + 1, c[5]); ++k)
        {
          for (std::int64_t j = std::max<std::int64_t>(y - 1, c[2]);
               j <= std::min<std::int64_t>(y + 1, c[3]); ++j)
          {
            for (std::int64_t i = std::max<std::int64_t>(x - 1, c[0]);
                 i <= std::min<std::int64_t>(x + 1, c[1]); ++i)
            {
              this->Near.Add(i, j, k);
            }
          }
        }
      });
    return !this->Near.IsEmpty();
  }

  template <typename Take>
  void ForEachNear(Take&& take) const
  {
    this->Near.ForEach(take);
  }

  // Adds a piece, or of a large one the parts, that meet cells near the boundary.
  void Add(const MeshBoundary::Piece& piece, std::vector<MeshBoundary::Piece>& pieces) const
  {
    VoxelBox box;
    double size = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto ends = std::minmax(
        { piece.Rest[0][axis], piece.Rest[1][axis], piece.Rest[2][axis], piece.Rest[3][axis] });
      const double low = std::floor(ends.first - Tolerance);
      const double high = std::floor(ends.second + Tolerance);
      if (!(low <= this->Cells[2 * axis + 1] && high >= this->Cells[2 * axis]))
      {
        return;
      }
      box.Min[axis] = std::max<std::int64_t>(
        static_cast<std::int64_t>(std::max(low, -4.0e9)), this->Cells[2 * axis]);
      box.Max[axis] = std::min<std::int64_t>(
        static_cast<std::int64_t>(std::min(high, 4.0e9)), this->Cells[2 * axis + 1]);
      size = std::max(size, ends.second - ends.first);
    }
    if (!this->Near.HasAny(box))
    {
      return;
    }
    if (size <= LargestPiece)
    {
      pieces.push_back(piece);
      return;
    }
    for (const MeshBoundary::Piece& part : Divide(piece))
    {
      this->Add(part, pieces);
    }
  }

  // Puts the cells into a boundary.
  void Finish(MeshBoundary& boundary) const
  {
    const Extent& c = this->Cells;
    const auto list = [&](const CellSet& cells, std::vector<std::int64_t>& numbers)
    {
      cells.ForEach(
        [&](std::int64_t x, std::int64_t y, std::int64_t z)
        {
          if (x >= c[0] && x <= c[1] && y >= c[2] && y <= c[3] && z >= c[4] && z <= c[5])
          {
            numbers.push_back(((z - c[4]) * GetSize(c, 1) + y - c[2]) * GetSize(c, 0) + x - c[0]);
          }
        });
    };
    list(this->Crossed, boundary.Crossed);
    list(this->Near, boundary.Near);
  }

private:
  // Cells of a part and those beside them, in which the boundary decides as in these.
  static Extent Widen(const Extent& cells, const Extent& whole)
  {
    Extent wide;
    for (int axis = 0; axis < 3; ++axis)
    {
      wide[2 * axis] = std::max(cells[2 * axis] - 1, whole[2 * axis]);
      wide[2 * axis + 1] = std::min(cells[2 * axis + 1] + 1, whole[2 * axis + 1]);
    }
    return wide;
  }

  // The eight parts of a piece between its corners and the middles of its edges.
  static std::array<MeshBoundary::Piece, 8> Divide(const MeshBoundary::Piece& piece)
  {
    // Each corner of a part as the middle between two corners of the piece. The octahedron is split
    // along the diagonal from the middle of edge 0 2 to that of edge 1 3.
    static constexpr int parts[8][4][2] = { { { 0, 0 }, { 0, 1 }, { 0, 2 }, { 0, 3 } },
      { { 0, 1 }, { 1, 1 }, { 1, 2 }, { 1, 3 } }, { { 0, 2 }, { 1, 2 }, { 2, 2 }, { 2, 3 } },
      { { 0, 3 }, { 1, 3 }, { 2, 3 }, { 3, 3 } }, { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 3 } },
      { { 0, 1 }, { 0, 2 }, { 1, 3 }, { 1, 2 } }, { { 0, 2 }, { 0, 3 }, { 1, 3 }, { 2, 3 } },
      { { 0, 2 }, { 1, 2 }, { 2, 3 }, { 1, 3 } } };
    std::array<MeshBoundary::Piece, 8> divided;
    for (std::size_t part = 0; part < 8; ++part)
    {
      MeshBoundary::Piece& target = divided[part];
      target.Tetrahedron = piece.Tetrahedron;
      for (std::size_t corner = 0; corner < 4; ++corner)
      {
        const auto a = static_cast<std::size_t>(parts[part][corner][0]);
        const auto b = static_cast<std::size_t>(parts[part][corner][1]);
        target.Rest[corner] = 0.5 * (piece.Rest[a] + piece.Rest[b]);
        for (std::size_t k = 0; k < 4; ++k)
        {
          target.Weights[corner][k] = 0.5F * (piece.Weights[a][k] + piece.Weights[b][k]);
        }
      }
      Orient(target);
    }
    return divided;
  }

  Extent Whole;
  Extent Cells;
  CellSet Crossed;
  CellSet Near;
};

// Calls add(number, pieces) for numbers of a range, in parallel, and joins the pieces in the order
// of the numbers.
template <typename Add>
std::vector<MeshBoundary::Piece> CollectPieces(std::size_t numbers, Add&& add)
{
  constexpr std::size_t step = 4096;
  std::vector<std::vector<MeshBoundary::Piece>> parts((numbers + step - 1) / step);
  ParallelForParts(numbers, step,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        add(i, parts[begin / step]);
      }
    });
  std::vector<MeshBoundary::Piece> pieces;
  for (const std::vector<MeshBoundary::Piece>& part : parts)
  {
    pieces.insert(pieces.end(), part.begin(), part.end());
  }
  return pieces;
}

} // namespace

MeshBoundary FindMeshBoundary(const Extent& part, const Extent& whole,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra)
{
  MeshBoundary boundary;
  if (GetNumberOfCells(part) == 0)
  {
    return boundary;
  }
  // Flat tetrahedra hold nothing, and their faces may be in one place.
  std::vector<std::int32_t> numbers;
  std::vector<Tetrahedron> solid;
  for (std::size_t t = 0; t < tetrahedra.size(); ++t)
  {
    BarycentricMap map;
    if (map.SetTetrahedron(tetrahedra[t], restPoints))
    {
      numbers.push_back(static_cast<std::int32_t>(t));
      solid.push_back(tetrahedra[t]);
    }
  }
  BoundaryFinder finder(part, whole);
  if (!finder.Cross(FindBoundaryFaces(restPoints, solid), 0.0))
  {
    return boundary;
  }
  boundary.Pieces = CollectPieces(solid.size(),
    [&](std::size_t t, std::vector<MeshBoundary::Piece>& pieces)
    {
      MeshBoundary::Piece piece;
      piece.Tetrahedron = numbers[t];
      for (std::size_t k = 0; k < 4; ++k)
      {
        piece.Rest[k] = restPoints[static_cast<std::size_t>(solid[t][k])];
        piece.Weights[k] = {};
        piece.Weights[k][k] = 1.0F;
      }
      Orient(piece);
      finder.Add(piece, pieces);
    });
  finder.Finish(boundary);
  return boundary;
}

MeshBoundary FindFieldBoundary(
  const Extent& part, const Extent& whole, const DisplacementField& field)
{
  MeshBoundary boundary;
  const std::array<int, 3>& size = field.Dimensions;
  if (GetNumberOfCells(part) == 0 || std::min({ size[0], size[1], size[2] }) < 2)
  {
    return boundary;
  }
  const auto& m = field.IndexToField;
  const glm::dmat3 toField(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
  const glm::dmat3 toIndex = glm::inverse(toField);
  if (!(std::abs(glm::determinant(toField)) > 0.0))
  {
    return boundary;
  }
  const glm::dvec3 offset(m[3], m[7], m[11]);
  const auto place = [&](const glm::dvec3& point) { return toIndex * (point - offset); };

  // Two triangles on each side of the field.
  std::vector<Triangle> faces;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int side = 0; side < 2; ++side)
    {
      std::array<glm::dvec3, 4> corners;
      for (int corner = 0; corner < 4; ++corner)
      {
        glm::dvec3 point;
        point[axis] = side * (size[static_cast<std::size_t>(axis)] - 1);
        point[(axis + 1) % 3] = (corner & 1) * (size[static_cast<std::size_t>((axis + 1) % 3)] - 1);
        point[(axis + 2) % 3] =
          (corner >> 1) * (size[static_cast<std::size_t>((axis + 2) % 3)] - 1);
        corners[static_cast<std::size_t>(corner)] = place(point);
      }
      faces.push_back({ { corners[0], corners[1], corners[2] } });
      faces.push_back({ { corners[3], corners[1], corners[2] } });
    }
  }
  BoundaryFinder finder(part, whole);
  // Where a side of the field lies on voxels, cells end there by themselves: kernels take voxels
  // that lie by 1/1000 of a cell of the field outside it for voxels in it.
  const double finest =
    std::min({ glm::length(toIndex[0]), glm::length(toIndex[1]), glm::length(toIndex[2]) });
  if (!finder.Cross(faces, std::min(BorderTolerance, 0.5e-3 * finest)))
  {
    return boundary;
  }

  // A lattice with cells that are about as large as a piece is to be: parts of the field's cells,
  // or several of these.
  static constexpr int split[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;
  glm::dvec3 step; // from cell to cell of the lattice, in points of the field
  glm::i64vec3 cells;
  glm::dvec3 last;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = glm::length(toIndex[axis]);
    step[axis] = length > FieldPiece ? 1.0 / std::round(length / FieldPiece)
                                     : std::max(1.0, std::floor(FieldPiece / length));
    last[axis] = size[static_cast<std::size_t>(axis)] - 1;
    cells[axis] =
      std::max<std::int64_t>(1, std::llround(std::ceil(last[axis] / step[axis] - 1e-9)));
  }
  // Those that meet cells near the boundary.
  std::vector<std::int64_t> numbers;
  finder.ForEachNear(
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    {
      const glm::dvec3 middle = (toField * (glm::dvec3(x, y, z) + 0.5) + offset) / step;
      const glm::dvec3 reach = (0.5 + Tolerance) *
        (glm::abs(toField[0]) + glm::abs(toField[1]) + glm::abs(toField[2])) / step;
      const glm::i64vec3 first(
        glm::clamp(glm::floor(middle - reach), glm::dvec3(0.0), glm::dvec3(cells)));
      const glm::i64vec3 end(
        glm::clamp(glm::floor(middle + reach) + 1.0, glm::dvec3(0.0), glm::dvec3(cells)));
      for (std::int64_t k = first.z; k < end.z; ++k)
      {
        for (std::int64_t j = first.y; j < end.y; ++j)
        {
          for (std::int64_t i = first.x; i < end.x; ++i)
          {
            numbers.push_back((k * cells.y + j) * cells.x + i);
          }
        }
      }
    });
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  boundary.Pieces = CollectPieces(numbers.size(),
    [&](std::size_t number, std::vector<MeshBoundary::Piece>& pieces)
    {
      const std::int64_t i = numbers[number];
      const glm::i64vec3 cell(i % cells.x, i / cells.x % cells.y, i / cells.x / cells.y);
      std::array<glm::dvec3, 8> points;
      for (int vertex = 0; vertex < 8; ++vertex)
      {
        const glm::i64vec3 odd = cell & std::int64_t{ 1 };
        const glm::i64vec3 corner =
          cell + (glm::i64vec3(vertex & 1, vertex >> 2 & 1, vertex >> 1 & 1) ^ odd);
        points[static_cast<std::size_t>(vertex)] = glm::min(glm::dvec3(corner) * step, last);
      }
      for (const auto& tetrahedron : split)
      {
        MeshBoundary::Piece piece;
        piece.Tetrahedron = 0;
        for (std::size_t k = 0; k < 4; ++k)
        {
          const glm::dvec3& point = points[static_cast<std::size_t>(tetrahedron[k])];
          piece.Rest[k] = place(point);
          piece.Weights[k] = { { static_cast<float>(point.x), static_cast<float>(point.y),
            static_cast<float>(point.z), 0.0F } };
        }
        Orient(piece);
        finder.Add(piece, pieces);
      }
    });
  finder.Finish(boundary);
  return boundary;
}

} // namespace deformvolume
