// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceLattice_h
#define DeformVolumeDeviceLattice_h

#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VolumeDeformer.h"

namespace deformvolume
{

/// A range of cell layers of the sampling mesh with the vertex planes that they and their
/// neighbours need: a volume over the device's allocation limit is held in several.
struct LatticeChunk
{
  int LayersBegin = 0; // cells, local z
  int LayersEnd = 0;
  int PlanesBegin = 0; // vertices, local z: one plane more than the cells have on each side
  int PlanesEnd = 0;
  cl::Buffer Links;
  cl::Buffer State;
  cl::Buffer Blanked;
  cl::Buffer Active;
  std::vector<cl::Buffer> Arrays;
};

/// What the device holds of the sampling mesh: per voxel the arrays, the static link into the
/// deformation mesh, the state; per cell the active tetrahedra.
class DeviceLattice
{
public:
  DeviceLattice(OpenCLContext& context, const cl::CommandQueue& queue, const Lattice& lattice,
    std::size_t bytesPerVoxel, std::uint64_t allocationLimit);

  void SetArrays(const std::vector<VolumeArray>& arrays);
  void SetLinks(const VertexLink* links);
  void SetBlanked(const unsigned char* blanked);
  void SetActive(const unsigned char* active);

  const Lattice& GetLattice() const { return this->Shape; }
  int GetSize(int axis) const
  {
    return static_cast<int>(deformvolume::GetSize(this->Shape.VertexExtent, axis));
  }
  bool HasActive() const { return this->WithActive; }
  bool HasBlanked() const { return this->WithBlanked; }
  bool HasLinks() const { return this->WithLinks; }
  const std::vector<LatticeChunk>& GetChunks() const { return this->Chunks; }

  /// For each index on x, then y, then z the undeformed position (RestPosition in
  /// DeformationMapping.cl).
  const cl::Buffer& GetRestPositions() const { return this->RestPositions; }

  /// Global and work-group size of a launch over the vertices of so many planes.
  cl::NDRange GetVertexRange(int planes) const;
  cl::NDRange GetVertexGroup() const;

  /// Brings the state of the vertices up to date, where anything changed that it depends on.
  /// mapping: the program of the deformation mapping. field: null where the deformation is a mesh.
  void UpdateState(const cl::Program& mapping, const FieldParameters* field);
  void ForgetState() { this->StateChanged = true; }

  /// The parameters of a launch over the whole of a chunk.
  KernelParameters GetParameters(const LatticeChunk& chunk) const;

  std::uint64_t GetMemory() const;

private:
  cl::Buffer Send(const void* data, std::size_t bytesPerElement, std::int64_t elementsPerLayer,
    int begin, int end, const cl::Buffer& previous);
  cl::Buffer MakeRestPositions() const;

  OpenCLContext& Context;
  cl::CommandQueue Queue;
  Lattice Shape;
  std::uint64_t AllocationLimit;
  std::vector<LatticeChunk> Chunks;
  cl::Buffer RestPositions;
  bool WithLinks = false;
  bool WithBlanked = false;
  bool WithActive = false;
  bool StateChanged = true;
};

/// Bytes of a buffer; 0 for none.
std::uint64_t GetMemory(const cl::Buffer& buffer);

} // namespace deformvolume

#endif
