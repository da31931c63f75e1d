// SPDX-License-Identifier: BSD-3-Clause
// A group of cells, LANES of a row of equal parity (BrickResampling.cl), and the samples that have been found in
// them: how these are interpolated, kept and stored.

// The vertices of a cell by the parity of their structured indices, as in CellCoverage.cl. Low are
// places of even x, High of odd x; the rows r by bit 0: odd z, bit 1: odd y.
typedef struct
{
  LocalRow Low[4];
  LocalRow High[4];
} Group;

#define VERTEX(v, slot) LOAD(((v)&1 ? group->High[(v) >> 1] : group->Low[(v) >> 1]) + (slot)*HALF_ROW)

#define LANE_RANGE_LOW_char -128.0f
#define LANE_RANGE_HIGH_char 127.0f
#define LANE_RANGE_LOW_uchar 0.0f
#define LANE_RANGE_HIGH_uchar 255.0f
#define LANE_RANGE_LOW_short -32768.0f
#define LANE_RANGE_HIGH_short 32767.0f
#define LANE_RANGE_LOW_ushort 0.0f
#define LANE_RANGE_HIGH_ushort 65535.0f
#define LANE_RANGE_LOW_float 0.0f
#define LANE_RANGE_HIGH_float 0.0f
#define LANE_CONVERT_32(TYPE, bits) as_float(bits)
#define LANE_CONVERT_16(TYPE, bits) ((TYPE)(bits))
#define LANE_CONVERT_8(TYPE, bits) ((TYPE)(bits))

