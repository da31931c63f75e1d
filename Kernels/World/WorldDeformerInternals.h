// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldDeformerInternals_h
#define DeformVolumeWorldDeformerInternals_h

#include "FadedMesh.h"
#include "MappingCache.h"
#include "VectorField.h"
#include "VolumeDeformer.h"
#include "VoxelJacobians.h"
#include "WorldDeformer.h"

#include <optional>
#include <string>
#include <vector>

namespace deformvolume
{

class WorldDeformer::Internals
{
public:
  enum class Deformations
  {
    None,
    Mesh,
    Field
  };

  ///@{
  /// Brings all that follows from the settings up to date. Throws an Error where something is
  /// missing or does not go together.
  void UpdateDeformation();
  ImageGeometry GetOutputGrid() const;
  Extent FindWholeExtent();
  ///@}

  /// One deformation, in the order of its steps.
  WorldReport Deform(const WorldRequest& request);

  void Forget();

  VolumeDeformer Deformer;
  std::string DeviceRequest;
  std::optional<ImageGeometry> Volume;
  std::vector<WorldArray> Arrays;
  /// Of densities of integers, as floats; empty: they have not been made, or there are none.
  std::vector<std::vector<float>> DensityCopies;
  WorldMasks Masks;
  WorldMesh Mesh;
  VectorField Field;
  Deformations Deformation = Deformations::None;
  /// For which the field has stood in for a deformation, where there is none.
  std::optional<ImageGeometry> VolumeAtRest;
  OutsideVoxels Outside;
  std::optional<ImageGeometry> Reference;
  OutputSettings Settings;

  OutputMap ToOutput;
  MappingCache Mapping;

  ///@{
  /// Change with what was set.
  std::uint64_t ArraysVersion = 0;
  std::uint64_t MasksVersion = 0;
  ///@}

private:
  bool IsMesh() const { return this->Deformation == Deformations::Mesh; }
  bool IsInverse() const
  {
    return this->Deformation == Deformations::Field && this->Field.IsInverse();
  }
  MappedVolume GetMapped() const
  {
    return { *this->Volume, this->Volume->PointExtent, this->Outside };
  }
  VoxelGrid GetVoxelGrid() const
  {
    return { this->Volume->PointExtent, this->ToOutput, this->Volume->PointExtent };
  }
  IndexBounds FindBounds();

  bool HasDensities() const;
  /// Whether Jacobians are resampled, which are arrays of the volume.
  bool ResamplesJacobians(const WorldRequest& request) const
  {
    return (request.Jacobians || this->HasDensities()) && !this->IsInverse();
  }
  /// An array as it is resampled.
  VolumeArray GetSource(std::size_t array);
  /// The arrays that are resampled: those of the volume, and those that are made of the request.
  std::vector<VolumeArray> MakeArrays(
    const WorldRequest& request, const std::function<bool(double)>& progress);
  void UpdateRestPositions();
  void UpdateJacobians(const std::function<bool(double)>& progress);
  Resampling ChooseMethod(
    const WorldRequest& request, const std::vector<VolumeArray>& arrays, const Extent& whole);
  void CheckMemory(const std::vector<VolumeArray>& arrays, const Extent& extent, Resampling method);
  void SendVolume(const std::vector<VolumeArray>& arrays, Resampling method);
  void SendMesh(const std::function<bool(double)>& progress);
  void SendRestMesh();
  void SendField();
  DeformRequest MakeRequest(const WorldRequest& request, const Extent& whole, Resampling method);
  /// Completes the arrays that are not those of the volume.
  void Finish(const WorldRequest& request, const Extent& extent);
  void DivideDensities(const WorldRequest& request, const float* jacobians, std::int64_t voxels);
  void Describe(const WorldRequest& request, const Extent& whole, WorldReport& report);

  // What is resampled besides the arrays of the volume, and what it is of.
  std::array<std::vector<float>, 3> Positions;
  std::optional<ImageGeometry> PositionsVolume;
  std::array<std::vector<float>, 3> PositionsOutput;
  VoxelJacobians OfMesh;
  std::uint64_t OfMeshVersion = 0; // of the mapping
  std::vector<float> Jacobians;
  OutsideVoxels JacobiansOutside;
  std::vector<float> JacobiansOutput;  // where only densities need them
  std::int64_t NumberOfLostVoxels = 0; // of densities, in the last output

  // What the device has. A call that throws leaves it unknown, and then everything is sent again.
  bool Known = false;
  std::string Device;
  VoxelGrid SentGrid;
  std::size_t SentWidth = 0;
  bool SentForLinks = false;
  std::vector<VolumeArray> SentArrays;
  std::uint64_t SentArraysVersion = 0;
  std::uint64_t SentMasksVersion = 0;
  Deformations SentDeformation = Deformations::None;
  bool SentForRasterization = false;
  std::uint64_t SentShape = 0; // of the mapping, or of the mesh for the rasterization
  std::uint64_t SentVectors = 0;
  OutsideVoxels SentOutside;
  FadedMesh Faded;
  bool HasFadedMesh = false;

  // The last output, where it is one that a call can begin with.
  std::vector<void*> LastOutputs;
  signed char* LastCoverage = nullptr;
  Extent LastExtent{ { 0, -1, 0, -1, 0, -1 } };
};

} // namespace deformvolume

#endif
