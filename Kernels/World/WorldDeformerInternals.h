// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldDeformerInternals_h
#define DeformVolumeWorldDeformerInternals_h

#include "FadedMesh.h"
#include "MappingCache.h"
#include "SplitNodes.h"
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

  /// Updates the deformation for the volume and the output. Throws an Error if the volume or the
  /// displacements are missing or cannot be used.
  void UpdateDeformation();
  /// Returns the grid of the output. Its extent is empty if there is no reference grid.
  ImageGeometry GetOutputGrid() const;
  /// Returns the whole extent of the output. Must be called after UpdateDeformation().
  Extent FindWholeExtent();

  /// See WorldDeformer::Deform().
  WorldReport Deform(const WorldRequest& request);

  void Forget();

  VolumeDeformer Deformer;
  std::string DeviceRequest;
  std::optional<ImageGeometry> Volume;
  std::vector<WorldArray> Arrays;
  /// The values of densities of integers, as floats. Empty if there are none, or if they were not
  /// made yet.
  std::vector<std::vector<float>> DensityCopies;
  WorldMasks Masks;
  WorldMesh Mesh;
  VectorField Field;
  Deformations Deformation = Deformations::None;
  /// The volume for which the field of zeros was made. This field is used if there is no
  /// deformation.
  std::optional<ImageGeometry> VolumeAtRest;
  OutsideVoxels Outside;
  std::optional<ImageGeometry> Reference;
  OutputSettings Settings;

  OutputMap ToOutput;
  MappingCache Mapping;

  ///@{
  /// Change with the arrays and with the masks.
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
  /// Whether Jacobians are computed at the voxels of the volume, and resampled like its arrays.
  /// Jacobians of inverse fields are computed in the output.
  bool ResamplesJacobians(const WorldRequest& request) const
  {
    return (request.Jacobians || this->HasDensities()) && !this->IsInverse();
  }
  /// Returns an array in the type in which it is resampled.
  VolumeArray GetSource(std::size_t array);
  /// Returns the arrays to resample: the arrays of the volume, and the additional arrays of the
  /// request.
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
  /// Completes additional arrays and densities after resampling.
  void Finish(const WorldRequest& request, const Extent& extent);
  void DivideDensities(const WorldRequest& request, const float* jacobians, std::int64_t voxels);
  void Describe(const WorldRequest& request, const Extent& whole, WorldReport& report);

  SplitNodes Splits;

  // Additional arrays, and the data for which they were made.
  std::array<std::vector<float>, 3> Positions;
  std::optional<ImageGeometry> PositionsVolume;
  std::array<std::vector<float>, 3> PositionsOutput;
  VoxelJacobians OfMesh;
  std::uint64_t OfMeshVersion = 0; // of the mapping
  std::vector<float> Jacobians;
  std::vector<float> JacobiansOutput;  // if only densities need them
  std::int64_t NumberOfLostVoxels = 0; // of densities, in the last output

  // The data on the device. After an exception these are not known, and everything is sent again.
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

  // The memory of the last output, if it can be updated incrementally.
  std::vector<void*> LastOutputs;
  signed char* LastCoverage = nullptr;
  Extent LastExtent{ { 0, -1, 0, -1, 0, -1 } };
};

} // namespace deformvolume

#endif
