// SPDX-License-Identifier: BSD-3-Clause
// A volume with a displacement of each voxel, for a VolumeDeformer and for the host reference, and
// the comparison of their results.
//
// Displacements are multiples of 1/256 output voxel. Scales are powers of two or small multiples of
// them. Positions are therefore exact in floats, and rounding does not change them: both sides see
// the same tetrahedra, so coverage and winners must agree voxel by voxel.
#ifndef DeformerCase_h
#define DeformerCase_h

#include "Reference.h"
#include "VolumeDeformer.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

/// How the displacements are given to the deformer.
enum class Route
{
  /// As a displacement field whose points are the voxels.
  Field,
  /// As a mesh with a node for each voxel and a link for each voxel.
  Mesh,
  /// As the same mesh with runs of neighboring voxels that move alike.
  Runs
};

struct DeformerCase
{
  deformvolume::VoxelGrid VoxelGrid;
  /// The displacement of each voxel, in 1/256 output voxel.
  std::vector<reference::Position> Displacements;
  /// If an array is empty: no voxel is unlinked, no voxel is blanked, all tetrahedra are active.
  std::vector<bool> Unlinked;
  std::vector<unsigned char> Blanked;
  std::vector<unsigned char> Active;
  std::vector<float> Distances;       // from the boundary; empty: nothing is clipped
  std::vector<unsigned char> Crossed; // by a smooth cut; empty: there is no smooth cut
  std::vector<float> CutDistances;
  deformvolume::Extent Output;

  /// Returns the displacements in output voxels, three numbers per voxel.
  std::vector<float> GetDisplacements() const;
  std::int64_t GetNumberOfVoxels() const
  {
    return deformvolume::GetNumberOfPoints(this->VoxelGrid.VertexExtent);
  }
};

/// The scale of a map to output voxels that have the size of the volume's voxels.
constexpr std::array<double, 3> NoScale{ { 1, 1, 1 } };

/// Makes a case from a map of structured indices to continuous output indices, which are rounded to
/// 1/256. The output becomes the bounds of the result, enlarged by margin voxels.
DeformerCase MakeCase(const deformvolume::Extent& extent, const deformvolume::OutputMap& toOutput,
  const std::function<glm::dvec3(const glm::dvec3&)>& deformation, int margin = 1);

/// Adds a smooth cut with distances of random sign. One of `every` cells has crossed tetrahedra.
/// Distances are multiples of 1/16, so the kernels and the reference add them without rounding.
void CutAtRandom(DeformerCase& made, unsigned int seed, unsigned int every);

/// Adds a smooth cut at the zeros of a function of the index. It crosses the wanted cells among
/// those that have vertices on both sides.
void CutAlong(
  DeformerCase& made, const std::function<double(const glm::dvec3&)>& distance,
  const std::function<bool(const glm::dvec3&)>& isWanted = [](const glm::dvec3&) { return true; });

reference::Result ResampleByReference(const DeformerCase& deformerCase);

/// Which node of its tetrahedron a voxel is. The node changes from voxel to voxel, so that all four
/// weights are tested.
inline int GetCorner(std::int64_t voxel)
{
  return static_cast<int>(voxel % 4);
}

/// The runs of Route::Runs. Each begins at the voxel whose tetrahedron it uses.
deformvolume::VertexRuns MakeRuns(const DeformerCase& deformerCase);

/// Sets the voxel grid, the arrays, the masks and the deformation.
void Load(deformvolume::VolumeDeformer& deformer, const DeformerCase& deformerCase,
  const std::vector<deformvolume::VolumeArray>& arrays, Route route);

/// Moves a volume that was loaded with Route::Field.
void MoveByField(deformvolume::VolumeDeformer& deformer, const DeformerCase& deformerCase);

