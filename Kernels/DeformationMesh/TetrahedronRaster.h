// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedronRaster_h
#define DeformVolumeTetrahedronRaster_h

#include <algorithm>
#include <array>
#include <cstdint>

namespace deformvolume
{

/// Positions are rounded to multiples of 2^-RasterBits voxel, so that the edge functions are exact.
constexpr int RasterBits = 8;
/// Raster units per voxel.
constexpr std::int64_t RasterUnit = std::int64_t{ 1 } << RasterBits;

/// A box of voxels. Both ends belong to the box.
struct VoxelBox
{
  /// The first voxel on each axis.
  std::array<std::int64_t, 3> Min{ { 0, 0, 0 } };
  /// The last voxel on each axis.
  std::array<std::int64_t, 3> Max{ { -1, -1, -1 } };
  /// Whether the box has no voxel.
  bool IsEmpty() const
  {
    return this->Min[0] > this->Max[0] || this->Min[1] > this->Max[1] ||
      this->Min[2] > this->Max[2];
  }
};

/// A position in raster units.
using RasterPoint = std::array<std::int64_t, 3>;

/// Rounds a continuous index to the nearest raster unit. Returns raster units.
inline std::int64_t RoundToRaster(double index)
{
  const double scaled = index * static_cast<double>(RasterUnit);
  return static_cast<std::int64_t>(scaled < 0.0 ? scaled - 0.5 : scaled + 0.5);
}

/// Finds the voxels in a tetrahedron and on its surface, by the signs of four affine edge
/// functions, one per face, in integer arithmetic. Integer: a type that represents their values
/// exactly (see FitsInt64()).
template <typename Integer>
class TetrahedronRaster
{
public:
  /// Set the tetrahedron. nodes: of either orientation. box: the voxels to search, which must lie
  /// in the bounding box of the nodes. Returns false if the rounded tetrahedron has no volume.
  bool SetTetrahedron(const std::array<RasterPoint, 4>& nodes, const VoxelBox& box)
  {
    this->Box = box;
    Integer local[4][3];
    for (int node = 0; node < 4; ++node)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        local[node][axis] = static_cast<Integer>(nodes[node][axis] - box.Min[axis] * RasterUnit);
      }
    }
    Integer sides[3][3];
    for (int side = 0; side < 3; ++side)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        sides[side][axis] = local[side + 1][axis] - local[0][axis];
      }
    }
    Integer normals[4][3];
    for (int face = 0; face < 3; ++face)
    {
      const Integer* u = sides[(face + 1) % 3];
      const Integer* v = sides[(face + 2) % 3];
      normals[face][0] = u[1] * v[2] - u[2] * v[1];
      normals[face][1] = u[2] * v[0] - u[0] * v[2];
      normals[face][2] = u[0] * v[1] - u[1] * v[0];
    }
    const Integer determinant = Dot(sides[0], normals[0]);
    if (determinant == 0)
    {
      return false;
    }
    const Integer sign = determinant > 0 ? 1 : -1;
    for (int axis = 0; axis < 3; ++axis)
    {
      normals[3][axis] = -(normals[0][axis] + normals[1][axis] + normals[2][axis]);
    }

    // Order the faces: first faces that bound a row from below, then faces that bound a row from
    // above, then faces parallel to rows.
    int order[4];
    int count = 0;
    for (int kind = 0; kind < 3; ++kind)
    {
      for (int face = 0; face < 4; ++face)
      {
        const Integer slope = sign * normals[face][0];
        if (kind == 0 ? slope > 0 : (kind == 1 ? slope < 0 : slope == 0))
        {
          order[count++] = face;
        }
      }
      this->End[kind] = count;
    }
    for (int index = 0; index < 4; ++index)
    {
      const Integer* normal = normals[order[index]];
      this->Start[index] =
        sign * ((order[index] == 3 ? determinant : Integer(0)) - Dot(normal, local[0]));
      for (int axis = 0; axis < 3; ++axis)
      {
        this->Steps[index][axis] = sign * normal[axis] * RasterUnit;
      }
      if (index < this->End[1])
      {
        this->Inverse[index] = -1.0 / static_cast<double>(this->Steps[index][0]);
      }
    }
    return true;
  }

  /// Calls row(y, z, first x, last x) for each row that has voxels in the tetrahedron.
  template <typename Row>
  void ForEachRow(Row&& row) const
  {
    const std::int64_t last = this->Box.Max[0] - this->Box.Min[0];
    Integer slice[4];
    std::copy(this->Start, this->Start + 4, slice);
    for (std::int64_t z = this->Box.Min[2]; z <= this->Box.Max[2]; ++z)
    {
      Integer values[4];
      std::copy(slice, slice + 4, values);
      for (std::int64_t y = this->Box.Min[1]; y <= this->Box.Max[1]; ++y)
      {
        std::int64_t begin = 0;
        std::int64_t end = last;
        if (this->FindInterval(values, begin, end))
        {
          row(y, z, this->Box.Min[0] + begin, this->Box.Min[0] + end);
        }
        for (int index = 0; index < 4; ++index)
        {
          values[index] += this->Steps[index][1];
        }
      }
      for (int index = 0; index < 4; ++index)
      {
        slice[index] += this->Steps[index][2];
      }
    }
  }

private:
  static Integer Dot(const Integer* u, const Integer* v)
  {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  }

  bool FindInterval(const Integer* values, std::int64_t& begin, std::int64_t& end) const
  {
    for (int index = this->End[1]; index < this->End[2]; ++index)
    {
      if (values[index] < 0)
      {
        return false;
      }
    }
    // The quotient in double precision may be off by one. The exact edge function corrects it.
    for (int index = this->End[0]; index < this->End[1]; ++index)
    {
      if (values[index] < 0)
      {
        return false;
      }
      const double root = static_cast<double>(values[index]) * this->Inverse[index];
      if (root <= static_cast<double>(end))
      {
        const Integer step = this->Steps[index][0];
        std::int64_t x = static_cast<std::int64_t>(root) + 1;
        while (values[index] + step * x < 0)
        {
          --x;
        }
        end = std::min(end, x);
      }
    }
    for (int index = 0; index < this->End[0]; ++index)
    {
      if (values[index] < 0)
      {
        const double root = static_cast<double>(values[index]) * this->Inverse[index];
        if (root > static_cast<double>(end + 1))
        {
          return false;
        }
        const Integer step = this->Steps[index][0];
        std::int64_t x = static_cast<std::int64_t>(root);
        while (values[index] + step * x < 0)
        {
          ++x;
        }
        begin = std::max(begin, x);
      }
    }
    return begin <= end;
  }

  VoxelBox Box;
  int End[3] = { 0, 0, 0 };
  Integer Start[4];
  Integer Steps[4][3];
  double Inverse[4];
};

/// Whether 64 bits are enough for the edge functions of a tetrahedron and all intermediate sums.
/// These are sums of at most 18 terms of size e^3, where e is the longest edge of its bounding box.
/// min, max: the bounding box.
inline bool FitsInt64(const RasterPoint& min, const RasterPoint& max)
{
  constexpr std::int64_t largest = 790000; // 18 * 790000^3 < 2^63
  return std::max({ max[0] - min[0], max[1] - min[1], max[2] - min[2] }) <= largest;
}

/// The integer type for larger tetrahedra. Large enough for bounding boxes of up to 2^32 voxels.
__extension__ typedef __int128 WideInteger;

} // namespace deformvolume

#endif
