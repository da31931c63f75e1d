// SPDX-License-Identifier: BSD-3-Clause
#include "VectorConversion.h"

#include "DisplacementField.h"
#include "Error.h"
#include "IndexBounds.h" // for OutputTransform

#include <cmath>

namespace deformvolume
{

glm::dmat3 GetToDisplacement(const ImageGeometry& volume, const OutputMap& toOutput, double factor)
{
  const glm::dmat3 toVolume(volume.GetWorldToIndex());
  const glm::dvec3 scale(toOutput.Get(0, 0), toOutput.Get(1, 1), toOutput.Get(2, 2));
  const OutputTransform map(toOutput);
  glm::dmat3 transform;
  for (int column = 0; column < 3; ++column)
  {
    transform[column] = toOutput.IsDiagonal() ? toVolume[column] * (scale * factor)
                                              : map.GetMatrix() * toVolume[column] * factor;
    for (int row = 0; row < 3; ++row)
    {
      transform[column][row] = RoundFactor(transform[column][row]);
    }
  }
  return transform;
}

void ThrowTooFar()
{
  throw Error(
    "The deformation moves the volume by more than 16,383 output voxels. Check the scale of the "
    "displacements, the spacing of the output or of its reference image, and that displacements "
    "and volume are in the same world units.");
}

bool ConvertVectors(const glm::dmat3& toDisplacement, const glm::dvec3* vectors, std::size_t count,
  float* displacements)
{
  // There are no branches, because there can be millions of vectors.
  int near = 1;
  for (std::size_t i = 0; i < count; ++i)
  {
    const glm::dvec3 move = toDisplacement * vectors[i];
    for (int axis = 0; axis < 3; ++axis)
    {
      // False for not-a-number, too.
      near &= std::abs(move[axis]) <= LargestDisplacement ? 1 : 0;
      displacements[3 * i + axis] = static_cast<float>(move[axis]);
    }
  }
  return near != 0;
}

} // namespace deformvolume
