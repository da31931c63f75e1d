// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldDeformer_h
#define DeformVolumeWorldDeformer_h

#include "DeformRequest.h"
#include "DeformVolumeExport.h"
#include "DeviceSession.h"
#include "DeviceVectors.h"
#include "ImageGeometry.h"
#include "IndexDeformation.h"
#include "MappingCache.h"
#include "OutsideVoxels.h"
#include "SplitNodes.h"
#include "VectorField.h"
#include "VectorView.h"
#include "VolumeArray.h"
#include "VoxelJacobians.h"
#include "WorldMesh.h"
#include "WorldPoints.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace deformvolume
{

/// The extent and spacing of the output if there is no reference grid.
struct OutputSettings
{
  enum class BoundsModes
  {
    Deformed, // the bounds of the deformed volume
    Volume,
    Custom
  };
  BoundsModes Bounds = BoundsModes::Deformed;
  /// In world coordinates: x min, x max, y min, ...
  std::array<double, 6> CustomBounds{ { 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 } };
  int Padding = 0; // voxels on all sides
  /// The spacing of the output. None: the spacing of the volume.
  std::optional<glm::dvec3> Spacing;
};

/// An array of a volume.
struct WorldArray : VolumeArray
{
  /// Whether the values are amounts per unit of volume. Such values are divided by the Jacobian.
  /// The output has doubles for an array of doubles, otherwise floats. Not for categorical arrays.
  bool IsDensity = false;
};

/// What WorldDeformer::Deform() computes, and where it writes the results. An empty OutputExtent is
/// the whole output. Incremental: if the next request has the same memory, this memory must still
/// contain the output of this call; not with RestPositions, Jacobians, FoldCounts or densities. See
/// WorldArray::IsDensity for the types of Outputs. FoldCounts: 1 for covered voxels where nothing
/// overlaps. WorldDeformer sets Method and WholeOutputExtent. Leave MayStayOnDevice, HeldRevisions,
/// OutputRevision, LastOutputs and LastCoverage at their defaults. Progress is called only in the
/// thread that called Deform(); if it returns false, Deform() throws Aborted.
struct WorldRequest : DeformRequest
{
  /// Whether all arrays are resampled as if they were categorical.
  bool IsNearest = false;
  ///@{
  /// Memory for additional arrays, or null. RestPositions: three floats per voxel, the position at
  /// rest, in world coordinates, of the point of the volume that is deformed to the voxel.
  /// Jacobians: one float per voxel, the determinant of the derivative of deformed positions.
  float* RestPositions = nullptr;
  float* Jacobians = nullptr;
  ///@}
  double Background = 0.0; // of RestPositions and Jacobians
};

/// What WorldDeformer::Deform() has done.
struct WorldReport : DeformReport
{
  /// Name of the device.
  std::string Device;
  Resampling Method = Resampling::Exact;
  /// All warnings, separated by spaces; "" if there are none.
  std::string Warnings;
};

/// Deforms a volume by a mesh or a field, all given in world coordinates. The output equals that of
/// vtkDeformVolumeFilter for whole data bit for bit, but VTK is not needed. Data that did not
/// change since the last call are kept on the device. Every failure throws an Error; the object can
/// be used again afterwards.
class DEFORMVOLUME_EXPORT WorldDeformer
{
public:
  WorldDeformer();
  ~WorldDeformer();
  WorldDeformer(const WorldDeformer&) = delete;
  WorldDeformer& operator=(const WorldDeformer&) = delete;

  /// See VolumeDeformer.
  std::string SetDevice(const std::string& request);
  void SetMemoryLimit(std::uint64_t bytes);

  /// Set the geometry of the volume. Discards arrays and masks if the geometry changed.
  void SetVolume(const ImageGeometry& volume);
  /// Set the arrays. Their memory must stay valid until other arrays are set. Each call means that
  /// values may have changed.
  void SetArrays(const std::vector<WorldArray>& arrays);
  /// Set the masks. Their memory must stay valid until other masks are set.
  void SetMasks(const WorldMasks& masks);

  ///@{
  /// Set a mesh with displacements, or a field. The last one that was set is used. Without a mesh
  /// or a field, the volume is not deformed. See WorldMesh and VectorField.
  void SetMesh(const VectorView& points, MeshCells&& cells);
  void SetNodeVectors(const VectorView& vectors);
  void SetField(const ImageGeometry& grid, const VectorView& vectors, bool isInverse,
    const unsigned char* undefined = nullptr);
  void SetField(const ImageGeometry& grid, const std::shared_ptr<DeviceVectors>& vectors);
  ///@}

  void SetOutside(const OutsideVoxels& outside);
  /// Set the grid of the output, with its whole extent. None: see OutputSettings.
  void SetReference(const std::optional<ImageGeometry>& reference);
  void SetOutput(const OutputSettings& settings);

  /// Returns the grid of the output, with its whole extent.
  ImageGeometry FindOutput();
  WorldReport Deform(const WorldRequest& request);

  /// Moves points as the volume is moved, or back to rest, on the host in double precision. Needs
  /// neither a volume nor a device.
  PointsReport DeformPoints(const PointsRequest& request);

  std::uint64_t GetDeviceMemory() const;
  void ReleaseMemory();

private:
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

  bool IsMesh() const { return this->Deformation == Deformations::Mesh; }
  const IndexDeformation& GetDeformation() const
  {
    return this->IsMesh() ? static_cast<const IndexDeformation&>(this->Mesh) : this->Field;
  }
  bool IsInverse() const { return this->GetDeformation().IsInverseField(); }
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
  /// Returns an array as it is resampled. Densities are floating-point numbers and, unless the
  /// field is an inverse one, divided by the volume ratios.
  VolumeArray GetSource(std::size_t array);
  /// Returns the arrays to resample: the arrays of the volume, and the additional arrays of the
  /// request.
  std::vector<VolumeArray> MakeArrays(
    const WorldRequest& request, const std::function<bool(double)>& progress);
  void SendMasks();
  void UpdateRestPositions();
  void UpdateJacobians(const std::function<bool(double)>& progress);
  Resampling ChooseMethod(
    const WorldRequest& request, const std::vector<VolumeArray>& arrays, const Extent& whole);
  void CheckMemory(const std::vector<VolumeArray>& arrays, const Extent& extent, Resampling method);
  void Send(const std::vector<VolumeArray>& arrays, Resampling method,
    const std::function<bool(double)>& progress);
  DeformRequest MakeRequest(const WorldRequest& request, const Extent& whole, Resampling method);
  /// Completes additional arrays and densities after resampling.
  void Finish(const WorldRequest& request, const Extent& extent);
  void FinishDensities(const WorldRequest& request, const float* jacobians, std::int64_t voxels);
  void Describe(const WorldRequest& request, const Extent& whole, WorldReport& report);

  DeviceSession Session;
  std::string DeviceRequest;
  std::uint64_t MemoryLimit = 0;
  std::optional<ImageGeometry> Volume;
  std::vector<WorldArray> Arrays;
  std::vector<std::vector<unsigned char>> DensityCopies; // memory of GetSource()
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

  SplitNodes Splits;

  // Additional arrays, and the data for which they were made.
  std::array<std::vector<float>, 3> RestPositions;
  std::optional<ImageGeometry> PositionsVolume;
  std::array<std::vector<float>, 3> PositionsOutput;
  VoxelJacobians MeshJacobians;
  std::uint64_t MeshJacobiansVersion = 0; // of the mapping
  std::vector<float> Jacobians;
  std::vector<float> Ratios;           // by which densities are divided; for meshes
  std::vector<float> JacobiansOutput;  // if only densities need them
  std::int64_t NumberOfLostVoxels = 0; // of densities, in the last output

  // The memory of the last output, if it can be updated incrementally.
  std::vector<void*> LastOutputs;
  signed char* LastCoverage = nullptr;
  Extent LastExtent = EmptyExtent;
};

} // namespace deformvolume

#endif