// The interpolated values of an array, rounded where it holds integers.
#define LANE_RESULTS(index, TYPE, BITS, SLOT)                                                      \
  {                                                                                                \
    FLOATS v = t0 * VERTEX(0, 3 + SLOT);                                                           \
    v = fma(t3, VERTEX(3, 3 + SLOT), v);                                                           \
    v = fma(t5, VERTEX(5, 3 + SLOT), v);                                                           \
    v = fma(t6, VERTEX(6, 3 + SLOT), v);                                                           \
    v = fma(u1, VERTEX(1, 3 + SLOT), v);                                                           \
    v = fma(u2, VERTEX(2, 3 + SLOT), v);                                                           \
    v = fma(u4, VERTEX(4, 3 + SLOT), v);                                                           \
    v = fma(u7, VERTEX(7, 3 + SLOT), v);                                                           \
    if (BITS != 32)                                                                                \
    {                                                                                              \
      v = Least(Most(v, LANE_RANGE_LOW_##TYPE), LANE_RANGE_HIGH_##TYPE) + ROUND_TO_INTEGER;        \
    }                                                                                              \
    Append(AS_INTS(v), bits, found->Values##index + found->Count);                                 \
  }

#define LANE_STORE(index, TYPE, BITS, SLOT)                                                        \
  target##index[place] = LANE_CONVERT_##BITS(TYPE, found->Values##index[i]);

#define LANE_STORE_ALL(index, TYPE, BITS, SLOT)                                                    \
  _Pragma("clang loop vectorize(disable) unroll_count(4)")                                         \
  for (uint i = 0; i < count; ++i)                                                                 \
  {                                                                                                \
    const uint place = found->Places[i];                                                           \
    LANE_STORE(index, TYPE, BITS, SLOT)                                                            \
  }

#if HAS_OTHER_ARRAYS
// A sample that is in a cell, for the arrays that want its weights as they are: which of the cell's
// tetrahedra holds it is found out again, in integers.
static __attribute__((noinline)) void StoreOtherArrays(const Group* group, int lane, int x, int y,
  int z, uint place, const KernelParameters* p ARRAY_PARAMETERS)
{
  Vector q[8];
#pragma unroll
  for (int v = 0; v < 8; ++v)
  {
    LocalRow vertex = (v & 1 ? group->High[v >> 1] : group->Low[v >> 1]) + lane;
    q[v].x = (long)(vertex[0] * 256.0f);
    q[v].y = (long)(vertex[HALF_ROW] * 256.0f);
    q[v].z = (long)(vertex[2 * HALF_ROW] * 256.0f);
  }
  const uint plane = p->OutputSize[0] * p->OutputSize[1];
  const Vector voxel = { place % p->OutputSize[0], place % plane / p->OutputSize[0], place / plane };
  int t = 4;
  long weights[4];
  long volume;
  for (int corner = 0; corner < 2; ++corner)
  {
    const EdgeFunctions f = MakeEdgeFunctions(
      q[Tetrahedra[t][0]], q[Tetrahedra[t][1]], q[Tetrahedra[t][2]], q[Tetrahedra[t][3]]);
    Evaluate(&f, SamplePosition(voxel), weights);
    volume = f.Volume;
    for (int k = 0; k < 4 && corner == 0; ++k)
    {
      t = weights[k] < 0 ? CornerBehindFace[k] : t;
    }
    if (t == 4)
    {
      break;
    }
  }
  const Sample sample = MakeSample(x, y, z, t, weights, volume, place, p);
  const Sample* s = &sample;
  STORE_OTHER_ARRAYS
}
#endif

#define FOUND_CAPACITY 256
#define INVERTED_LANE 16 // added to the lane of a cell whose tetrahedra are inverted
#define FOUND_VALUES(index, TYPE, BITS, SLOT) int Values##index[FOUND_CAPACITY + 2 * LANES];

// Whether samples are kept with their winner's key; else with the lane of their cell.
#define KEEPS_KEYS (!HAS_OTHER_ARRAYS && sizeof(KEY) == sizeof(int))
// Whether the group matters when samples are stored, so that this happens group by group: where their weights
// are found again, keys are too long, or it is counted where voxels are won.
#define KEEPS_GROUP(p)                                                                             \
  (HAS_OTHER_ARRAYS || (!KEEPS_KEYS && (p)->Pass != DEFORMVOLUME_PASS_DIRECT) ||                   \
    (p)->Pass == DEFORMVOLUME_PASS_MARK)

// Samples that have been found in cells, before they are stored: many at once, as a loop that ends after
// a few is mispredicted each time. Appending writes LANES of them whatever their number.
typedef struct
{
  int Places[FOUND_CAPACITY + 2 * LANES]; // in the output
  int Cells[FOUND_CAPACITY + 2 * LANES]; // as KEEPS_KEYS says; in the first pass for other arrays only
  LANE_ARRAYS(FOUND_VALUES)
  uint Count;
} Found;

// Stores the samples and forgets them.
static void StoreFound(Found* found, const Group* group, int x, int y, int z, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const int pass = p->Pass;
  const uint count = found->Count;
  __global char* const coverage = output->Coverage;
  if (pass == DEFORMVOLUME_PASS_DIRECT && !HAS_OTHER_ARRAYS)
  {
    _Pragma("clang loop vectorize(disable) unroll_count(4)")
    for (uint i = 0; i < count; ++i)
    {
      coverage[(uint)found->Places[i]] = 1;
    }
    LANE_ARRAYS(LANE_STORE_ALL)
    found->Count = 0;
    return;
  }
  for (uint i = 0; i < count; ++i)
  {
    const uint place = found->Places[i];
    if (pass != DEFORMVOLUME_PASS_DIRECT)
    {
      const int cell = found->Cells[i];
      const KEY key = KEEPS_KEYS
        ? (KEY)(uint)cell
        : MakeKey(x + 2 * (cell & (INVERTED_LANE - 1)), y, z, cell & INVERTED_LANE, p);
      if (!TakesPlace(output, place, key, p))
      {
        continue;
      }
    }
    coverage[place] = 1;
    LANE_ARRAYS(LANE_STORE)
#if HAS_OTHER_ARRAYS
    const int lane = found->Cells[i] & (INVERTED_LANE - 1);
    StoreOtherArrays(group, lane, x + 2 * lane, y, z, place, p ARRAY_ARGUMENTS);
#endif
  }
  found->Count = 0;
}