struct Deformed
{
  /// One output for each array of the volume, padded by guard bytes that must not change.
  std::vector<std::vector<unsigned char>> Outputs;
  std::vector<signed char> Coverage;
  deformvolume::DeformReport Report;
  deformvolume::Resampling Method = deformvolume::Resampling::Exact;
  /// The result of the kernel by cells, if no method was requested.
  std::shared_ptr<Deformed> ByCell;
  /// The result of the kernel by columns, if no method was requested.
  std::shared_ptr<Deformed> ByColumns;

  template <typename T>
  const T* GetOutput(int array) const
  {
    return reinterpret_cast<const T*>(this->Outputs[array].data());
  }
};

/// Runs a loaded deformer, and checks that it writes all of its arrays and nothing beyond them.
Deformed RunDeformer(deformvolume::VolumeDeformer& deformer, const DeformerCase& deformerCase,
  const std::vector<deformvolume::VolumeArray>& arrays,
  deformvolume::Resampling method = deformvolume::Resampling::Exact,
  deformvolume::Interpolation interpolation = deformvolume::Interpolation::Linear);

/// Calls Load and RunDeformer on a new deformer: with the kernel of its choice, by cells and by
/// columns.
Deformed LoadAndRun(const DeformerCase& deformerCase,
  const std::vector<deformvolume::VolumeArray>& arrays, Route route = Route::Field);

/// Compares coverage, counts and all values with the reference, also the results by cells and by
/// columns. Values of arrays that are resampled by lanes have single precision, all others the
/// precision of the reference. Results by columns must equal those by lanes bit for bit.
void ExpectEqualsReference(const DeformerCase& deformerCase, const reference::Result& reference,
  const std::vector<deformvolume::VolumeArray>& arrays, const Deformed& deformed);

/// Compares the result of a new deformer, with the usual arrays.
void ExpectEqualsReference(const DeformerCase& deformerCase, Route route = Route::Field);

/// Checks that there are no holes, and no voxels that more than one tetrahedron writes.
void ExpectEmbedding(const reference::Result& reference);

/// Random bits, among them extreme values; for floating-point types also infinities, NaN and -0.
template <typename T>
std::vector<T> MakeRandomBits(std::size_t size, unsigned int seed);

/// Random values from the whole range of an integer type, or from -1000 to 1000.
template <typename T>
std::vector<T> MakeRandomValues(std::size_t size, unsigned int seed);

template <typename T>
deformvolume::ElementType GetElementType();
#define DECLARE(name, type, cl)                                                                    \
  template <>                                                                                      \
  inline deformvolume::ElementType GetElementType<type>()                                          \
  {                                                                                                \
    return deformvolume::ElementType::name;                                                        \
  }
DEFORMVOLUME_ELEMENT_TYPES(DECLARE)
#undef DECLARE

template <typename T>
deformvolume::VolumeArray MakeArray(
  const std::vector<T>& values, int components = 1, bool categorical = false, double background = 0)
{
  deformvolume::VolumeArray array;
  array.Data = values.data();
  array.Type = GetElementType<T>();
  array.Components = components;
  array.Categorical = categorical;
  array.Background = background;
  return array;
}

/// One array of each kind that the kernels handle differently: integers and floats that are
/// resampled by lanes, and labels that are not. Kernels are compiled for each list of types, which
/// takes seconds. Tests that need no other types therefore use these arrays.
struct UsualArrays
{
  explicit UsualArrays(std::size_t voxels);

  std::vector<std::int16_t> Shorts;
  std::vector<float> Floats;
  std::vector<std::uint16_t> Labels; // two components per voxel

  /// Returns the arrays in the order of the members.
  std::vector<deformvolume::VolumeArray> Get() const;
};

/// A random rotation plus random entries from -distortion to distortion. The matrix is neither
/// singular nor mirrored.
glm::dmat3 MakeRandomMatrix(std::mt19937& random, double distortion = 0.3);

/// Random displacements of up to amplitude voxels on each axis, independent for each voxel.
std::function<glm::dvec3(const glm::dvec3&)> MakeJitter(unsigned int seed, double amplitude);

#endif
