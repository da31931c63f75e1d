// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeWorldDeformer_h
#define DeformVolumeWorldDeformer_h

#include "DeformRequest.h"
#include "DeformVolumeExport.h"
#include "DeviceVectors.h"
#include "ImageGeometry.h"
#include "OutsideVoxels.h"
#include "VectorView.h"
#include "VolumeArray.h"
#include "WorldMesh.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace deformvolume
{

/// What says which voxels and tetrahedra of the volume there are; see VolumeDeformer. Null: all.
struct WorldMasks
{
  const unsigned char* Blanked = nullptr;
  const unsigned char* ActiveTetrahedra = nullptr;
  const float* BoundaryDistances = nullptr;
  /// A smooth cut; both or none.
  const unsigned char* CutTetrahedra = nullptr;
  const float* CutDistances = nullptr;
};

/// Which extent and spacing the output has where there is no reference grid.
struct OutputSettings
{
  enum class BoundsModes
  {
    Deformed, // those of the deformed volume
    Volume,
    Custom
  };
  BoundsModes Bounds = BoundsModes::Deformed;
  /// In world coordinates: x min, x max, y min, ...
  std::array<double, 6> CustomBounds{ { 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 } };
  int Padding = 0; // voxels on all sides
  /// None: that of the volume.
  std::optional<glm::dvec3> Spacing;
};

/// An array of a volume.
struct WorldArray : VolumeArray
{
  /// The values are amounts for each unit of volume: they are divided by the Jacobian, and become
  /// floats, or stay doubles. Not for labels.
  bool IsDensity = false;
};

struct WorldRequest
{
  /// Empty: the whole output.
  Extent OutputExtent{ { 0, -1, 0, -1, 0, -1 } };
  deformvolume::Interpolation Interpolation = deformvolume::Interpolation::Linear;
  /// All arrays are resampled as if they were categorical.
  bool IsNearest = false;
  /// Keeps what is needed to write only what changes until the next call. Where that has the same
  /// memory again, it must still hold what this call wrote. Not together with the arrays below.
  bool IsIncremental = false;
  /// Room for the output of each array, of doubles or floats for a density, and for one byte a
  /// voxel: 1 where the deformed volume covers it, else 0.
  std::vector<void*> Outputs;
  signed char* Coverage = nullptr;
  ///@{
  /// Room for arrays besides those of the volume, or null: the world position at rest of what is
  /// seen, three floats a voxel; the determinant of the derivative of deformed positions, a float;
  /// how many tetrahedra of the sampling mesh hold the voxel.
  float* RestPositions = nullptr;
  float* Jacobians = nullptr;
  std::uint32_t* FoldCounts = nullptr;
  ///@}
  double Background = 0.0; // of these
  /// Called in the thread that called Deform() alone, with the fraction done; false aborts.
  std::function<bool(double)> Progress;
};

struct WorldReport : DeformReport
{
  std::string Device;
  Resampling Method = Resampling::Exact;
  /// One after the other; "" without such.
  std::string Warnings;
};

/// Deforms a volume that lies in the world, by a mesh or a field that does: what
/// vtkDeformVolumeFilter does with whole data, with the same bits, without VTK. What has not
/// changed since the last call is kept. Every failure is an Error; the object can be used again.
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

  /// Forgets arrays and masks where it is another geometry.
  void SetVolume(const ImageGeometry& volume);
  /// The data are borrowed until other arrays are set. They have changed, as far as is known.
  void SetArrays(const std::vector<WorldArray>& arrays);
  /// Borrowed as well.
  void SetMasks(const WorldMasks& masks);

  ///@{
  /// A mesh with displacements, or a field: the last one that was set counts. Without one all of
  /// the volume stays where it is. See WorldMesh and VectorField.
  void SetMesh(const VectorView& points, MeshCells&& cells);
  void SetNodeVectors(const VectorView& vectors);
  void SetField(const ImageGeometry& grid, const VectorView& vectors, bool isInverse);
  void SetField(const ImageGeometry& grid, const std::shared_ptr<DeviceVectors>& vectors);
  ///@}

  void SetOutside(const OutsideVoxels& outside);
  /// The grid of the output, with its whole extent.
  void SetReference(const std::optional<ImageGeometry>& reference);
  void SetOutput(const OutputSettings& settings);

  /// The grid of the output, with its whole extent.
  ImageGeometry FindOutput();
  WorldReport Deform(const WorldRequest& request);

  std::uint64_t GetDeviceMemory() const;
  void ReleaseMemory();

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
