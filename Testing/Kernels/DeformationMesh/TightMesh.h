// SPDX-License-Identifier: BSD-3-Clause
// A volume with a deformation mesh that ends within it, and its expected output by a search in
// double precision: every output voxel is compared with every tetrahedron of the mesh. It shares
// nothing with the engine, not even the split of cells into five tetrahedra.
#ifndef TightMesh_h
#define TightMesh_h

#include "DeformerCase.h"
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
  // If an array is empty: no voxel is blanked, all tetrahedra are active, nothing is clipped.
  std::vector<unsigned char> Blanked;
  std::vector<unsigned char> Active;
  std::vector<float> Distances;

  std::int64_t GetNumberOfVoxels() const
  {
    return deformvolume::GetNumberOfPoints(this->Grid.VertexExtent);
  }
  glm::dvec3 GetDeformed(std::int32_t node) const;
  /// Displaces the nodes, and enlarges the output to contain the deformed mesh.
  void Move(const std::function<glm::dvec3(const glm::dvec3&)>& displacement);
};

/// Makes a mesh of those cubes of a lattice whose centers lie in a body, with six tetrahedra each.
/// edge: of the cubes. The lattice is rotated by a matrix around a center. The boundary of the mesh
/// is a staircase at any angle.
TightMesh MakeTightMesh(const deformvolume::Extent& volume, double edge, const glm::dmat3& turn,
  const glm::dvec3& middle, const std::function<bool(const glm::dvec3&)>& isInside);

/// The expected value of an output voxel.
struct TightVoxel
{
  /// 1: covered, 0: not covered, -1: so near a surface that rounding decides.
  int Covered = -1;
  /// The weights of voxels of the volume, if covered. They add up to 1.
  std::array<std::int64_t, 4> Voxels{ { -1, -1, -1, -1 } };
  std::array<double, 4> Weights{ { 0, 0, 0, 0 } };
};

/// Finds the expected value of each output voxel. Covered is -1 where tetrahedra of the mesh
/// overlap after the deformation.
std::vector<TightVoxel> FindTightVoxels(const TightMesh& mesh);

/// The output of the engine.
struct TightOutput
{
  std::vector<std::int16_t> Shorts;
  std::vector<float> Values;
  std::vector<std::uint16_t> Labels; // two per voxel
  std::vector<signed char> Coverage;
  deformvolume::DeformReport Report;
};

/// The arrays of the tests. The floats are noise between 0 and 1.
UsualArrays MakeTightArrays(const TightMesh& mesh);

/// Sets the volume, its masks, the mesh and its displacements.
void Load(deformvolume::VolumeDeformer& deformer, const TightMesh& mesh,
  deformvolume::StaticMappingForm form = deformvolume::StaticMappingForm::Automatic);
void SetMasks(deformvolume::VolumeDeformer& deformer, const TightMesh& mesh);
TightOutput DeformTight(deformvolume::VolumeDeformer& deformer, const TightMesh& mesh,
  deformvolume::Resampling method = deformvolume::Resampling::Exact,
  const TightOutput* last = nullptr,
  deformvolume::Interpolation interpolation = deformvolume::Interpolation::Linear);

/// Compares the coverage of outputs with the search. Where the map is affine, compares values and
/// labels as well. bound: the largest allowed difference of values.
void ExpectTight(const TightMesh& mesh, const std::vector<TightOutput>& outputs, double bound);

/// Expects equality bit for bit.
void ExpectSame(const TightOutput& one, const TightOutput& other);

#endif
