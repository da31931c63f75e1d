// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVertexStates_h
#define DeformVolumeVertexStates_h

#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "PartialUpdate.h"
#include "VolumeChunk.h"

#include <vector>

namespace deformvolume
{

class DeviceCut;

/// Keeps the states of the vertices of the sampling mesh (VertexState.cl) on the device. The
/// vertices to report are those that may have become sources, or are no longer sources.
class VertexStates : public PartialUpdate
{
public:
  /// The data on which the states of a chunk depend, besides its masks.
  struct Inputs
  {
    cl::Program Mapping; // of the deformation mapping
    const MappingSetter& SetMapping;
    const cl::Buffer& Active;
    const DeviceCut& Cut;
  };

  /// Updates the states of a chunk. p: parameters of the chunk. Call Finish() after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    VolumeChunk& chunk, const Inputs& inputs);

  /// Releases the states. Kernels must then be launched with HasState = 0.
  void Release(std::vector<VolumeChunk>& chunks);
};

} // namespace deformvolume

#endif
