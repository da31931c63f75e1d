// SPDX-License-Identifier: BSD-3-Clause
// The part of RestSampling.cl for arrays that are interpolated in single precision: samples the volume at the rest
// coordinates of LANES neighboring voxels of a row at once.
//
// Design: rest coordinates of neighboring voxels may be anywhere, so memory is read lane by lane, two neighbors on x
// at once. All arithmetic is in vectors of float. Integers of 8 and 16 bits are exact in float. A side without weight
// does not contribute to the result.
//
// This text comes after LaneVectors.cl. The host defines before this text:
//   INDEX                 int, or long if the volume has too many voxels for it
//   LANE_ARRAYS(DO)       DO(index, type, bits) for arrays handled in lanes; bits is 32 for float

#pragma OPENCL FP_CONTRACT OFF

// Types of LANES elements, and how they are stored.
#if LANES > 1
#define LANES_OF(TYPE) JOIN(TYPE, LANES)
#define STORE(v, p) JOIN(vstore, LANES)(v, 0, p)
#else
#define LANES_OF(TYPE) TYPE
#define STORE(v, p) (*(p) = (v))
#endif
#define UINTS LANES_OF(uint)
#define AS_UINTS LANES_OF(as_uint)
// Rounds small numbers to the nearest integer, by adding 1.5 * 2^23.
#define ROUND_TO_INTS(v) (AS_INTS((v) + 12582912.0f) - 0x4B400000)

#define LANE_MASK ((uint)(((ulong)1 << LANES) - 1))

#define TO_INDICES JOIN(convert_, LANES_OF(INDEX))
#if LANES == 16
#define GATHER(F, o)                                                                               \
  F(0, o), F(1, o), F(2, o), F(3, o), F(4, o), F(5, o), F(6, o), F(7, o), F(8, o), F(9, o),        \
    F(10, o), F(11, o), F(12, o), F(13, o), F(14, o), F(15, o)
#elif LANES == 8
#define GATHER(F, o) F(0, o), F(1, o), F(2, o), F(3, o), F(4, o), F(5, o), F(6, o), F(7, o)
#elif LANES == 4
#define GATHER(F, o) F(0, o), F(1, o), F(2, o), F(3, o)
#else
#define GATHER(F, o) F(0, o)
#endif

// The layout of rest coordinates of a tile in local memory, by axis. On CPUs the rest coordinates of a row are
// consecutive. If work-items are lanes, neighbors on x and in the next row are in different banks.
#if LANES > 1
#define REST_STEP 1
#define REST_ROW_STEP (1 << DEFORMVOLUME_TILE_BITS_X)
#define REST_AXIS_STEP DEFORMVOLUME_TILE_VOXELS
#else
#define REST_STEP (DEFORMVOLUME_TILE_ROWS + 1)
#define REST_ROW_STEP 1
#define REST_AXIS_STEP (REST_STEP << DEFORMVOLUME_TILE_BITS_X)
#endif
#define RESTS (3 * REST_AXIS_STEP)

// Where the values of LANES neighboring voxels come from.
typedef struct
{
  INDEX Indices[LANES]; // lowest voxel of the cell
  INDEX StepY, StepZ;
  FLOATS Fractions[3];
  INTS Mask; // lanes with covered voxels
} LaneCells;

static void MakeLaneCells(
  __local const int* rests, uint bits, LaneCells* cells, const RasterParameters* p)
{
  cells->Mask = LanesOf(bits);
  INTS voxels[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const int shift = p->FractionBits[axis];
    const INTS rest = WHERE(cells->Mask, LOAD(rests + axis * REST_AXIS_STEP));
    voxels[axis] = min(rest >> shift, p->Size[axis] - 2);
    cells->Fractions[axis] =
      TO_FLOATS(rest - (voxels[axis] << shift)) * (1.0f / (float)(1 << shift));
  }
  cells->StepY = p->Size[0];
  cells->StepZ = (INDEX)p->Size[0] * p->Size[1];
  STORE(TO_INDICES(voxels[2]) * cells->StepZ + TO_INDICES(voxels[1]) * cells->StepY +
      TO_INDICES(voxels[0]),
    cells->Indices);
}

