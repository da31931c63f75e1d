// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshRasterizer_h
#define DeformVolumeMeshRasterizer_h

#include "DeformRequest.h"
#include "DisplacementField.h"
#include "OpenCLContext.h"
#include "RasterParameters.h"
#include "RasterTarget.h"
#include "SlabResampler.h"
#include "Tetrahedron.h"
#include "TetrahedronLists.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class WorkDevice;

/// Resamples by rasterising the tetrahedra of the deformation mesh into the output
/// (TetrahedronBinning.cl, MeshRasterization.cl, RestSampling.cl). Needs of the volume nothing but
/// its arrays and masks: no links, no state and no positions of its voxels. The volume can also be
/// looked up through an inverse displacement field (FieldLookup.cl), without any mesh.
class MeshRasterizer : public SlabResampler
{
public:
  MeshRasterizer(WorkDevice& device, const DeviceVolume& volume)
    : Device(&device)
    , Volume(&volume)
  {
  }

  /// tetrahedra: node indices that are in range. restNodes: three numbers a node, continuous
  /// indices of the volume.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    const double* restNodes, std::size_t numberOfNodes);

  /// Three floats a node, in output voxels, finite.
  void SetDisplacements(const float* displacements);

  /// A field in place of a mesh: its vectors lead from output voxels to where these lie in the
  /// volume at rest, in output voxels. IndexToField takes the index of an output voxel.
  void SetField(const DisplacementField& inverse);

  /// Forgets the mesh or the field.
  void Clear() { *this = MeshRasterizer(*this->Device, *this->Volume); }

  bool HasMesh() const { return !this->RestNodes.empty(); }
  bool HasField() const { return this->FieldVectors() != nullptr; }
  /// Whether mesh and displacements are set, or a field.
  bool IsReady() const { return this->DisplacementsSet || this->HasField(); }
  /// Nodes of the mesh, or points of the field.
  std::size_t GetNumberOfNodes() const;
  std::size_t GetNumberOfTetrahedra() const { return this->NumberOfTetrahedra; }

  /// Throws an Error where the deformation or the volume is beyond what can be rasterised.
  void Begin(const DeformRequest& request, const SlabPlan& plan, DeformReport& report) override;
  void Make(const DeformRequest& request, const SlabPlan& plan, std::size_t slab,
    DeformReport& report) override;
  void Read(const DeformRequest& request, std::size_t target) override;
  std::vector<std::shared_ptr<DeviceOutput>> Leave(
    const DeformRequest& request, std::size_t target) override;
  void FinishReading() override;
  void Finish() noexcept override;

  /// Bytes on the device, and those that a rasterisation needs there besides the arrays of the
  /// volume and its masks, as far as is known beforehand.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(WorkDevice& device, std::uint64_t outputVoxels,
    std::uint64_t bytesPerVoxel, std::size_t numberOfNodes, std::size_t numberOfTetrahedra);

private:
  void CheckPositions() const;
  /// Makes a slab, tile by tile, of the lists. progress: how much of it is done; false ends it with
  /// Aborted.
  void RunTiles(RasterParameters parameters, const RasterTarget& target,
    const std::function<bool(double)>& progress, DeformReport& report);

  cl::Kernel MakeKernel(Interpolation interpolation) const;
  /// Sets all arguments of the kernel but the parameters. Returns which these are.
  cl_uint SetArguments(
    const RasterParameters& p, const RasterTarget& target, const cl::Buffer& counters);
  /// Those that come first. Returns how many.
  cl_uint SetDeformationArguments(cl::Kernel& kernel) const;

  WorkDevice* Device;
  const DeviceVolume* Volume;
  std::vector<double> RestNodes;
  std::size_t NumberOfTetrahedra = 0;
  std::int64_t NumberOfFlatTetrahedra = 0;
  bool DisplacementsSet = false;
  // The node that is farthest from the output's index 0, and how far on an axis, in output voxels.
  std::size_t FarthestNode = 0;
  double FarthestPosition = 0.0;
  cl::Buffer Tetrahedra;
  cl::Buffer Positions;
  cl::Buffer Displacements;
  TetrahedronLists Lists;
  cl::Buffer FieldVectors;
  LookupParameters Field = {};
  cl::Kernel Kernel; // of the output that is made
  /// One is made while the other is copied to the caller.
  std::array<std::unique_ptr<RasterTarget>, 2> Targets;
};

} // namespace deformvolume

#endif
