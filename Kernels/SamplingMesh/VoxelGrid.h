// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVoxelGrid_h
#define DeformVolumeVoxelGrid_h

#include "Extent.h"

#include <array>
#include <cstddef>

namespace deformvolume
{

/// Takes structured indices of a volume to continuous indices of the output.
struct OutputMap
{
  /// Row-major 3 x 3: the step in the output from voxel to voxel. It may turn, mirror and scale,
  /// but has an inverse.
  std::array<double, 9> Matrix{ { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 } };
  /// Where the index (0, 0, 0) lies.
  std::array<double, 3> Shift{ { 0.0, 0.0, 0.0 } };

  OutputMap() = default;
  /// The axes are the same: steps are the ratios of the volume's spacing to the output's.
  OutputMap(const std::array<double, 3>& scale)
    : Matrix{ { scale[0], 0.0, 0.0, 0.0, scale[1], 0.0, 0.0, 0.0, scale[2] } }
  {
  }

  /// An element of Matrix.
  double Get(int row, int column) const
  {
    return this->Matrix[static_cast<std::size_t>(3 * row + column)];
  }
  /// Whether each axis of the volume is one of the output.
  bool IsDiagonal() const
  {
    bool diagonal = true;
    for (int element = 0; element < 9; ++element)
    {
      diagonal = diagonal && (element % 4 == 0 || this->Get(0, element) == 0.0);
    }
    return diagonal;
  }
  /// Less than zero: the output is a mirror image of the volume.
  double GetDeterminant() const
  {
    const std::array<double, 9>& m = this->Matrix;
    return m[0] * (m[4] * m[8] - m[5] * m[7]) + m[1] * (m[5] * m[6] - m[3] * m[8]) +
      m[2] * (m[3] * m[7] - m[4] * m[6]);
  }
  /// Whether matrix and shift are equal.
  bool operator==(const OutputMap& other) const
  {
    return this->Matrix == other.Matrix && this->Shift == other.Shift;
  }
  /// Whether one of them differs.
  bool operator!=(const OutputMap& other) const { return !(*this == other); }
};

/// The voxels of a volume at rest, which are the vertices of the implicit sampling mesh, and where
/// they lie in the output.
struct VoxelGrid
{
  /// Structured indices of the voxels. Their parity decides the 5T split.
  Extent VertexExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// Where they lie in the output. By default volume and output share their indices.
  OutputMap ToOutput;
  /// Structured indices of the volume that the voxels are a part of; empty: they are all of it.
  /// Voxels of a part are displaced as in the whole, to the last bit.
  Extent WholeExtent{ { 0, -1, 0, -1, 0, -1 } };
};

/// Structured indices of the whole volume, whether the voxels are a part of it or all of it.
inline const Extent& GetWholeExtent(const VoxelGrid& grid)
{
  return GetNumberOfPoints(grid.WholeExtent) > 0 ? grid.WholeExtent : grid.VertexExtent;
}

} // namespace deformvolume

#endif
