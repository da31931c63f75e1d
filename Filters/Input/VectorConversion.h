// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorConversion_h
#define DeformVolumeVectorConversion_h

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>

namespace deformvolume
{

/// Makes displacements of vectors, by a matrix that takes these to them.
class VectorConversion
{
public:
  explicit VectorConversion(const glm::dmat3& toDisplacement);

  /// displacements: three floats each. Returns false where one is not finite, or over
  /// LargestDisplacement.
  bool Convert(const glm::dvec3* vectors, std::size_t count, float* displacements) const;

private:
  glm::dmat3 Matrix;
  glm::dvec3 Scaling;
  bool IsScaling; // axes stay axes
};

} // namespace deformvolume

#endif
