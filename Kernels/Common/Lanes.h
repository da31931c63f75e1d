// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLanes_h
#define DeformVolumeLanes_h

#include <cmath>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

// Functions of lanes must be inlined into a function that is compiled for one instruction set: the
// baseline or, on x86, AVX2. Neither fuses multiplications and additions, so both give the same
// bits. As they are always inlined, the ABI of vector arguments (-Wpsabi) does not matter.
#if defined(__GNUC__) || defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif
#define DEFORMVOLUME_ALWAYS_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define DEFORMVOLUME_HAS_AVX2_CODE 1
#else
#define DEFORMVOLUME_HAS_AVX2_CODE 0
#endif

namespace deformvolume
{

/// The number of tetrahedra that one set of vector registers handles.
constexpr int NumberOfLanes = 4;
// State the alignment: code for AVX2 relies on it, and other instruction sets have a smaller
// default.
using Lanes = double __attribute__((
  vector_size(NumberOfLanes * sizeof(double)), aligned(NumberOfLanes * sizeof(double))));

using FloatLanes = float __attribute__((vector_size(NumberOfLanes * sizeof(float))));

/// Whether the processor has AVX2 and the AVX2 code is in use.
bool HasWideLanes();

/// Sets whether AVX2 code is used where the processor has it. Default: true. For tests.
void UseWideLanes(bool areUsed);

#if DEFORMVOLUME_HAS_AVX2_CODE
/// Calls a function that is compiled for AVX2. See RunOnLanes().
template <typename Function>
__attribute__((target("avx2"))) void RunOnWideLanes(const Function& function)
{
  function();
}
#endif

/// Calls a function that uses lanes, compiled for AVX2 if HasWideLanes(). The function must be a
/// lambda expression with the attribute always_inline.
template <typename Function>
void RunOnLanes(const Function& function)
{
#if DEFORMVOLUME_HAS_AVX2_CODE
  if (HasWideLanes())
  {
    RunOnWideLanes(function);
    return;
  }
#endif
  function();
}

DEFORMVOLUME_ALWAYS_INLINE Lanes MakeLanes(double value)
{
  return Lanes{ value, value, value, value };
}

DEFORMVOLUME_ALWAYS_INLINE Lanes SquareRoot(const Lanes& a)
{
#if defined(__SSE2__)
  const __m128d low = _mm_sqrt_pd(_mm_set_pd(a[1], a[0]));
  const __m128d high = _mm_sqrt_pd(_mm_set_pd(a[3], a[2]));
  return Lanes{ low[0], low[1], high[0], high[1] };
#else
  return Lanes{ std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3]) };
#endif
}

DEFORMVOLUME_ALWAYS_INLINE Lanes Absolute(const Lanes& a)
{
  return a < 0.0 ? -a : a;
}

DEFORMVOLUME_ALWAYS_INLINE Lanes Largest(const Lanes& a, const Lanes& b)
{
  return a < b ? b : a;
}

DEFORMVOLUME_ALWAYS_INLINE double SumOfLanes(const Lanes& a)
{
  return (a[0] + a[1]) + (a[2] + a[3]);
}

/// A vector of three components in each lane.
struct LaneVector
{
  Lanes X;
  Lanes Y;
  Lanes Z;
};

DEFORMVOLUME_ALWAYS_INLINE Lanes Dot(const LaneVector& a, const LaneVector& b)
{
  return a.X * b.X + a.Y * b.Y + a.Z * b.Z;
}

DEFORMVOLUME_ALWAYS_INLINE LaneVector Cross(const LaneVector& a, const LaneVector& b)
{
  return { a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z, a.X * b.Y - a.Y * b.X };
}

DEFORMVOLUME_ALWAYS_INLINE LaneVector Scale(const LaneVector& a, const Lanes& factor)
{
  return { a.X * factor, a.Y * factor, a.Z * factor };
}

DEFORMVOLUME_ALWAYS_INLINE LaneVector Add(const LaneVector& a, const LaneVector& b)
{
  return { a.X + b.X, a.Y + b.Y, a.Z + b.Z };
}

DEFORMVOLUME_ALWAYS_INLINE LaneVector Subtract(const LaneVector& a, const LaneVector& b)
{
  return { a.X - b.X, a.Y - b.Y, a.Z - b.Z };
}

/// A 3 x 3 matrix in each lane, by columns.
struct LaneMatrix
{
  LaneVector Columns[3];
};

DEFORMVOLUME_ALWAYS_INLINE LaneVector Multiply(const LaneMatrix& a, const LaneVector& b)
{
  return Add(Add(Scale(a.Columns[0], b.X), Scale(a.Columns[1], b.Y)), Scale(a.Columns[2], b.Z));
}

/// The transposed matrix times a vector.
DEFORMVOLUME_ALWAYS_INLINE LaneVector MultiplyTransposed(const LaneMatrix& a, const LaneVector& b)
{
  return { Dot(a.Columns[0], b), Dot(a.Columns[1], b), Dot(a.Columns[2], b) };
}

} // namespace deformvolume

#endif
