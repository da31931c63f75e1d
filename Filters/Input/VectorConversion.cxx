// SPDX-License-Identifier: BSD-3-Clause
#include "VectorConversion.h"

#include "DisplacementField.h" // for LargestDisplacement

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace deformvolume
{

namespace
{

// Two ways to do it. Without branches, as there are millions.
template <typename T>
bool TransformVectors(
  const glm::dmat3& transform, const T* components, std::size_t count, float* displacements)
{
  int near = 1;
  for (std::size_t i = 0; i < count; ++i)
  {
    const T* next = components + 3 * i;
    const glm::dvec3 move = transform * glm::dvec3(next[0], next[1], next[2]);
    for (int axis = 0; axis < 3; ++axis)
    {
      // Not-a-number is not near either.
      near &= std::abs(move[axis]) <= LargestDisplacement ? 1 : 0;
      displacements[3 * i + axis] = static_cast<float>(move[axis]);
    }
  }
  return near != 0;
}

#ifdef __SSE2__
__m128d LoadPair(const double* numbers)
{
  return _mm_loadu_pd(numbers);
}
__m128d LoadPair(const float* numbers)
{
  return _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(numbers))));
}
#endif

// Where axes stay axes.
template <typename T>
bool ScaleVectors(
  const glm::dvec3& scaling, const T* components, std::size_t count, float* displacements)
{
  bool near = true;
  std::size_t i = 0;
#ifdef __SSE2__
  // Compilers do not find these by themselves. Twelve numbers at a time, of four vectors: every
  // third pair is of the same axes.
  constexpr std::size_t width = 12;
  const __m128d factors[3] = { _mm_set_pd(scaling.y, scaling.x), _mm_set_pd(scaling.x, scaling.z),
    _mm_set_pd(scaling.z, scaling.y) };
  const __m128d sign = _mm_set1_pd(-0.0);
  __m128d farthest = _mm_setzero_pd();
  __m128d others = _mm_setzero_pd(); // bits where not-a-number was, which a maximum may lose
  for (; i + width <= 3 * count; i += width)
  {
    for (std::size_t pair = 0; pair < width / 2; pair += 2)
    {
      const T* next = components + i + 2 * pair;
      const __m128d first = _mm_mul_pd(factors[pair % 3], LoadPair(next));
      const __m128d second = _mm_mul_pd(factors[(pair + 1) % 3], LoadPair(next + 2));
      farthest =
        _mm_max_pd(farthest, _mm_max_pd(_mm_andnot_pd(sign, first), _mm_andnot_pd(sign, second)));
      others = _mm_or_pd(others, _mm_cmpunord_pd(first, second));
      _mm_storeu_ps(
        displacements + i + 2 * pair, _mm_movelh_ps(_mm_cvtpd_ps(first), _mm_cvtpd_ps(second)));
    }
  }
  std::array<double, 2> distances;
  _mm_storeu_pd(distances.data(), farthest);
  near =
    std::max(distances[0], distances[1]) <= LargestDisplacement && _mm_movemask_pd(others) == 0;
#endif
  for (; i < 3 * count; ++i)
  {
    const double move = scaling[static_cast<int>(i % 3)] * static_cast<double>(components[i]);
    near &= std::abs(move) <= LargestDisplacement;
    displacements[i] = static_cast<float>(move);
  }
  return near;
}

} // namespace

VectorConversion::VectorConversion(const glm::dmat3& toDisplacement)
  : Matrix(toDisplacement)
  , Scaling(toDisplacement[0][0], toDisplacement[1][1], toDisplacement[2][2])
  , IsScaling(toDisplacement == glm::dmat3(glm::scale(glm::dmat4(1.0), this->Scaling)))
{
}

template <typename T>
bool VectorConversion::ConvertComponents(
  const T* components, std::size_t count, float* displacements) const
{
  return this->IsScaling ? ScaleVectors(this->Scaling, components, count, displacements)
                         : TransformVectors(this->Matrix, components, count, displacements);
}

bool VectorConversion::Convert(
  const glm::dvec3* vectors, std::size_t count, float* displacements) const
{
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double), "vectors lie side by side");
  return this->ConvertComponents(&vectors->x, count, displacements);
}

bool VectorConversion::Convert(const float* vectors, std::size_t count, float* displacements) const
{
  return this->ConvertComponents(vectors, count, displacements);
}

} // namespace deformvolume
