// SPDX-License-Identifier: BSD-3-Clause
// An independent implementation of mesh rasterization on the host. It tests every tetrahedron of
// the deformation mesh against every voxel of its bounding box, with inside tests in 128-bit
// integers and rest coordinates in extended precision. It shares nothing with the kernels.
#ifndef RasterReference_h
#define RasterReference_h

#include "RasterCase.h"

#include <array>
#include <vector>

namespace reference
{

/// The expected voxel of the output.
struct RasterVoxel
{
  bool Covered = false;
  /// A decision depends on rounding errors: both results are right.
  bool Uncertain = false;
  int Tetrahedron = -1;
  /// The continuous index, counted from the first voxel of the volume.
  std::array<long double, 3> Rest{};
};

struct RasterResult
{
  std::vector<RasterVoxel> Voxels;
  std::int64_t NumberOfInvertedTetrahedra = 0;
  /// Voxels strictly inside more than one tetrahedron.
  std::int64_t NumberOfOverlappedVoxels = 0;
};

/// cubic: blanked voxels have an effect on the wider support of cubic interpolation.
RasterResult Rasterize(const RasterCase& rasterCase, bool cubic = false);

/// The voxels that an interpolation at a rest coordinate uses, by index in the volume, and their
/// weights.
std::vector<std::pair<std::int64_t, long double>> GetWeights(
  const deformvolume::Extent& volume, const std::array<long double, 3>& rest, bool cubic);

} // namespace reference

#endif
