// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBridgeMask_h
#define DeformVolumeBridgeMask_h

#include "Extent.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VolumeChunk.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// Leaves out the tetrahedra of the sampling mesh that would bridge the gap where the deformation
/// mesh has been split (BridgeMask.cl has the rule), and the cells that the boundary of the mesh
/// crosses (MeshBoundary): keeps a mask of the others on the device, and looks again only at the
/// cells round tetrahedra that have got other nodes.
class BridgeMask
{
public:
  /// What the mask of a chunk depends on.
  struct Source
  {
    cl::Program Program; // GetBridgeProgram
    /// Sets a kernel's arguments of the mapping, which come first, and returns how many they are.
    std::function<cl_uint(cl::Kernel&)> SetMapping;
    cl::Buffer Owners; // of the records of runs; any buffer, for links
    cl::Buffer Tetrahedra;
    cl::Buffer Active; // any buffer, if there is none
    bool HasActive;
    cl::Buffer Other;   // any buffer
    cl::Buffer CutRows; // any buffer, if there is no cut
    cl::Buffer CutVertices;
  };

  /// places: for each node, as the device numbers them, a number that nodes with one place at rest
  /// share; empty: nothing is left out. (What tetrahedra had changed has to be told.)
  void SetPlaces(
    OpenCLContext& context, const cl::CommandQueue& queue, const std::vector<std::int32_t>& places);
  bool HasPlaces() const { return this->Places() != nullptr; }
  /// Whether chunks have a boundary (VolumeChunk::Boundary).
  void SetBoundary(bool has);
  bool HasBoundary() const { return this->WithBoundary; }
  bool IsOn() const { return this->HasPlaces() || this->WithBoundary; }

  /// All cells have to be looked at.
  void Forget();
  /// The tetrahedra that some vertices lie in have got other nodes, or a smooth cut lists them
  /// otherwise.
  void ChangeVertices(const std::vector<Extent>& vertices);
  /// Others of the active tetrahedra of some cells are active.
  void ChangeCells(const std::vector<Extent>& cells);
  bool IsCurrent() const { return this->Current; }

  /// Brings the mask of a chunk up to date. p: its parameters. Adds the boxes of cells that have
  /// changed. Finish() follows after all chunks.
  void Update(OpenCLContext& context, const cl::CommandQueue& queue, const KernelParameters& p,
    VolumeChunk& chunk, const Source& source, std::vector<Extent>& changes);
  void Finish();

private:
  cl::Buffer Places;
  bool WithBoundary = false;
  bool Current = true;
  bool Known = false; // but for these
  std::vector<Extent> Vertices;
  std::vector<Extent> Cells;
};

} // namespace deformvolume

#endif
