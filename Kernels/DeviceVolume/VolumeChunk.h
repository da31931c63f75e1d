// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeChunk_h
#define DeformVolumeVolumeChunk_h

#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A range of cell layers of the sampling mesh with the vertex planes that they and their
/// neighbours need: a volume over the device's allocation limit is held in several.
struct VolumeChunk
{
  int LayersBegin = 0; // cells, local z
  int LayersEnd = 0;
  int PlanesBegin = 0; // vertices, local z: one or two planes more than the cells have on each side
  int PlanesEnd = 0;
  cl::Buffer Links;     // one a voxel, or else runs
  cl::Buffer Runs;      // those of the rows of the planes
  cl::Buffer RowRanges; // of each row the first of its runs, and one past the last: 4 bytes each
  cl::Buffer State;
  cl::Buffer Blanked;
  cl::Buffer Active;
  cl::Buffer Distances;           // to the boundary, a float a voxel
  cl::Buffer Boundary;            // where that of the deformation mesh is (BridgeMask.cl), or none
  cl::Buffer Joined;              // the active tetrahedra that are resampled (BridgeMask), or none
  std::vector<cl::Buffer> Arrays; // see DeviceArrays::GetBuffers
};

/// Layers of an array of the host: planes of voxels or of cells.
struct HostLayers
{
  const void* Data;
  std::size_t BytesPerElement;
  std::int64_t ElementsPerLayer;
  std::int64_t Begin; // the first layer, and one past the last
  std::int64_t End;
};

/// Sends layers to a buffer: to the previous one if that has their size. The data must stay until
/// the queue has finished.
cl::Buffer SendLayers(const OpenCLContext& context, const cl::CommandQueue& queue,
  std::uint64_t allocationLimit, const HostLayers& layers, const cl::Buffer& previous);

} // namespace deformvolume

#endif