// Integers and interpolation between them are exact at both ends. For floats the ends are selected explicitly, as a
// NaN times 0 is a NaN.
static FLOATS MixIntegers(FLOATS a, FLOATS b, FLOATS f)
{
  return MULTIPLY_ADD(f, b - a, a);
}

static FLOATS MixFloats(FLOATS a, FLOATS b, FLOATS f)
{
  const FLOATS mixed = MULTIPLY_ADD(f, b, (1.0f - f) * a);
  return f > 0.0f ? (f < 1.0f ? mixed : b) : a;
}

// Loads two neighbors on x at once, and extracts the two.
#define LOAD_PAIR_8(k, o) (int)as_ushort(vload2(0, source + cells->Indices[k] + (o)))
#define LOAD_PAIR_16(k, o) as_int(vload2(0, source + cells->Indices[k] + (o)))
#define LOW_uchar(pair) ((pair) & 255)
#define HIGH_uchar(pair) ((pair) >> 8)
#define LOW_char(pair) ((pair) << 24 >> 24)
#define HIGH_char(pair) ((pair) << 16 >> 24)
#define LOW_ushort(pair) ((pair) & 65535)
#define HIGH_ushort(pair) AS_INTS(AS_UINTS(pair) >> 16)
#define LOW_short(pair) ((pair) << 16 >> 16)
#define HIGH_short(pair) ((pair) >> 16)

#define MIX_X_INTEGER(row, o, TYPE, BITS)                                                          \
  {                                                                                                \
    const INTS pairs = (INTS)(GATHER(LOAD_PAIR_##BITS, o));                                        \
    row = MixIntegers(                                                                             \
      TO_FLOATS(LOW_##TYPE(pairs)), TO_FLOATS(HIGH_##TYPE(pairs)), cells->Fractions[0]);           \
  }
#define MIX_X_8(row, o, TYPE) MIX_X_INTEGER(row, o, TYPE, 8)
#define MIX_X_16(row, o, TYPE) MIX_X_INTEGER(row, o, TYPE, 16)

#define LOAD_FLOAT(k, o) source[cells->Indices[k] + (o)]
#define MIX_X_32(row, o, TYPE)                                                                     \
  {                                                                                                \
    const FLOATS low = (FLOATS)(GATHER(LOAD_FLOAT, o));                                            \
    const FLOATS high = (FLOATS)(GATHER(LOAD_FLOAT, (o) + 1));                                     \
    row = MixFloats(low, high, cells->Fractions[0]);                                               \
  }
#define MIX_8 MixIntegers
#define MIX_16 MixIntegers
#define MIX_32 MixFloats

#define TO_8(TYPE) JOIN(JOIN(convert_, LANES_OF(TYPE)), _sat_rte)
#define TO_16(TYPE) TO_8(TYPE)
#define TO_32(TYPE) // already float

// Samples the values of LANES voxels, as a vector of the type of the array.
#define DEFINE_LANE_SAMPLING(NUMBER, TYPE, BITS)                                                   \
  static LANES_OF(TYPE) SampleLanes##NUMBER(                                                       \
    __global const TYPE* restrict source, const LaneCells* cells, float background)                \
  {                                                                                                \
    FLOATS rows[4];                                                                                \
    MIX_X_##BITS(rows[0], 0, TYPE);                                                                \
    MIX_X_##BITS(rows[1], cells->StepY, TYPE);                                                     \
    MIX_X_##BITS(rows[2], cells->StepZ, TYPE);                                                     \
    MIX_X_##BITS(rows[3], cells->StepZ + cells->StepY, TYPE);                                      \
    const FLOATS value = MIX_##BITS(MIX_##BITS(rows[0], rows[1], cells->Fractions[1]),             \
      MIX_##BITS(rows[2], rows[3], cells->Fractions[1]), cells->Fractions[2]);                     \
    return TO_##BITS(TYPE)(cells->Mask ? value : background);                                      \
  }
LANE_ARRAYS(DEFINE_LANE_SAMPLING)
