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
  std::array<float, 3> Least{};
  std::array<float, 3> Greatest{};
  bool AreFinite = false;
};

/// Of so many numbers, three a vector.
DEFORMVOLUME_EXPORT VectorComponents FindComponents(const float* values, std::size_t count);

/// The matrix of a field as it is applied (GetFactor).
using DisplacementFactors = std::array<double, 9>;
DisplacementFactors GetFactors(const DisplacementField& field);

/// What the displacements of a field lie between whose vectors lie between others, as they are
/// rounded. No displacement of such a vector leaves these bounds.
struct DisplacementRange
{
  std::array<double, 3> Least;
  std::array<double, 3> Greatest;
};
DisplacementRange GetRange(const DisplacementFactors& factors, const VectorComponents& components);

} // namespace deformvolume

#endif
