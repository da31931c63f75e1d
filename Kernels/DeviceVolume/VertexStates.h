// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVertexStates_h
#define DeformVolumeVertexStates_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VolumeChunk.h"

#include <functional>
#include <vector>

namespace deformvolume
{

/// Keeps the state of the vertices of the sampling mesh (VertexState.cl) up to date on the device:
/// computes it only round what has changed.
class VertexStates
{
public:
  /// What the state of the vertices of a chunk depends on.
  struct Source
  {
    cl::Program Mapping; // of the deformation mapping
    /// Sets a kernel's arguments of the mapping, which come first, and returns how many they are.
    std::function<cl_uint(cl::Kernel&)> SetMapping;
    cl::Buffer Blanked; // any buffer, if it has none
    bool HasBlanked;
    cl::Buffer Active;    // any buffer, if it has none
    cl::Buffer Distances; // any buffer, if it has none
    cl::Buffer CutRows;   // any buffer, if there is no cut
    cl::Buffer CutVertices;
  };

  /// All vertices have to be looked at.
  void Forget();
  /// Some vertices may have become sources, or are none any more.
  void ChangeSources(const std::vector<Extent>& vertices);
  /// The active tetrahedra of some cells have changed.
  void ChangeCells(const std::vector<Extent>& cells);

  bool AreCurrent() const { return this->Current; }

  /// Brings the states of a chunk up to date. p: its parameters. Finish() follows after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    VolumeChunk& chunk, const Source& source);
  void Finish();

  /// There is no state to keep, as all is as the kernels expect it without (HasState).
  void Release(std::vector<VolumeChunk>& chunks);

private:
  bool Current = false;
  bool Known = false; // but for these
  std::vector<Extent> Sources;
  std::vector<Extent> Cells;
};

} // namespace deformvolume

#endif
