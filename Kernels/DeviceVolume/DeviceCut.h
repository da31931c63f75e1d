// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceCut_h
#define DeformVolumeDeviceCut_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "PartialUpdate.h"
#include "VolumeChunk.h"
#include "VoxelGrid.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A smooth cut on the device: the list of the vertices of crossed cells, with their distances from
/// the sheet and the positions of their copies on the other side (CutPositions.cl). The memory is
/// proportional to the size of the cut, not of the volume. The vertices and cells to report are
/// those that may have become sources or are no longer sources, and those whose active tetrahedra
/// may have changed: stencils depend on these up to BrickGrid::HaloOfCuts voxels away.
class DeviceCut : public PartialUpdate
{
public:
  /// Set the cut. crossed: one byte per cell, bit i: tetrahedron i is crossed; null: no cut.
  /// distances: one float per voxel. Returns bounding boxes of the vertices whose entries have
  /// changed. Report them to the states of the vertices, which report them to the cut.
  std::vector<Extent> Set(const OpenCLContext& context, const cl::CommandQueue& queue,
    const VoxelGrid& voxelGrid, const unsigned char* crossed, const float* distances);

  /// Whether any cell has crossed tetrahedra.
  bool IsOn() const { return !this->List.empty(); }
  const std::vector<CutVertex>& GetList() const { return this->List; }

  /// Computes the positions of the copies in a chunk, and the stencils near the changes. p:
  /// parameters of the chunk. mapping: the program of the deformation mapping. active: the active
  /// tetrahedra; may be null. moved: boxes of the vertices whose positions may have changed; null:
  /// all may have changed. Call Finish() after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    const VolumeChunk& chunk, const cl::Program& mapping, const MappingSetter& set,
    const cl::Buffer& active, const std::vector<Extent>* moved);

  ///@{
  /// The buffers for kernels. Null if there is no cut.
  const cl::Buffer& GetRows() const { return this->Now.Rows; }
  const cl::Buffer& GetVertices() const { return this->Now.Vertices; }
  const cl::Buffer& GetPositions() const { return this->Now.Positions; }
  ///@}
  /// Sets the kernel arguments of the cut (CUT_PARAMETERS). argument: index of the first of them.
  /// Returns the index of the next argument.
  cl_uint SetArguments(cl::Kernel& kernel, cl_uint argument) const;

  std::uint64_t GetMemory() const;

private:
  // The list and the results of the kernels (CutPositions.cl).
  struct ListBuffers
  {
    cl::Buffer Rows;
    cl::Buffer Vertices;
    cl::Buffer Stencils;
    cl::Buffer Positions;
  };

  void Send(const OpenCLContext& context, const cl::CommandQueue& queue);
  // Returns the numbers of the vertices of a chunk whose positions must be computed. Sets stencils
  // to the number of vertices, at the beginning of the list, that need new stencils, too.
  std::vector<cl_uint> FindNumbers(
    const KernelParameters& p, const std::vector<Extent>* moved, cl_uint& stencils) const;

  std::vector<CutVertex> List;
  std::vector<std::uint32_t> RowBegins;
  ListBuffers Now;
  ListBuffers Last;   // the list before Set(), until the next update; null if nothing of it is kept
  cl::Buffer Numbers; // of FindNumbers()
};

} // namespace deformvolume

#endif
