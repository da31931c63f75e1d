// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceCut_h
#define DeformVolumeDeviceCut_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VolumeChunk.h"
#include "VoxelGrid.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A smooth cut on the device: the list of the vertices of crossed cells, with their distances from
/// the sheet and the positions of their copies on the other side (CutPositions.cl). The memory is
/// proportional to the size of the cut, not of the volume.
class DeviceCut
{
public:
  /// Set the cut. crossed: one byte per cell, bit i: tetrahedron i is crossed; null: no cut.
  /// distances: one float per voxel. Returns bounding boxes of the vertices whose entries have
  /// changed.
  std::vector<Extent> Set(const OpenCLContext& context, const cl::CommandQueue& queue,
    const VoxelGrid& voxelGrid, const unsigned char* crossed, const float* distances);

  /// Whether any cell has crossed tetrahedra.
  bool IsOn() const { return !this->List.empty(); }
  const std::vector<CutVertex>& GetList() const { return this->List; }
  /// Makes the next update compute the stencils, since states or active tetrahedra have changed.
  void InvalidateStencils() { this->StencilsCurrent = false; }

  /// Computes the positions of the copies in a chunk. p: parameters of the chunk. mapping: the
  /// program of the deformation mapping. active: the active tetrahedra; may be null. wanted: for
  /// each brick, whether positions of its vertices may have changed; empty: all may have changed.
  /// If the stencils must be computed, all positions are computed. Call Finish() after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    const VolumeChunk& chunk, const cl::Program& mapping, const MappingSetter& set,
    const cl::Buffer& active, const std::vector<unsigned char>& wanted);
  void Finish() { this->StencilsCurrent = true; }

  ///@{
  /// The buffers for kernels. Null if there is no cut.
  const cl::Buffer& GetRows() const { return this->Rows; }
  const cl::Buffer& GetVertices() const { return this->Vertices; }
  const cl::Buffer& GetPositions() const { return this->Positions; }
  ///@}
  /// Sets the kernel arguments of the cut (CUT_PARAMETERS). argument: index of the first of them.
  /// Returns the index of the next argument.
  cl_uint SetArguments(cl::Kernel& kernel, cl_uint argument) const;

  std::uint64_t GetMemory() const;

private:
  void Send(const OpenCLContext& context, const cl::CommandQueue& queue);

  std::vector<CutVertex> List;
  std::vector<std::uint32_t> RowBegins;
  cl::Buffer Rows;
  cl::Buffer Vertices;
  cl::Buffer Stencils;
  cl::Buffer Positions;
  cl::Buffer Wanted; // a byte per brick
  bool StencilsCurrent = false;
};

} // namespace deformvolume

#endif
