// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeResampledMask_h
#define DeformVolumeResampledMask_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "PartialUpdate.h"
#include "VolumeChunk.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

class DeviceCut;

/// Keeps the mask of the tetrahedra of the sampling mesh that are resampled by their vertices, on
/// the device. The mask excludes bridges over a split of the deformation mesh (ResampledMask.cl has
/// the rule) and cells that the boundary of the mesh crosses (MeshBoundary). The vertices to
/// report are those whose tetrahedra have new nodes, or whose entries in the list of a smooth cut
/// have changed.
class ResampledMask : public PartialUpdate
{
public:
  /// The data on which the mask of a chunk depends, besides its masks. Buffers may be null.
  struct Inputs
  {
    cl::Program Program; // GetResampledMaskProgram()
    const MappingSetter& SetMapping;
    const cl::Buffer& Owners; // tetrahedra of the records of runs
    const cl::Buffer& Tetrahedra;
    const DeviceCut& Cut;
  };

  /// Set a number for each node that is equal for all nodes with the same position at rest. Empty:
  /// bridges are not excluded. Report changed tetrahedra by ChangeVertices().
  void SetCoincidentNodes(OpenCLContext& context, const cl::CommandQueue& queue,
    const std::vector<std::int32_t>& numbers);
  bool HasCoincidentNodes() const { return this->CoincidentNodes() != nullptr; }
  /// Set whether chunks have a boundary (VolumeChunk::Boundary).
  void SetBoundary(bool has);
  bool HasBoundary() const { return this->WithBoundary; }
  /// Whether there is a mask.
  bool IsOn() const { return this->HasCoincidentNodes() || this->WithBoundary; }

  /// Whether the mask is up to date, or there is none.
  bool IsCurrent() const { return !this->IsOn() || PartialUpdate::IsCurrent(); }

  /// Updates the mask of a chunk. p: parameters of the chunk. changes: the boxes of cells with
  /// changes are appended. Call Finish() after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    VolumeChunk& chunk, const Inputs& inputs, std::vector<Extent>& changes);

private:
  cl::Buffer CoincidentNodes;
  bool WithBoundary = false;
};

} // namespace deformvolume

#endif
