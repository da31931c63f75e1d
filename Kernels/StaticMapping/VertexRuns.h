// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVertexRuns_h
#define DeformVolumeVertexRuns_h

#include "DeformVolumeExport.h"
#include "VoxelGrid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A run of voxels of a row, along x, in one tetrahedron; 8 bytes. It ends where the next run of
/// its row begins, the last one at the end of the row.
struct VertexRun
{
  /// Index into VertexRuns::Tetrahedra, or -1 outside the deformation mesh.
  std::int32_t Tetrahedron = -1;
  /// Local x index of its first voxel: counted from the first voxel.
  std::int32_t Begin = 0;
};

/// Where a tetrahedron of the deformation mesh lies at rest: weight k < 3 of the voxel with local
/// index v is Weights[k] + dot(Gradients[k], v - Origin). In doubles: the displacements of the
/// nodes make small numbers of the large gradients of a thin tetrahedron.
struct RestTetrahedron
{
  /// Local index of a voxel in the tetrahedron.
  std::array<double, 3> Origin{ { 0.0, 0.0, 0.0 } };
  /// The first three weights at Origin.
  std::array<double, 3> Weights{ { 0.0, 0.0, 0.0 } };
  /// How each of these weights changes along the axes, for each voxel.
  std::array<std::array<double, 3>, 3> Gradients{};
  /// Index of the tetrahedron in the deformation mesh.
  std::int32_t Tetrahedron = 0;
};

/// The static mapping where many voxels lie in each tetrahedron: runs instead of a link a voxel.
struct VertexRuns
{
  /// The runs of all rows, one row after the other.
  std::vector<VertexRun> Runs;
  /// The runs of row r = z * (voxels on y) + y, in local indices, are those from RowBegins[r] to
  /// RowBegins[r + 1].
  std::vector<std::uint32_t> RowBegins;
  /// Those that hold voxels; several of them may be one tetrahedron of the mesh.
  std::vector<RestTetrahedron> Tetrahedra;
};

// How exact displacements by runs are. The device rounds an affine function to floats and evaluates
// it in floats: Displacement + ((AlongY y + AlongZ z) + AlongX x), with x, y and z counted from the
// origin, which lies in the tetrahedron, so that displacements there and at the voxel are at most
// the largest one D of its nodes. Four roundings to 24 bits of the first kind (of the coefficient,
// the product and two sums) touch terms that sum up to S = |AlongX x| + |AlongY y| + |AlongZ z|,
// and two (of Displacement and the last sum) such of at most D:
//   error <= 2^-24 (4 S + 2 D), or for the latter two half a unit in the last place, less.
// That is less than 1/1024 output voxel for displacements under 8,192 voxels as long as S is under
// 2,048, and less than 1/512 up to the limit of 16,383. S is bounded by what the tetrahedron's
// nodes move against each other times the greatest value of the sum of |gradient component| times
// extent, which LargestWeightVariation limits.

/// A tetrahedron has one record for all its runs where, for each of its first three weights, the
/// sum over the axes of the size of the weight's derivative times the extent of the tetrahedron
/// within the volume is at most this. Else it is a sliver, and each of its runs gets a record with
/// an origin of its own: along a run weights change by 1 at most.
constexpr double LargestWeightVariation = 32.0;

/// The kernels form differences of indices in floats: no more voxels on an axis.
constexpr std::int64_t LargestRunSize = 1 << 24;

/// Bytes of a mapping by so many runs, rows and records, on the device; the host has about as many.
DEFORMVOLUME_EXPORT std::uint64_t GetRunBytes(
  std::uint64_t runs, std::uint64_t rows, std::uint64_t records);
/// The same of some runs.
DEFORMVOLUME_EXPORT std::uint64_t GetBytes(const VertexRuns& runs);

/// Throws Error unless there is a row of runs for each row of voxels, begins ascend from 0 within
/// the row, and runs and records name records and tetrahedra that are there.
DEFORMVOLUME_EXPORT void CheckRuns(
  const VertexRuns& runs, const VoxelGrid& voxelGrid, std::size_t numberOfTetrahedra);
/// The same of so many rows of so many voxels.
void CheckRuns(
  const VertexRuns& runs, std::size_t rows, std::int64_t rowSize, std::size_t numberOfTetrahedra);

} // namespace deformvolume

#endif
