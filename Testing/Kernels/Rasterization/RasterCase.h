// SPDX-License-Identifier: BSD-3-Clause
// A volume with a deformation mesh for mesh rasterization, for the VolumeDeformer and for the
// reference on the host, and the comparison of their results.
#ifndef RasterCase_h
#define RasterCase_h

#include "DeformerCase.h"

/// The volume of most tests.
constexpr deformvolume::Extent Volume{ { -3, 18, 2, 16, -9, 5 } };

struct RasterCase
{
  deformvolume::VoxelGrid VoxelGrid;
  std::vector<deformvolume::Tetrahedron> Tetrahedra;
  /// Rest positions as continuous indices of the volume.
  std::vector<glm::dvec3> RestNodes;
  std::vector<float> Displacements;
  /// Empty: no voxel is blanked, all tetrahedra are active.
  std::vector<unsigned char> Blanked;
  std::vector<unsigned char> Active;
  deformvolume::Extent Output;

  std::int64_t GetNumberOfVoxels() const
  {
    return deformvolume::GetNumberOfPoints(this->VoxelGrid.VertexExtent);
  }
};

/// A mesh of cells x cells x cells cubes, of six tetrahedra each, over a box of continuous indices.
/// deformation maps an index of the volume to a continuous index of the output. The output contains
/// the result and margin voxels more on each side.
RasterCase MakeRasterCase(const deformvolume::VoxelGrid& voxelGrid, const glm::dvec3& low,
  const glm::dvec3& high, int cells,
  const std::function<glm::dvec3(const glm::dvec3&)>& deformation, int margin = 1);

/// The same, with a mesh that covers exactly the volume.
RasterCase MakeRasterCase(const deformvolume::Extent& extent, int cells,
  const std::function<glm::dvec3(const glm::dvec3&)>& deformation,
  const deformvolume::OutputMap& toOutput = {});

/// Sets the voxel grid, the arrays, the masks and the mesh.
void Load(deformvolume::VolumeDeformer& deformer, const RasterCase& rasterCase,
  const std::vector<deformvolume::VolumeArray>& arrays);

/// Runs a loaded deformer.
Deformed Rasterize(deformvolume::VolumeDeformer& deformer, const RasterCase& rasterCase,
  const std::vector<deformvolume::VolumeArray>& arrays,
  deformvolume::Interpolation interpolation = deformvolume::Interpolation::Linear);

/// Load and Rasterize on a new deformer.
Deformed LoadAndRun(const RasterCase& rasterCase,
  const std::vector<deformvolume::VolumeArray>& arrays,
  deformvolume::Interpolation interpolation = deformvolume::Interpolation::Linear);

/// Expects the same coverage and counters, and values within 1e-5 of the largest value of their
/// array.
void ExpectEqualsReference(const RasterCase& rasterCase,
  const std::vector<deformvolume::VolumeArray>& arrays, const Deformed& deformed,
  deformvolume::Interpolation interpolation = deformvolume::Interpolation::Linear);

#endif
