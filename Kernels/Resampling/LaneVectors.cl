// SPDX-License-Identifier: BSD-3-Clause
// Vectors of LANES floats or integers, for the kernels that say themselves what the lanes of a processor's vectors
// do. What the host puts in front of this text:
//   LANES  16, 8 or 4: floats in a vector; 1 for devices whose work-items are the lanes

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#if LANES > 1
#define FLOATS JOIN(float, LANES)
#define INTS JOIN(int, LANES)
#define LOAD(p) JOIN(vload, LANES)(0, p)
#define TO_FLOATS JOIN(convert_float, LANES)
#define TO_INTS JOIN(convert_int, LANES)
#define AS_INTS JOIN(as_int, LANES)
// A value where a lane of a mask is set, else 0.
#define WHERE(mask, v) ((mask) & (v))
// Of functions that are seldom called, and of loops that keep arrays out of registers unless they are unrolled.
#define SELDOM __attribute__((noinline))
#define UNROLLED
#define NOT_UNROLLED
#else
// A comparison gives 1 then, and not -1: masks are combined by & and |, by ~ only beside &, and are no bits of values.
#define FLOATS float
#define INTS int
#define LOAD(p) (*(p))
#define TO_FLOATS convert_float
#define TO_INTS convert_int
#define AS_INTS as_int
#define WHERE(mask, v) ((mask) ? (v) : 0)
#if HAS_COLUMN_KERNEL
#define SELDOM // a call has all that is in registers stored
#else
#define SELDOM __attribute__((noinline))
#endif
#define UNROLLED _Pragma("unroll")
#define NOT_UNROLLED _Pragma("unroll 1")
#endif

#if LANES > 1
// Vectors where their elements may lie. Stored so they take one instruction; vstore16 of PoCL 3.1 takes three.
typedef float16 __attribute__((aligned(4))) PlacedFloat16;
typedef float8 __attribute__((aligned(4))) PlacedFloat8;
typedef int16 __attribute__((aligned(4))) PlacedInt16;
#endif

#if LANES > 1
static FLOATS Least(FLOATS a, FLOATS b)
{
  return a < b ? a : b;
}

static FLOATS Most(FLOATS a, FLOATS b)
{
  return a > b ? a : b;
}
#else
// One instruction, where a comparison and a choice are two.
#define Least fmin
#define Most fmax
#endif

// 1 / v, of numbers that are neither tiny nor huge, to a unit in the last place or two.
#ifdef __NV_CL_C_VERSION
#define INVERSE(v) native_recip(v) // else scaled before and after, in case
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
// From the second lane on, and the first lane of another vector. One instruction for clang's builtin, five for
// what PoCL 3.1 makes of vectors put together.
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

// A vector that is read back lane by lane.
typedef union
{
  INTS Vector;
  int Lanes[LANES];
} Lanes;

// A bit for each lane that is set.
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
// Writes the lanes with set bits to a place, one after the other; what comes behind them there is lost.
static void Append(INTS v, uint bits, int* place)
{
#if LANES == 16 && defined(__AVX512F__)
  *(PlacedInt16*)place = __builtin_ia32_compresssi512_mask(v, v, bits);
#else
  Lanes lanes;
  lanes.Vector = v;
  for (int lane = 0; lane < LANES; ++lane)
  {
    *place = lanes.Lanes[lane];
    place += bits >> lane & 1;
  }
#endif
}
#endif

// For each set bit, the highest first: lane is its number.
#define FOR_EACH_LANE(lane, bits)                                                                  \
  for (int lane = 31 - clz(bits); lane >= 0; bits ^= 1u << lane, lane = 31 - clz(bits))

// The largest lane.
static int MostOf(INTS v)
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

// The least and the largest of some lanes.
static int MostAmong(INTS some, INTS v)
{
  return MostOf(some ? v : (INTS)INT_MIN);
}

static int LeastAmong(INTS some, INTS v)
{
  return ~MostAmong(some, ~v);
}
