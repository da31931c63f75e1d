// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorConversion_h
#define DeformVolumeVectorConversion_h

#include "DeformVolumeExport.h"
#include "ImageGeometry.h"
#include "VoxelGrid.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <cstddef>

namespace deformvolume
{

/// Takes vectors in world units, times a factor, to displacements in output voxels. Its elements
/// are rounded (RoundFactor), so that vectors become the same displacements wherever that is done.
DEFORMVOLUME_EXPORT glm::dmat3 GetToDisplacement(
  const ImageGeometry& volume, const OutputMap& toOutput, double factor);

/// Throws an Error that says that a displacement is over LargestDisplacement.
[[noreturn]] DEFORMVOLUME_EXPORT void ThrowTooFar();

/// Makes displacements of vectors, by a matrix that takes these to them.
class DEFORMVOLUME_EXPORT VectorConversion
{
public:
  /// toDisplacement: GetToDisplacement() of the volume.
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
