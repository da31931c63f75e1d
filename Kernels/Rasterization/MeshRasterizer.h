// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshRasterizer_h
#define DeformVolumeMeshRasterizer_h

#include "DeformRequest.h"
#include "DisplacementField.h"
#include "OpenCLContext.h"
#include "RasterParameters.h"
#include "Tetrahedron.h"
#include "VolumeArray.h"

#include <functional>

namespace deformvolume
{

class DeviceVolume;
class RasterTarget;
struct VolumeChunk;

/// Resamples by rasterising the tetrahedra of the deformation mesh into the output
/// (TetrahedronBinning.cl, MeshRasterization.cl, RestSampling.cl). Needs of the volume nothing but
/// its arrays and masks: no links, no state and no positions of its voxels. The volume can also be
/// looked up through an inverse displacement field (FieldLookup.cl), without any mesh.
class MeshRasterizer
{
public:
  /// What a rasterisation is done with.
  struct Setting
  {
    OpenCLContext& Context;
    cl::CommandQueue Queue;
    cl::CommandQueue ReadQueue; // for copies to the caller
    std::uint64_t AllocationLimit;
    std::size_t WorkGroupSize; // 0: chosen by device
  };

  /// tetrahedra: node indices that are in range. restNodes: three numbers a node, continuous
  /// indices of the volume.
  void SetMesh(const Setting& setting, const Tetrahedron* tetrahedra,
    std::size_t numberOfTetrahedra, const double* restNodes, std::size_t numberOfNodes);

  /// Three floats a node, in output voxels, finite.
  void SetDisplacements(
    const Setting& setting, const float* displacements, const std::array<double, 3>& scale);

  /// A field in place of a mesh: its vectors lead from output voxels to where these lie in the
  /// volume at rest, in output voxels. IndexToField takes the index of an output voxel.
  void SetField(const Setting& setting, const DisplacementField& inverse);

  /// Forgets all.
  void Clear() { *this = MeshRasterizer(); }

  bool HasMesh() const { return !this->RestNodes.empty(); }
  bool HasField() const { return this->FieldVectors() != nullptr; }
  /// Whether mesh and displacements are set, or a field.
  bool IsReady() const { return this->DisplacementsSet || this->HasField(); }

  /// Throws an Error where the deformation or the volume is beyond what can be rasterised. spare:
  /// bytes of device memory that may be used beyond those of one slab of the output.
  DeformReport Deform(const Setting& setting, const DeviceVolume& volume,
    const std::vector<VolumeArray>& arrays, const DeformRequest& request, std::uint64_t spare);

  /// Bytes on the device, and those that a rasterisation needs there besides the arrays of the
  /// volume and its masks, as far as is known beforehand.
  std::uint64_t GetMemory() const;
  static std::uint64_t GetMemoryNeeded(std::uint64_t outputVoxels, std::uint64_t bytesPerVoxel,
    std::size_t numberOfNodes, std::size_t numberOfTetrahedra);

private:
  void Bin(const Setting& setting, RasterParameters& parameters, DeformReport& report);
  void CheckPositions() const;
  /// Makes a slab, tile by tile, after Bin. progress: how much of it is done; false ends it with
  /// Aborted.
  void RunTiles(const Setting& setting, cl::Kernel& kernel, const VolumeChunk& chunk,
    RasterParameters parameters, const RasterTarget& target,
    const std::function<bool(double)>& progress, DeformReport& report);

  cl::Kernel MakeKernel(const Setting& setting, const DeviceVolume& volume,
    const std::vector<VolumeArray>& arrays, Interpolation interpolation) const;
  /// Sets the arguments of the kernel that come first. Returns how many.
  cl_uint SetDeformationArguments(cl::Kernel& kernel) const;

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
  cl::Buffer Places;
  cl::Buffer ListBegins;
  cl::Buffer Lists;
  cl::Buffer FieldVectors;
  LookupParameters Field = {};
};

} // namespace deformvolume

#endif
