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
class Launches;
class OutputSlab;
class WorkDevice;

/// Resamples the cells of the sampling mesh that the boundary of the deformation mesh crosses, by
/// the tetrahedra of that mesh (BoundaryCells.cl has the rule), where all other cells have left the
/// output uncovered. So the deformed volume ends where the deformed mesh ends.
class BoundaryCells
{
public:
  BoundaryCells(
    WorkDevice& device, DeviceVolume& volume, const DisplacementSource& source, Launches& launches);

  /// Takes the boundary of the mesh that the source has, or of its field. tetrahedra: those of the
  /// mesh; null for a field.
  void Set(const MeshBoundary& boundary, const Tetrahedron* tetrahedra);
  /// Tetrahedra have got other nodes, in the same places at rest.
  void SetCorners(const Tetrahedron* tetrahedra);
  void Clear();
  bool IsEmpty() const { return this->Boundary.empty(); }

  /// Launches of Run over all tiles.
  std::size_t GetNumberOfLaunches() const;
  /// Resamples the voxels of a slab that are not covered after all passes over the cells.
  /// patches: those that are to be looked at, where all others are as they were; null: all.
  void Run(const DeformRequest& request, const OutputSlab& output,
    const std::vector<std::uint32_t>* patches = nullptr);

  /// Of the last output: voxels of the slab that are covered by the boundary; pieces that are
  /// inverted, and that are stretched so far that they are left out.
  std::uint64_t GetNumberOfCovered() const { return this->Covered; }
  const TetrahedronLists::Counts& GetCounts() const { return this->Counts; }

  /// Bytes on the device.
  std::uint64_t GetMemory() const;

private:
  void MoveCorners();
  void RunTiles(const DeformRequest& request, const OutputSlab& output,
    const RasterParameters& parameters, std::size_t numberOfTiles);
  static std::vector<cl_uint> ListTiles(
    const RasterParameters& tiles, const std::vector<std::uint32_t>* patches);

  WorkDevice& Device;
  DeviceVolume& Volume;
  const DisplacementSource& Source;
  Launches& Launched;
  std::vector<MeshBoundary::Piece> Boundary;
  std::size_t NumberOfCorners = 0; // different ones, as pieces have nodes in common
  cl::Buffer Corners;
  cl::Buffer Pieces; // each four numbers of corners
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
