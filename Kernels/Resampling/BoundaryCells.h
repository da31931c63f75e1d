// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoundaryCells_h
#define DeformVolumeBoundaryCells_h

#include "DeformRequest.h"
#include "MeshBoundary.h"
#include "OpenCLContext.h"
#include "TetrahedronLists.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class DisplacementSource;
class KernelLauncher;
class MemoryBudget;
class OutputSlab;
class WorkDevice;

/// Resamples the cells of the sampling mesh that the boundary of the deformation mesh crosses. It
/// uses the tetrahedra of the deformation mesh (rule in BoundaryCells.cl), and fills only voxels
/// that all other cells left uncovered. The deformed volume then ends where the deformed mesh ends.
class BoundaryCells
{
public:
  BoundaryCells(WorkDevice& device, MemoryBudget& budget, DeviceVolume& volume,
    const DisplacementSource& source, KernelLauncher& launcher);

  /// Sets the boundary of the mesh or field of the displacement source. tetrahedra: the tetrahedra
  /// of the mesh; null for a field.
  void Set(const MeshBoundary& boundary, const Tetrahedron* tetrahedra);
  /// Updates the corners after the connectivity of the tetrahedra changed. Their shapes must be the
  /// same.
  void SetCorners(const Tetrahedron* tetrahedra);
  void Clear();
  bool IsEmpty() const { return this->Boundary.empty(); }

  /// Returns the number of launches of Run over all tiles.
  std::size_t GetNumberOfLaunches() const;
  /// Resamples the voxels of a slab that are not covered after all passes over the cells. patches:
  /// the patches to resample, if all other patches keep their values; null: all patches.
  void Run(const DeformRequest& request, const OutputSlab& output,
    const std::vector<std::uint32_t>* patches = nullptr);

  /// Results of the last Run: the voxels of the slab that the boundary covers; the pieces that are
  /// inverted, or so overstretched that they are skipped.
  std::uint64_t GetNumberOfCovered() const { return this->Covered; }
  const TetrahedronLists::Counts& GetCounts() const { return this->Counts; }

  /// Returns the memory on the device, in bytes.
  std::uint64_t GetMemory() const;

private:
  void MoveCorners();
  void RunTiles(const DeformRequest& request, const OutputSlab& output,
    const RasterParameters& parameters, std::size_t numberOfTiles);
  static std::vector<cl_uint> ListTiles(
    const RasterParameters& tiles, const std::vector<std::uint32_t>* patches);

  WorkDevice& Device;
  MemoryBudget& Budget;
  DeviceVolume& Volume;
  const DisplacementSource& Source;
  KernelLauncher& Launcher;
  std::vector<MeshBoundary::Piece> Boundary;
  std::size_t NumberOfCorners = 0; // without duplicates: pieces share nodes
  cl::Buffer Corners;
  cl::Buffer Pieces; // four corner numbers for each piece
  cl::Buffer Positions;
  cl::Buffer Displacements;
  cl::Buffer Tiles;
  cl::Buffer PatchCounts;
  TetrahedronLists Lists;
  TetrahedronLists::Counts Counts{ 0, 0 };
  std::vector<cl_uint> CoveredInPatches;
  std::uint64_t Covered = 0;
};

} // namespace deformvolume

#endif
