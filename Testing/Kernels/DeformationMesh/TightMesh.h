// SPDX-License-Identifier: BSD-3-Clause
// A volume with a deformation mesh that ends within it, and what comes out by a search in double
// precision: every output voxel against every tetrahedron of the mesh. It shares nothing with the
// engine, the split of cells into five tetrahedra included.
#ifndef TightMesh_h
#define TightMesh_h

#include "StaticMapping.h"
#include "VolumeDeformer.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

struct TightMesh
{
  deformvolume::VoxelGrid Grid;
  std::vector<glm::dvec3> Points; // continuous indices of the volume
  std::vector<deformvolume::Tetrahedron> Tetrahedra;
  std::vector<float> Displacements; // in output voxels
  deformvolume::Extent Output;
  // Empty: none are blanked, all are active, nothing is clipped.
  std::vector<unsigned char> Blanked;
  std::vector<unsigned char> Active;
  std::vector<float> Distances;

  std::int64_t GetNumberOfVoxels() const
  {
    return deformvolume::GetNumberOfPoints(this->Grid.VertexExtent);
  }
  glm::dvec3 GetDeformed(std::int32_t node) const;
  /// Displaces the nodes, and makes the output large enough.
  void Move(const std::function<glm::dvec3(const glm::dvec3&)>& displacement);
};

/// The cubes of a lattice with this edge, turned by this matrix round a middle, whose middles lie
/// in a body, each in six tetrahedra. The boundary of the mesh is stairs at any angle.
TightMesh MakeTightMesh(const deformvolume::Extent& volume, double edge, const glm::dmat3& turn,
  const glm::dvec3& middle, const std::function<bool(const glm::dvec3&)>& isInside);

/// What an output voxel is to be.
struct TightVoxel
{
  /// 1: covered, 0: not covered, -1: so near to a surface that rounding decides.
  int Covered = -1;
  /// Of a covered one: weights of voxels of the volume, which add up to 1.
  std::array<std::int64_t, 4> Voxels{ { -1, -1, -1, -1 } };
  std::array<double, 4> Weights{ { 0, 0, 0, 0 } };
};

/// For each voxel of the output. Where tetrahedra of the mesh overlap after the deformation, the
/// voxel is left open, too.
std::vector<TightVoxel> FindTightVoxels(const TightMesh& mesh);

/// What the engine makes of it.
struct TightOutput
{
  std::vector<float> Values;
  std::vector<std::int16_t> Labels;
  std::vector<signed char> Coverage;
  deformvolume::DeformReport Report;
};

/// Noise, and labels without order: what a deformer of the test gets.
std::vector<float> MakeNoise(const TightMesh& mesh);
std::vector<std::int16_t> MakeLabels(const TightMesh& mesh);

/// Sets the volume, its masks, the mesh and its displacements.
void Load(deformvolume::VolumeDeformer& deformer, const TightMesh& mesh,
  deformvolume::StaticMappingForm form = deformvolume::StaticMappingForm::Automatic);
void SetMasks(deformvolume::VolumeDeformer& deformer, const TightMesh& mesh);
TightOutput DeformTight(deformvolume::VolumeDeformer& deformer, const TightMesh& mesh,
  deformvolume::Resampling method = deformvolume::Resampling::Exact,
  const TightOutput* last = nullptr,
  deformvolume::Interpolation interpolation = deformvolume::Interpolation::Linear);

/// Coverage as the search found it; where the map is affine, values and labels too. bound: of the
/// difference of values.
void ExpectTight(const TightMesh& mesh, const TightOutput& output, double bound);

/// To the last bit.
void ExpectSame(const TightOutput& one, const TightOutput& other);

#endif
