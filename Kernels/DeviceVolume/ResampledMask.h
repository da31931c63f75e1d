// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeResampledMask_h
#define DeformVolumeResampledMask_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VolumeChunk.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Keeps the mask of the tetrahedra of the sampling mesh that are resampled by their vertices, on
/// the device. The mask excludes bridges over a split of the deformation mesh (ResampledMask.cl has
/// the rule) and cells that the boundary of the mesh crosses (MeshBoundary). An update processes
/// only cells for which something has changed.
class ResampledMask
{
public:
  /// The data on which the mask of a chunk depends. Any buffer may replace a missing buffer.
  struct Inputs
  {
    cl::Program Program; // GetResampledMaskProgram()
    const MappingSetter& SetMapping;
    cl::Buffer Owners; // tetrahedra of the records of runs
    cl::Buffer Tetrahedra;
    cl::Buffer Active;
    bool HasActive;
    cl::Buffer Other; // any buffer
    cl::Buffer CutRows;
    cl::Buffer CutVertices;
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

  /// Makes the next update process all cells.
  void Invalidate();
  /// Reports vertices whose tetrahedra have new nodes, or whose entries in the list of a smooth cut
  /// have changed.
  void ChangeVertices(const std::vector<Extent>& vertices);
  /// Reports cells whose active tetrahedra have changed.
  void ChangeCells(const std::vector<Extent>& cells);
  /// Whether the mask is up to date.
  bool IsCurrent() const { return this->Current; }

  /// Updates the mask of a chunk. p: parameters of the chunk. changes: the boxes of cells with
  /// changes are appended. Call Finish() after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    VolumeChunk& chunk, const Inputs& inputs, std::vector<Extent>& changes);
  void Finish();

private:
  cl::Buffer CoincidentNodes;
  bool WithBoundary = false;
  bool Current = true;
  // Whether the mask has been computed. Since then, only these vertices and cells have changed.
  bool Known = false;
  std::vector<Extent> Vertices;
  std::vector<Extent> Cells;
};

} // namespace deformvolume

#endif
