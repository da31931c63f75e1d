// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeChunk_h
#define DeformVolumeVolumeChunk_h

#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// A range of cell layers of the sampling mesh, with the vertex planes that the cells and their
/// neighbors need. A volume that exceeds the allocation limit of the device has several chunks.
struct VolumeChunk
{
  int LayersBegin = 0; // cells, local z
  int LayersEnd = 0;
  int PlanesBegin = 0; // vertices, local z: one or two more planes on each side than the cells have
  int PlanesEnd = 0;
  cl::Buffer Links;     // one per voxel; null if there are runs
  cl::Buffer Runs;      // of the rows of the planes
  cl::Buffer RowRanges; // per row the index of its first run and one past its last, 4 bytes each
  cl::Buffer State;
  cl::Buffer Blanked;
  cl::Buffer Active;
  cl::Buffer Distances;           // boundary distances, a float per voxel
  cl::Buffer Boundary;            // a byte per cell (ResampledMask.cl); may be null
  cl::Buffer ResampledTetrahedra; // a byte per cell, see ResampledMask; may be null
  std::vector<cl::Buffer> Arrays; // see DeviceArrays::GetBuffers()
};

/// Sets the arguments of the deformation mapping for a chunk, which are the first arguments of a
/// kernel. Returns their number.
using MappingSetter = std::function<cl_uint(cl::Kernel& kernel, const VolumeChunk& chunk)>;

/// Layers of an array in host memory: planes of voxels or of cells.
struct HostLayers
{
  const void* Data;
  std::size_t BytesPerElement;
  std::int64_t ElementsPerLayer;
  std::int64_t Begin; // the first layer, and one past the last
  std::int64_t End;
};

/// Copies layers to a buffer. Uses the previous buffer if it has the right size, otherwise a new
/// buffer. The data must stay valid until the queue has finished.
cl::Buffer SendLayers(const OpenCLContext& context, const cl::CommandQueue& queue,
  std::uint64_t allocationLimit, const HostLayers& layers, const cl::Buffer& previous);

} // namespace deformvolume

#endif
