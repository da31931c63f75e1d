// SPDX-License-Identifier: BSD-3-Clause
#include "VectorConversion.h"

#include "DisplacementField.h"
#include "Error.h"
#include "IndexBounds.h" // for OutputTransform

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace deformvolume
{

namespace
{

// Converts vectors by any matrix. There are no branches, because there can be millions of vectors.
bool TransformVectors(
  const glm::dmat3& transform, const glm::dvec3* vectors, std::size_t count, float* displacements)
{
  int near = 1;
  for (std::size_t i = 0; i < count; ++i)
  {
    const glm::dvec3 move = transform * vectors[i];
    for (int axis = 0; axis < 3; ++axis)
    {
      // False for not-a-number, too.
      near &= std::abs(move[axis]) <= LargestDisplacement ? 1 : 0;
      displacements[3 * i + axis] = static_cast<float>(move[axis]);
    }
  }
  return near != 0;
}

// Converts vectors by a diagonal matrix.
bool ScaleVectors(
  const glm::dvec3& scaling, const glm::dvec3* vectors, std::size_t count, float* displacements)
{
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double), "vectors lie side by side");
  // The components of eight vectors at a time, so that compilers can vectorize the loops.
  constexpr std::size_t width = 24;
  const double* components = &vectors->x;
  std::array<double, width> factors;
  std::array<double, width> far{}; // not 0 if a component is too large or not-a-number
  for (std::size_t k = 0; k < width; ++k)
  {
    factors[k] = scaling[static_cast<int>(k % 3)];
  }
  const auto convert = [&](std::size_t i, std::size_t k)
  {
    const double move = factors[k] * components[i + k];
    displacements[i + k] = static_cast<float>(move);
    far[k] += std::abs(move) <= LargestDisplacement ? 0.0 : 1.0;
  };
  std::size_t i = 0;
  for (; i + width <= 3 * count; i += width)
  {
    for (std::size_t k = 0; k < width; ++k)
    {
      convert(i, k);
    }
  }
  for (std::size_t k = 0; i + k < 3 * count; ++k)
  {
    convert(i, k);
  }
  return std::all_of(far.begin(), far.end(), [](double number) { return number == 0.0; });
}

} // namespace

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

VectorConversion::VectorConversion(const glm::dmat3& toDisplacement)
  : Matrix(toDisplacement)
  , Scaling(toDisplacement[0][0], toDisplacement[1][1], toDisplacement[2][2])
  , IsScaling(toDisplacement == glm::dmat3(glm::scale(glm::dmat4(1.0), this->Scaling)))
{
}

bool VectorConversion::Convert(
  const glm::dvec3* vectors, std::size_t count, float* displacements) const
{
  return this->IsScaling ? ScaleVectors(this->Scaling, vectors, count, displacements)
                         : TransformVectors(this->Matrix, vectors, count, displacements);
}

} // namespace deformvolume
