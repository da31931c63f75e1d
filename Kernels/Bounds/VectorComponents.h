// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorComponents_h
#define DeformVolumeVectorComponents_h

#include "DeformVolumeExport.h"

#include <array>
#include <cstddef>

namespace deformvolume
{

struct DisplacementField;

/// What the three components of some vectors lie between, and whether all are finite.
struct VectorComponents
{
  /// The least value of each component.
  std::array<float, 3> Least{};
  /// The greatest value of each component.
  std::array<float, 3> Greatest{};
  /// Whether no value is infinite or not-a-number.
  bool AreFinite = false;
};

/// Of so many numbers, three a vector.
DEFORMVOLUME_EXPORT VectorComponents FindComponents(const float* values, std::size_t count);

/// The matrix of a field as it is applied (GetFactor).
using DisplacementFactors = std::array<double, 9>;
/// The factors of a field.
DisplacementFactors GetFactors(const DisplacementField& field);

/// What the displacements of a field lie between whose vectors lie between others, as they are
/// rounded. No displacement of such a vector leaves these bounds.
struct DisplacementRange
{
  /// The least displacement on each axis, in output voxels.
  std::array<double, 3> Least;
  /// The greatest displacement on each axis, in output voxels.
  std::array<double, 3> Greatest;
};
/// The range of the displacements of vectors between these.
DisplacementRange GetRange(const DisplacementFactors& factors, const VectorComponents& components);

} // namespace deformvolume

#endif
