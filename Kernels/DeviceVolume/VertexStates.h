// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVertexStates_h
#define DeformVolumeVertexStates_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VolumeChunk.h"

#include <vector>

namespace deformvolume
{

/// Keeps the states of the vertices of the sampling mesh (VertexState.cl) on the device. An update
/// computes only the states around changes.
class VertexStates
{
public:
  /// The data on which the states of a chunk depend. Any buffer may replace a missing buffer.
  struct Inputs
  {
    cl::Program Mapping; // of the deformation mapping
    const MappingSetter& SetMapping;
    cl::Buffer Blanked;
    bool HasBlanked;
    cl::Buffer Active;
    cl::Buffer Distances;
    cl::Buffer CutRows;
    cl::Buffer CutVertices;
  };

  /// Makes the next update compute all states.
  void Invalidate();
  /// Reports vertices that may have become sources, or are no longer sources.
  void ChangeSources(const std::vector<Extent>& vertices);
  /// Reports cells whose active tetrahedra have changed.
  void ChangeCells(const std::vector<Extent>& cells);

  /// Whether the states are up to date.
  bool AreCurrent() const { return this->Current; }

  /// Updates the states of a chunk. p: parameters of the chunk. Call Finish() after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    VolumeChunk& chunk, const Inputs& inputs);
  void Finish();

  /// Releases the states. Kernels must then be launched with HasState = 0.
  void Release(std::vector<VolumeChunk>& chunks);

private:
  bool Current = false;
  // Whether the states have been computed. Since then, only these vertices and cells have changed.
  bool Known = false;
  std::vector<Extent> Sources;
  std::vector<Extent> Cells;
};

} // namespace deformvolume

#endif
