// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorComponents_h
#define DeformVolumeVectorComponents_h

#include "DeformVolumeExport.h"

#include <array>
#include <cstddef>

namespace deformvolume
{

struct DisplacementField;

/// The ranges of the three components of vectors, and whether all values are finite.
struct VectorComponents
{
  /// The least value of each component.
  std::array<float, 3> Min{};
  /// The greatest value of each component.
  std::array<float, 3> Max{};
  /// Whether all values are finite.
  bool AreFinite = false;
};

/// Computes the ranges of the components of vectors that are added part by part.
class DEFORMVOLUME_EXPORT ComponentFinder
{
public:
  /// No vectors have been added yet.
  ComponentFinder();
  /// Adds vectors. values: `count` numbers, three per vector.
  void Add(const float* values, std::size_t count);
  /// Returns the ranges of all added vectors.
  VectorComponents Get() const;

private:
  // 8 vectors are processed at a time, so that compilers vectorize the loop.
  static constexpr std::size_t Width = 24;
  std::array<float, Width> Min;
  std::array<float, Width> Max;
  std::array<int, Width> AreFinite;
};

/// Computes the ranges of the components. values: `count` numbers, three per vector.
DEFORMVOLUME_EXPORT VectorComponents FindComponents(const float* values, std::size_t count);

/// ToDisplacement of a field, with elements rounded by GetFactor().
using DisplacementFactors = std::array<double, 9>;
/// Returns the factors of a field.
DisplacementFactors GetFactors(const DisplacementField& field);

/// The range of the displacements of a field, from the ranges of its vectors. No rounded
/// displacement of a vector within these ranges exceeds it.
struct DisplacementRange
{
  /// The least displacement on each axis, in output voxels.
  std::array<double, 3> Min;
  /// The greatest displacement on each axis, in output voxels.
  std::array<double, 3> Max;
};
/// Returns the range of the displacements of vectors with these ranges of components.
DisplacementRange GetRange(const DisplacementFactors& factors, const VectorComponents& components);

} // namespace deformvolume

#endif
