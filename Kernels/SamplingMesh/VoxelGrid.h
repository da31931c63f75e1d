// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVoxelGrid_h
#define DeformVolumeVoxelGrid_h

#include "Extent.h"

#include <array>
#include <cstddef>

namespace deformvolume
{

/// Affine map from structured indices of a volume to continuous indices of the output.
struct OutputMap
{
  /// Row-major 3 x 3 matrix: column k is the step in the output between neighboring voxels on axis
  /// k. It may rotate, reflect, shear and scale, but must be invertible.
  std::array<double, 9> Matrix{ { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 } };
  /// Position of the index (0, 0, 0) in the output.
  std::array<double, 3> Shift{ { 0.0, 0.0, 0.0 } };

  OutputMap() = default;
  /// A map for parallel axes. scale: ratio of the spacing of the volume to that of the output.
  OutputMap(const std::array<double, 3>& scale)
    : Matrix{ { scale[0], 0.0, 0.0, 0.0, scale[1], 0.0, 0.0, 0.0, scale[2] } }
  {
  }

  /// An element of Matrix.
  double Get(int row, int column) const
  {
    return this->Matrix[static_cast<std::size_t>(3 * row + column)];
  }
  /// Whether each axis of the volume is parallel to the same axis of the output.
  bool IsDiagonal() const
  {
    bool diagonal = true;
    for (int element = 0; element < 9; ++element)
    {
      diagonal = diagonal && (element % 4 == 0 || this->Get(0, element) == 0.0);
    }
    return diagonal;
  }
  /// Determinant of Matrix. Negative: the output is a mirror image of the volume.
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
  /// Whether matrix or shift differs.
  bool operator!=(const OutputMap& other) const { return !(*this == other); }
};

/// The voxels of a volume at rest, which are the vertices of the implicit sampling mesh, and the
/// map from voxels to the output.
struct VoxelGrid
{
  /// Structured indices of the voxels. Their parity decides the 5T split.
  Extent VertexExtent = EmptyExtent;
  /// Map to indices of the output. Default: the identity.
  OutputMap ToOutput;
  /// Extent of the whole volume, if the voxels are a part of it. Default: empty, which means that
  /// the voxels are the whole volume. The displacements of a part are bitwise equal to those of the
  /// whole.
  Extent WholeExtent = EmptyExtent;
};

/// Returns the extent of the whole volume: WholeExtent, or VertexExtent if that is empty.
inline const Extent& GetWholeExtent(const VoxelGrid& grid)
{
  return GetNumberOfPoints(grid.WholeExtent) > 0 ? grid.WholeExtent : grid.VertexExtent;
}

} // namespace deformvolume

#endif
