// SPDX-License-Identifier: BSD-3-Clause
// A volume with a displacement of each of its voxels, given to a VolumeDeformer and to the host
// reference alike, and the comparison of what the two make of it.
//
// Displacements are whole numbers of 1/256 output voxel and scales are powers of two or small
// multiples of them, so that positions are exact in float and rounding them changes nothing: both
// sides then see the same tetrahedra, and coverage and winner must agree voxel by voxel.
#ifndef DeformerCase_h
#define DeformerCase_h

#include "Reference.h"
#include "VolumeDeformer.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

/// How the displacements reach the deformer.
enum class Route
{
  /// A displacement field whose points are the voxels.
  Field,
  /// A mesh with a node for each voxel, and a link for each.
  Mesh,
  /// The same mesh with runs: of neighbours that move alike.
  Runs
};

struct DeformerCase
{
  deformvolume::VoxelGrid VoxelGrid;
  /// In 1/256 output voxel, one a voxel.
  std::vector<reference::Position> Displacements;
  /// Empty: none are unlinked, none blanked, all active.
  std::vector<bool> Unlinked;
  std::vector<unsigned char> Blanked;
  std::vector<unsigned char> Active;
  std::vector<float> Distances;       // to the boundary; empty: nothing is clipped
  std::vector<unsigned char> Crossed; // by a smooth cut; empty: there is none
  std::vector<float> CutDistances;
  deformvolume::Extent Output;

  /// In output voxels, x, y and z of each voxel.
  std::vector<float> GetDisplacements() const;
  std::int64_t GetNumberOfVoxels() const
  {
    return deformvolume::GetNumberOfPoints(this->VoxelGrid.VertexExtent);
  }
};

/// The structured index of each voxel goes to a continuous output index, which is rounded to 1/256.
/// The output becomes the bounds of the result and margin voxels more.
DeformerCase MakeCase(const deformvolume::Extent& extent, const deformvolume::OutputMap& toOutput,
  const std::function<glm::dvec3(const glm::dvec3&)>& deformation, int margin = 1);

/// Adds a smooth cut with distances of random sign; of the cells one in `every` has tetrahedra that
/// are crossed. Distances are multiples of 1/16: the kernels and the reference add them up without
/// rounding.
void CutAtRandom(DeformerCase& made, unsigned int seed, unsigned int every);

/// Adds a smooth cut where a function of the index is 0: it crosses the wanted ones of the cells
/// that have vertices on both sides.
void CutAlong(
  DeformerCase& made, const std::function<double(const glm::dvec3&)>& distance,
  const std::function<bool(const glm::dvec3&)>& isWanted = [](const glm::dvec3&) { return true; });

reference::Result ResampleByReference(const DeformerCase& deformerCase);

/// Which of the nodes of its tetrahedron a voxel is: it changes from voxel to voxel, so that all
/// four weights count.
inline int GetCorner(std::int64_t voxel)
{
  return static_cast<int>(voxel % 4);
}

/// The runs of Route::Runs: each begins with the voxel whose tetrahedron it takes.
deformvolume::VertexRuns MakeRuns(const DeformerCase& deformerCase);

/// Sets the voxel grid, the arrays, the masks and the deformation.
void Load(deformvolume::VolumeDeformer& deformer, const DeformerCase& deformerCase,
  const std::vector<deformvolume::VolumeArray>& arrays, Route route);

/// Moves a volume that has been loaded with Route::Field.
void MoveByField(deformvolume::VolumeDeformer& deformer, const DeformerCase& deformerCase);

struct Deformed
{
  /// One for each array of the volume, and padded by guard bytes that must survive.
  std::vector<std::vector<unsigned char>> Outputs;
  std::vector<signed char> Coverage;
  deformvolume::DeformReport Report;
  deformvolume::Resampling Method = deformvolume::Resampling::Exact;
  /// The same by the kernel that takes one cell after the other, where the method is left open.
  std::shared_ptr<Deformed> ByCell;
  /// And by the kernel for graphics cards.
  std::shared_ptr<Deformed> ByColumns;

  template <typename T>
  const T* GetOutput(int array) const
  {
    return reinterpret_cast<const T*>(this->Outputs[array].data());
  }
};

/// Runs a loaded deformer and checks that it writes inside its arrays and all of them.
Deformed RunDeformer(deformvolume::VolumeDeformer& deformer, const DeformerCase& deformerCase,
  const std::vector<deformvolume::VolumeArray>& arrays,
  deformvolume::Resampling method = deformvolume::Resampling::Exact,
  deformvolume::Interpolation interpolation = deformvolume::Interpolation::Linear);

/// Load and RunDeformer on a new deformer, by the kernel of its choice, cell by cell and by
/// columns.
Deformed LoadAndRun(const DeformerCase& deformerCase,
  const std::vector<deformvolume::VolumeArray>& arrays, Route route = Route::Field);

/// Coverage, counts and all values against the reference, also those found cell by cell and by
/// columns. Values of arrays that go by lanes have single precision, all others the precision of
/// the reference. By columns they are the same as by lanes, to the last bit.
void ExpectEqualsReference(const DeformerCase& deformerCase, const reference::Result& reference,
  const std::vector<deformvolume::VolumeArray>& arrays, const Deformed& deformed);

/// The same on a new deformer, with the usual arrays.
void ExpectEqualsReference(const DeformerCase& deformerCase, Route route = Route::Field);

/// No hole and no voxel that more than one tetrahedron writes.
void ExpectEmbedding(const reference::Result& reference);

/// Bits of every kind: extremes, and for floating-point types infinities, NaN and -0.
template <typename T>
std::vector<T> MakeRandomBits(std::size_t size, unsigned int seed);

/// Values of the whole range of an integer type, or of -1000 to 1000.
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

/// An array of each kind that the kernels of the resampling treat in a way of its own: integers and
/// floats that go by lanes, and labels that do not. Kernels are compiled for each list of types,
/// which takes seconds: a test that needs no others has these.
struct UsualArrays
{
  explicit UsualArrays(std::size_t voxels);

  std::vector<std::int16_t> Shorts;
  std::vector<float> Floats;
  std::vector<std::uint16_t> Labels; // two of each voxel

  /// In this order.
  std::vector<deformvolume::VolumeArray> Get() const;
};

/// A map with entries of -0.5 to 0.5 on top of a random rotation, neither flat nor mirrored.
glm::dmat3 MakeRandomMatrix(std::mt19937& random, double distortion = 0.3);

/// Displacements of up to amplitude voxels on each axis, independent from voxel to voxel.
std::function<glm::dvec3(const glm::dvec3&)> MakeJitter(unsigned int seed, double amplitude);

#endif
