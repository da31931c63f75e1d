// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorConversion_h
#define DeformVolumeVectorConversion_h

#include "DeformVolumeExport.h"
#include "ImageGeometry.h"
#include "VoxelGrid.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace deformvolume
{

/// Returns the matrix that converts vectors in world units, times a factor, to displacements in
/// output voxels. Its elements are rounded (RoundFactor), so that the host and all devices compute
/// the same displacements.
DEFORMVOLUME_EXPORT glm::dmat3 GetToDisplacement(
  const ImageGeometry& volume, const OutputMap& toOutput, double factor);

/// Returns the elements of a matrix in row-major order.
inline std::array<double, 9> GetRows(const glm::dmat3& matrix)
{
  std::array<double, 9> rows;
  for (int i = 0; i < 9; ++i)
  {
    rows[static_cast<std::size_t>(i)] = matrix[i % 3][i / 3];
  }
  return rows;
}

/// Receives the vectors with the indices first to first + count - 1. Called in parallel.
using VectorTaker =
  std::function<void(std::int64_t first, const glm::dvec3* vectors, std::int64_t count)>;

/// Throws an Error that says that a displacement is over LargestDisplacement.
[[noreturn]] DEFORMVOLUME_EXPORT void ThrowTooFar();

/// Converts `count` vectors to displacements of three floats each. toDisplacement:
/// GetToDisplacement() of the volume. Returns false if a displacement is not finite or exceeds
/// LargestDisplacement.
DEFORMVOLUME_EXPORT bool ConvertVectors(const glm::dmat3& toDisplacement, const glm::dvec3* vectors,
  std::size_t count, float* displacements);

} // namespace deformvolume

#endif
