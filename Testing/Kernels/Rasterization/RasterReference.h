// SPDX-License-Identifier: BSD-3-Clause
// The mesh rasterisation done once more on the host: every tetrahedron of the deformation mesh
// against every voxel of its box, inside tests in integers of 128 bits, rest coordinates in
// extended precision. It shares nothing with the kernels.
#ifndef RasterReference_h
#define RasterReference_h

#include "RasterCase.h"

#include <array>
#include <vector>

namespace reference
{

/// What a voxel of the output ought to be.
struct RasterVoxel
{
  bool Covered = false;
  /// A decision hangs on less than what arithmetic costs: either outcome is right.
  bool Uncertain = false;
  int Tetrahedron = -1;
  /// Index from the volume's first voxel.
  std::array<long double, 3> Rest{};
};

struct RasterResult
{
  std::vector<RasterVoxel> Voxels;
  std::int64_t NumberOfInvertedTetrahedra = 0;
  /// Voxels strictly inside more than one tetrahedron.
  std::int64_t NumberOfOverlappedVoxels = 0;
};

/// cubic: blanked voxels then count over the wider support.
RasterResult Rasterize(const RasterCase& rasterCase, bool cubic = false);

/// Weights of the voxels that an interpolation at a rest coordinate uses, by index in the volume.
std::vector<std::pair<std::int64_t, long double>> GetWeights(
  const deformvolume::Extent& volume, const std::array<long double, 3>& rest, bool cubic);

} // namespace reference

#endif
