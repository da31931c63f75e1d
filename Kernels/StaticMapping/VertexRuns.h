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

/// A run of voxels along x in one tetrahedron; 8 bytes. It ends where the next run of the row
/// begins, or at the end of the row.
struct VertexRun
{
  /// Index into VertexRuns::Tetrahedra, or -1 outside the deformation mesh.
  std::int32_t Tetrahedron = -1;
  /// Local x index of the first voxel of the run.
  std::int32_t Begin = 0;
};

/// A tetrahedron of the deformation mesh at rest. Weight k < 3 of the voxel with the local index v
/// is Weights[k] + dot(Gradients[k], v - Origin). Double precision is needed since the large
/// gradients of a thin tetrahedron cancel when they are multiplied by displacements and added.
struct RestTetrahedron
{
  /// Local index of a voxel in the tetrahedron.
  std::array<double, 3> Origin{ { 0.0, 0.0, 0.0 } };
  /// The first three weights at Origin.
  std::array<double, 3> Weights{ { 0.0, 0.0, 0.0 } };
  /// The gradients of these weights, per voxel.
  std::array<std::array<double, 3>, 3> Gradients{};
  /// Number of the tetrahedron in the deformation mesh.
  std::int32_t Tetrahedron = 0;
};

/// The static mapping as runs, which need less memory than links if each tetrahedron has many
/// voxels.
struct VertexRuns
{
  /// The runs of all rows, in the order of the rows.
  std::vector<VertexRun> Runs;
  /// The runs of row r = z * (voxels on y) + y, in local indices, are Runs[RowBegins[r]] to
  /// Runs[RowBegins[r + 1] - 1].
  std::vector<std::uint32_t> RowBegins;
  /// The records: tetrahedra that contain voxels. A sliver has one record for each run.
  std::vector<RestTetrahedron> Tetrahedra;
};

// Precision of displacements by runs. The device rounds the coefficients of an affine function to
// floats, and evaluates it in floats: Displacement + ((AlongY y + AlongZ z) + AlongX x). x, y and z
// are relative to the origin, which lies in the tetrahedron. So the displacements at the origin and
// at the voxel are at most D, the largest displacement of its nodes. Four roundings to 24 bits (of
// the coefficient, the product and two sums) affect terms that add up to S = |AlongX x| + |AlongY
// y| + |AlongZ z|. Two roundings (of Displacement and the last sum) affect terms of at most D:
// error <= 2^-24 (4 S + 2 D). The error is less than 1/1024 output voxel if S < 2,048 and
// displacements are under 8,192 voxels. It is less than 1/512 up to the limit of 16,383 voxels. S
// is at most the relative motion of the nodes times the weight variation that
// LargestWeightVariation limits.

/// Largest variation of a weight in a tetrahedron that has one record for all its runs. The
/// variation of a weight is the sum over the axes of |derivative| times the extent of the
/// tetrahedron within the volume. If one of the first three weights exceeds the limit, the
/// tetrahedron is a sliver. Each run of a sliver has a record with its own origin: along a run,
/// weights change by at most 1.
constexpr double LargestWeightVariation = 32.0;

/// Largest number of voxels on an axis. The kernels compute differences of indices in floats, which
/// are exact up to this number.
constexpr std::int64_t LargestRunSize = 1 << 24;

/// Returns the bytes of a mapping by runs on the device. The host needs about as many bytes.
DEFORMVOLUME_EXPORT std::uint64_t GetRunBytes(
  std::uint64_t runs, std::uint64_t rows, std::uint64_t records);
/// Returns the bytes of a mapping by these runs. 0 if there are no rows.
DEFORMVOLUME_EXPORT std::uint64_t GetBytes(const VertexRuns& runs);

/// Throws Error unless each row of voxels has runs that begin in ascending order from 0, and all
/// runs and records refer to records and tetrahedra that exist.
DEFORMVOLUME_EXPORT void CheckRuns(
  const VertexRuns& runs, const VoxelGrid& voxelGrid, std::size_t numberOfTetrahedra);

} // namespace deformvolume

#endif
