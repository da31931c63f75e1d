// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshRasterizer_h
#define DeformVolumeMeshRasterizer_h

#include "DeformRequest.h"
#include "DisplacementField.h"
#include "OpenCLContext.h"
#include "OutputMemory.h"
#include "RasterParameters.h"
#include "SlabResampler.h"
#include "Tetrahedron.h"
#include "TetrahedronLists.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class MemoryBudget;
class WorkDevice;

/// Resamples by rasterizing the tetrahedra of the deformation mesh into the output
/// (TetrahedronBinning.cl, MeshRasterization.cl, RestSampling.cl). Needs only the arrays and masks
/// of the volume, and no links, states or positions of voxels. Instead of a mesh, an inverse
/// displacement field can be used (FieldLookup.cl).
class MeshRasterizer : public SlabResampler
{
public:
  MeshRasterizer(WorkDevice& device, MemoryBudget& budget, const DeviceVolume& volume)
    : Device(&device)
    , Budget(&budget)
    , Volume(&volume)
  {
  }

  /// Set the mesh. tetrahedra: indices of nodes, which must be in range. restNodes: three values
  /// per node, continuous indices of the volume.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    const double* restNodes, std::size_t numberOfNodes);

  /// Set the displacements: three floats per node, in output voxels, finite.
  void SetDisplacements(const float* displacements);

  /// Set an inverse field instead of a mesh. Its vectors, in output voxels, lead from output voxels
  /// to their positions in the volume at rest. IndexToField takes the index of an output voxel.
  void SetField(const DisplacementField& inverse);

  /// Discards the mesh or the field.
  void Clear() { *this = MeshRasterizer(*this->Device, *this->Budget, *this->Volume); }

  bool HasMesh() const { return !this->RestNodes.empty(); }
  bool HasField() const { return this->FieldVectors() != nullptr; }
  /// Whether a mesh with displacements is set, or a field.
  bool IsReady() const { return this->DisplacementsSet || this->HasField(); }
  /// Returns the number of nodes of the mesh, or of points of the field.
  std::size_t GetNumberOfNodes() const;
  std::size_t GetNumberOfTetrahedra() const { return this->NumberOfTetrahedra; }

  /// Throws an Error if the deformation or the volume is too large to be rasterized.
  void Begin(const DeformRequest& request, const SlabPlan& plan, DeformReport& report) override;
  void Make(const DeformRequest& request, const SlabPlan& plan, std::size_t slab,
    DeformReport& report) override;
  OutputMemory& GetTarget(std::size_t target) override { return this->Targets[target]; }
  void Finish() noexcept override;

  /// Returns the memory on the device, in bytes. GetMemoryNeeded estimates the memory of a
  /// rasterization, without the arrays and masks of the volume.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(WorkDevice& device, std::uint64_t outputVoxels,
    std::uint64_t bytesPerVoxel, std::size_t numberOfNodes, std::size_t numberOfTetrahedra);

private:
  void CheckPositions() const;
  /// Makes a slab tile by tile from the lists. progress: called with the completed fraction; throws
  /// Aborted if it returns false.
  void RunTiles(RasterParameters parameters, const OutputMemory& target,
    const std::function<bool(double)>& progress, DeformReport& report);

  cl::Kernel MakeKernel(Interpolation interpolation) const;
  /// Sets all arguments of the kernel except the parameters. Returns the index of the parameters.
  cl_uint SetArguments(const OutputMemory& target, const cl::Buffer& counters);
  /// Sets the first arguments. Returns their number.
  cl_uint SetDeformationArguments(cl::Kernel& kernel) const;

  WorkDevice* Device;
  MemoryBudget* Budget;
  const DeviceVolume* Volume;
  std::vector<double> RestNodes;
  std::size_t NumberOfTetrahedra = 0;
  std::int64_t NumberOfFlatTetrahedra = 0;
  bool DisplacementsSet = false;
  // The node with the largest coordinate relative to output index 0, and the absolute value of that
  // coordinate, in output voxels.
  std::size_t FarthestNode = 0;
  double FarthestPosition = 0.0;
  cl::Buffer Tetrahedra;
  cl::Buffer Positions;
  cl::Buffer Displacements;
  TetrahedronLists Lists;
  cl::Buffer FieldVectors;
  LookupParameters Field = {};
  cl::Kernel Kernel; // for the current output
  /// Eight bytes for each array. The first of these bytes are the background value in the type of
  /// the array.
  cl::Buffer Backgrounds;
  /// With two targets, one slab is made while the other is copied to the caller.
  std::array<OutputMemory, 2> Targets;
};

} // namespace deformvolume

#endif
