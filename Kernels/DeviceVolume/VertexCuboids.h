// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVertexCuboids_h
#define DeformVolumeVertexCuboids_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// The cuboids of vertices of a chunk, for kernels that process only a part of the chunk.
/// VertexState.cl describes their numbers.
class VertexCuboids
{
public:
  /// p: the parameters of a chunk.
  explicit VertexCuboids(const KernelParameters& p);

  static constexpr std::size_t NumberOfVertices =
    std::size_t{ DEFORMVOLUME_CUBOID_X } * DEFORMVOLUME_CUBOID_Y * DEFORMVOLUME_CUBOID_Z;

  std::vector<cl_uint> GetAll() const;
  /// Returns the cuboids with a vertex in the boxes, each enlarged by `halo` vertices on each side;
  /// in ascending order.
  std::vector<cl_uint> Find(const std::vector<Extent>& boxes, int halo) const;
  /// Returns the local indices of the vertices of a cuboid.
  Extent GetVertices(cl_uint cuboid) const;
  /// Returns the local indices of the cells that begin at the vertices of a cuboid.
  Extent GetCells(cl_uint cuboid) const;

  /// Largest number of cuboids in a launch.
  static constexpr std::size_t AtOnce = 4096;
  /// Processes a list of cuboids, at most AtOnce at a time. Writes the next cuboids to the buffer
  /// `list`, and calls run(launch, begin, count). begin: index of the first of them in `cuboids`.
  /// count: number of cuboids in the buffer. launch(kernel) launches a kernel over these cuboids.
  using Launch = std::function<void(const cl::Kernel& kernel)>;
  static void ForAll(OpenCLContext& context, const cl::CommandQueue& queue,
    const std::vector<cl_uint>& cuboids, const cl::Buffer& list,
    const std::function<void(const Launch& launch, std::size_t begin, std::size_t count)>& run);

private:
  std::array<int, 3> First; // local index of the first vertex of the chunk on each axis
  std::array<int, 3> End;   // one past the last vertex of the chunk on each axis
  std::array<std::int64_t, 3> Count;
};

/// Returns the union of two sorted lists, in ascending order.
std::vector<cl_uint> JoinLists(const std::vector<cl_uint>& a, const std::vector<cl_uint>& b);

} // namespace deformvolume

#endif
