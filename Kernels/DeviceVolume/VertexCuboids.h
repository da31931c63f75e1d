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

/// The cuboids of vertices that kernels work on a chunk in which look only at a part of it
/// (VertexState.cl has their numbers).
class VertexCuboids
{
public:
  /// p: the parameters of a chunk.
  explicit VertexCuboids(const KernelParameters& p);

  static constexpr std::size_t NumberOfVertices =
    std::size_t{ DEFORMVOLUME_CUBOID_X } * DEFORMVOLUME_CUBOID_Y * DEFORMVOLUME_CUBOID_Z;

  std::vector<cl_uint> GetAll() const;
  /// Those with a vertex in some boxes, or so many beyond them; in ascending order.
  std::vector<cl_uint> Find(const std::vector<Extent>& boxes, int halo) const;
  /// Local indices of the cells whose first vertex a cuboid has.
  Extent GetCells(cl_uint cuboid) const;

  /// So many are worked on at once.
  static constexpr std::size_t AtOnce = 4096;
  /// Goes through a list of them, some at a time, which are written to the buffer `list`: run is
  /// given what launches a kernel over them, where they begin and how many they are.
  using Launch = std::function<void(const cl::Kernel& kernel)>;
  static void ForAll(OpenCLContext& context, const cl::CommandQueue& queue,
    const std::vector<cl_uint>& cuboids, const cl::Buffer& list,
    const std::function<void(const Launch& launch, std::size_t begin, std::size_t count)>& run);

private:
  std::array<int, 3> First; // local index of the chunk's first vertex on each axis
  std::array<int, 3> End;   // and one past the last
  std::array<std::int64_t, 3> Count;
};

/// Two lists joined, each number once, in ascending order.
std::vector<cl_uint> JoinLists(const std::vector<cl_uint>& a, const std::vector<cl_uint>& b);

} // namespace deformvolume

#endif
