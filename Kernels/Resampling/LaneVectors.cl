// SPDX-License-Identifier: BSD-3-Clause
// Vectors of LANES floats or integers, for kernels with explicit vector lanes. The host defines before this text:
//   LANES  16, 8 or 4: number of floats in a vector; 1 for devices whose work-items are the lanes

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#if LANES > 1
#define FLOATS JOIN(float, LANES)
#define INTS JOIN(int, LANES)
#define LOAD(p) JOIN(vload, LANES)(0, p)
#define TO_FLOATS JOIN(convert_float, LANES)
#define TO_INTS JOIN(convert_int, LANES)
#define AS_INTS JOIN(as_int, LANES)
// A value where a mask is set, otherwise 0.
#define WHERE(mask, v) ((mask) & (v))
// COLD: attribute of functions that are rarely called. UNROLLED: for loops whose arrays stay out of registers
// otherwise.
#define COLD __attribute__((noinline))
#define UNROLLED
#define NOT_UNROLLED
#else
// For scalars a comparison gives 1, not -1. So combine masks by & and |, use ~ only next to &, and do not use masks
// as bits of values.
#define FLOATS float
#define INTS int
#define LOAD(p) (*(p))
#define TO_FLOATS convert_float
#define TO_INTS convert_int
#define AS_INTS as_int
#define WHERE(mask, v) ((mask) ? (v) : 0)
#if HAS_COLUMN_KERNEL
#define COLD // a call would save all registers to memory
#else
#define COLD __attribute__((noinline))
#endif
#define UNROLLED _Pragma("unroll")
#define NOT_UNROLLED _Pragma("unroll 1")
#endif

#if LANES > 1
// Unaligned vectors. Storing through these types takes one instruction; vstore16 of PoCL 3.1 takes three.
typedef float16 __attribute__((aligned(4))) UnalignedFloat16;
typedef float8 __attribute__((aligned(4))) UnalignedFloat8;
typedef int16 __attribute__((aligned(4))) UnalignedInt16;
#endif

#if LANES > 1
static FLOATS Min(FLOATS a, FLOATS b)
{
  return a < b ? a : b;
}

static FLOATS Max(FLOATS a, FLOATS b)
{
  return a > b ? a : b;
}
#else
// One instruction; a comparison and a selection would be two.
#define Min fmin
#define Max fmax
#endif

// 1 / v with an error of one or two units in the last place, for numbers that are neither tiny nor huge.
#ifdef __NV_CL_C_VERSION
#define INVERSE(v) native_recip(v) // a division would also scale the operands
#else
#define INVERSE(v) (1.0f / (v))
#endif

#if LANES == 16
#define LANE_INDEX ((INTS)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))
#elif LANES == 8
#define LANE_INDEX ((INTS)(0, 1, 2, 3, 4, 5, 6, 7))
#elif LANES == 4
#define LANE_INDEX ((INTS)(0, 1, 2, 3))
#else
#define LANE_INDEX 0
#endif
#define LANE_BITS ((INTS)(1) << LANE_INDEX)

#if LANES > 1
// Shifts by one lane: lanes from the second one on, then the first lane of another vector. One instruction with
// clang's builtin, five for a vector literal with PoCL 3.1.
static FLOATS NextLanes(FLOATS v, FLOATS behind)
{
#if LANES == 16 && defined(__clang__)
  return __builtin_shufflevector(
    v, behind, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
#elif LANES == 16
  return (FLOATS)(v.s1, v.s23, v.s4567, v.s89abcdef, behind.s0);
#elif LANES == 8 && defined(__clang__)
  return __builtin_shufflevector(v, behind, 1, 2, 3, 4, 5, 6, 7, 8);
#elif LANES == 8
  return (FLOATS)(v.s1, v.s23, v.s4567, behind.s0);
#else
  return (FLOATS)(v.s1, v.s23, behind.s0);
#endif
}
#endif

// A vector that is read lane by lane.
typedef union
{
  INTS Vector;
  int Lanes[LANES];
} Lanes;

// Returns a bit for each lane that is set.
static uint LaneBits(INTS mask)
{
#if LANES == 1
  return mask != 0;
#elif LANES == 8 && defined(__AVX__)
  return __builtin_ia32_movmskps256(as_float8(mask));
#elif LANES == 16 && defined(__AVX512DQ__)
  return __builtin_ia32_cvtd2mask512(mask);
#else
  const INTS bits = mask & LANE_BITS;
#if LANES == 16
  const int8 a = bits.lo | bits.hi;
  const int4 b = a.lo | a.hi;
#elif LANES == 8
  const int4 b = bits.lo | bits.hi;
#else
  const int4 b = bits;
#endif
  const long2 c = as_long2(b);
  const long d = c.x | c.y;
  return (uint)d | (uint)(d >> 32);
#endif
}

static INTS LanesOf(uint bits)
{
  return ((INTS)bits & LANE_BITS) != 0;
}

#if LANES > 1
// Writes the lanes with set bits consecutively to memory. Values after these, up to LANES in all, may be overwritten.
static void Append(INTS v, uint bits, int* target)
{
#if LANES == 16 && defined(__AVX512F__)
  *(UnalignedInt16*)target = __builtin_ia32_compresssi512_mask(v, v, bits);
#else
  Lanes lanes;
  lanes.Vector = v;
  for (int lane = 0; lane < LANES; ++lane)
  {
    *target = lanes.Lanes[lane];
    target += bits >> lane & 1;
  }
#endif
}
#endif

// Loops over the set bits, the highest first. lane: number of the bit.
#define FOR_EACH_LANE(lane, bits)                                                                  \
  for (int lane = 31 - clz(bits); lane >= 0; bits ^= 1u << lane, lane = 31 - clz(bits))

// Returns the largest lane.
static int MaxOf(INTS v)
{
#if LANES == 1
  return v;
#else
#if LANES == 16
  const int8 a = max(v.lo, v.hi);
  const int4 b = max(a.lo, a.hi);
#elif LANES == 8
  const int4 b = max(v.lo, v.hi);
#else
  const int4 b = v;
#endif
  const int2 c = max(b.lo, b.hi);
  return max(c.x, c.y);
#endif
}

// Return the largest and the smallest of the lanes in a mask.
static int MaxAmong(INTS mask, INTS v)
{
  return MaxOf(mask ? v : (INTS)INT_MIN);
}

static int MinAmong(INTS mask, INTS v)
{
  return ~MaxAmong(mask, ~v);
}
