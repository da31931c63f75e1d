// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceCut_h
#define DeformVolumeDeviceCut_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VolumeChunk.h"
#include "VoxelGrid.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// A smooth cut on the device: the list of the vertices of the cells that it crosses, with their
/// distances from the sheet, and where each of them would be if it moved with the other side
/// (CutPositions.cl). Its size is that of the cut, not of the volume.
class DeviceCut
{
public:
  /// crossed: one byte a cell, bit i = tetrahedron i is crossed; null: none is. distances: one
  /// float a voxel. Returns boxes round the vertices whose entry is another one than before.
  std::vector<Extent> Set(const OpenCLContext& context, const cl::CommandQueue& queue,
    const VoxelGrid& voxelGrid, const unsigned char* crossed, const float* distances);

  /// Whether a cell has crossed tetrahedra.
  bool IsOn() const { return !this->List.empty(); }
  const std::vector<CutVertex>& GetList() const { return this->List; }
  /// The stencils have to be found anew: states or active tetrahedra have changed.
  void ForgetStencils() { this->StencilsCurrent = false; }

  /// What the positions of the vertices of a chunk depend on.
  struct Source
  {
    cl::Program Program; // of the deformation mapping
    /// Sets a kernel's arguments of the mapping, which come first, and returns how many they are.
    std::function<cl_uint(cl::Kernel&)> SetMapping;
    cl::Buffer State;
    cl::Buffer Active;
  };
  /// Finds them. p: the parameters of the chunk. wanted: of each brick whether its vertices may
  /// have other positions than before; empty: all may, as where stencils are found anew. Finish()
  /// follows after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    const VolumeChunk& chunk, const Source& source, const std::vector<unsigned char>& wanted);
  void Finish() { this->StencilsCurrent = true; }

  ///@{
  /// What kernels are given; null where there is no cut.
  const cl::Buffer& GetRows() const { return this->Rows; }
  const cl::Buffer& GetVertices() const { return this->Vertices; }
  const cl::Buffer& GetPositions() const { return this->Positions; }
  ///@}
  /// Sets the arguments of a kernel that stand for the cut (CUT_PARAMETERS), from a number on;
  /// returns the number of the next argument.
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
  cl::Buffer Wanted; // bricks
  bool StencilsCurrent = false;
};

} // namespace deformvolume

#endif
