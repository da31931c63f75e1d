// SPDX-License-Identifier: BSD-3-Clause
// The samples that have been found in groups of cells (GroupVertices.cl): how they are interpolated, kept and
// stored.

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

#define LANE_STORE(index, TYPE, BITS, SLOT)                                                        \
  target##index[place] = LANE_CONVERT_##BITS(TYPE, found->Values##index[i]);

typedef ulong __attribute__((may_alias)) TwoInts;

// Two at once: what is read costs as much as what is written.
#define LANE_STORE_ALL(index, TYPE, BITS, SLOT)                                                    \
  found->Values##index[count] = found->Values##index[count - 1];                                   \
  _Pragma("clang loop vectorize(disable) unroll_count(4)")                                         \
  for (uint i = 0; i < count; i += 2)                                                              \
  {                                                                                                \
    const ulong places = *(const TwoInts*)(found->Places + i);                                     \
    const ulong values = *(const TwoInts*)(found->Values##index + i);                              \
    target##index[(uint)places] = LANE_CONVERT_##BITS(TYPE, (int)values);                          \
    target##index[places >> 32] = LANE_CONVERT_##BITS(TYPE, (int)(values >> 32));                  \
  }

#if HAS_OTHER_ARRAYS
// The weights and their sum, as of edge functions, of the origin in a tetrahedron of a cell with these vertices.
// Coordinates are whole numbers of 1/256 voxel under 2^14, so that all numbers are under 2^47, and exact. (What
// MakeEdgeFunctions and Evaluate are for larger cells, which doubles do not hold.)
static __attribute__((always_inline)) void WeighOrigin(
  const EXACT* x, const EXACT* y, const EXACT* z, int t, long* weights, long* volume)
{
  const int a = Tetrahedra[t][0], b = Tetrahedra[t][1], c = Tetrahedra[t][2], d = Tetrahedra[t][3];
  const EXACT ux = x[b] - x[a], uy = y[b] - y[a], uz = z[b] - z[a];
  const EXACT vx = x[c] - x[a], vy = y[c] - y[a], vz = z[c] - z[a];
  const EXACT wx = x[d] - x[a], wy = y[d] - y[a], wz = z[d] - z[a];
  // The normals of the faces opposite b, c and d.
  const EXACT bx = vy * wz - vz * wy, by = vz * wx - vx * wz, bz = vx * wy - vy * wx;
  const EXACT cx = wy * uz - wz * uy, cy = wz * ux - wx * uz, cz = wx * uy - wy * ux;
  const EXACT dx = uy * vz - uz * vy, dy = uz * vx - ux * vz, dz = ux * vy - uy * vx;
  const EXACT sum = ux * bx + uy * by + uz * bz;
  const EXACT sign = sum < 0 ? -1 : 1;
  weights[1] = (long)(-sign * (x[a] * bx + y[a] * by + z[a] * bz));
  weights[2] = (long)(-sign * (x[a] * cx + y[a] * cy + z[a] * cz));
  weights[3] = (long)(-sign * (x[a] * dx + y[a] * dy + z[a] * dz));
  *volume = (long)(sign * sum);
  weights[0] = *volume - weights[1] - weights[2] - weights[3];
}

// A sample that is in a cell, for the arrays that want its weights as they are: which of the cell's
// tetrahedra holds it is found out again, in whole numbers.
static __attribute__((noinline)) void StoreOtherArrays(
  const Group* group, int lane, uint place, const KernelParameters* p ARRAY_PARAMETERS)
{
  const uint width = p->OutputSize[0];
  const uint plane = width * p->OutputSize[1];
  const uint sampleZ = place / plane;
  const uint inPlane = place - sampleZ * plane;
  const uint sampleY = inPlane / width;
  const float sample[3] = { inPlane - sampleY * width, sampleY, sampleZ };
  EXACT x[8], y[8], z[8]; // relative to the sample
#pragma unroll
  for (int v = 0; v < 8; ++v)
  {
    LocalRow vertex = group->Rows[v >> 1] + (v & 1 ? ODD : group->Side) + lane;
    x[v] = (EXACT)((vertex[0] - sample[0]) * 256.0f);
    y[v] = (EXACT)((vertex[HALF_ROW] - sample[1]) * 256.0f);
    z[v] = (EXACT)((vertex[2 * HALF_ROW] - sample[2]) * 256.0f);
  }
  long weights[4];
  long volume;
  WeighOrigin(x, y, z, 4, weights, &volume);
  int t = 4;
  for (int k = 0; k < 4; ++k)
  {
    t = weights[k] < 0 ? CornerBehindFace[k] : t;
  }
  if (t != 4)
  {
    WeighOrigin(x, y, z, t, weights, &volume);
  }
  Sample made;
  BeginSamples(&made, group->X + 2 * lane, group->Y, group->Z, t, volume, p);
  PlaceSample(&made, weights, place);
  const Sample* s = &made;
  STORE_OTHER_ARRAYS
}
#endif

#define FOUND_CAPACITY 256
#define INVERTED_LANE 16 // added to the lane of a cell whose tetrahedra are inverted
#define FOUND_VALUES(index, TYPE, BITS, SLOT)                                                      \
  int Values##index[FOUND_CAPACITY + 2 * LANES] __attribute__((aligned(8)));

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
  int Places[FOUND_CAPACITY + 2 * LANES] __attribute__((aligned(8))); // in the output
  int Cells[FOUND_CAPACITY + 2 * LANES]; // as KEEPS_KEYS says; in the first pass for other arrays only
  LANE_ARRAYS(FOUND_VALUES)
  uint Count;
} Found;

// The weights of the cells' vertices at samples (GroupWeights.cl).
typedef struct
{
  FLOATS T0, T3, T5, T6; // of the central tetrahedron, still to be multiplied by Scale
  FLOATS U1, U2, U4, U7; // of the corners
  FLOATS Scale;
} SampleWeights;

// The interpolated values of an array, rounded where it holds integers.
#define LANE_RESULTS(index, TYPE, BITS, SLOT)                                                      \
  {                                                                                                \
    FLOATS inner = weights->T0 * VERTEX(0, 3 + SLOT);                                              \
    inner = fma(weights->T3, VERTEX(3, 3 + SLOT), inner);                                          \
    inner = fma(weights->T5, VERTEX(5, 3 + SLOT), inner);                                          \
    inner = fma(weights->T6, VERTEX(6, 3 + SLOT), inner);                                          \
    FLOATS outer = weights->U1 * VERTEX(1, 3 + SLOT);                                              \
    outer = fma(weights->U2, VERTEX(2, 3 + SLOT), outer);                                          \
    outer = fma(weights->U4, VERTEX(4, 3 + SLOT), outer);                                          \
    outer = fma(weights->U7, VERTEX(7, 3 + SLOT), outer);                                          \
    FLOATS v = fma(inner, weights->Scale, outer);                                                  \
    if (BITS != 32)                                                                                \
    {                                                                                              \
      v = Least(Most(v, LANE_RANGE_LOW_##TYPE), LANE_RANGE_HIGH_##TYPE) + ROUND_TO_INTEGER;        \
    }                                                                                              \
    Append(AS_INTS(v), bits, found->Values##index + *kept);                                        \
  }

#define KEEP_VALUE(index, TYPE, BITS, SLOT) found->Values##index[kept] = found->Values##index[i];

// An atomic operation waits for memory, and nothing that follows goes on meanwhile.
static __attribute__((always_inline)) void FetchWinners(const Found* found, const Output* output)
{
  for (uint i = 0; i < found->Count; ++i)
  {
    PREFETCH_TO_WRITE(output->Winners + (uint)found->Places[i])
  }
}

// Has the cells claim their samples, and returns how many of these are theirs so far: the first ones then.
static uint KeepClaimed(Found* found, const Output* output)
{
  FetchWinners(found, output);
  uint kept = 0;
  for (uint i = 0; i < found->Count; ++i)
  {
    const uint place = found->Places[i];
    found->Places[kept] = place;
    LANE_ARRAYS(KEEP_VALUE)
    kept += Claim(output->Winners + place, (KEY)(uint)found->Cells[i]);
  }
  return kept;
}

#define FETCH_OUTPUT(index, TYPE, BITS, SLOT) PREFETCH_TO_WRITE(target##index + place)

// Has the processor fetch the output where the samples will be stored. Stores leave one after the other, so that
// one that misses the innermost cache, or the page table's, keeps all others waiting. For neighbours, which share
// what is fetched, it is enough to do so for one in four.
static __attribute__((always_inline)) void FetchFound(
  const Found* found, uint count, __global char* coverage ARRAY_PARAMETERS)
{
  const int apart = found->Places[count / 2] - found->Places[count / 2 + 1];
  const uint step = abs(apart) > 64 ? 1 : 4;
  for (uint i = 0; i < count; i += step)
  {
    const uint place = found->Places[i];
    LANE_ARRAYS(FETCH_OUTPUT)
    PREFETCH_TO_WRITE(coverage + place)
  }
}

// Stores the samples and forgets them.
static void StoreFound(Found* found, const Group* group, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const int pass = p->Pass;
  uint count = found->Count;
  __global char* const coverage = output->Coverage;
  // Bit by bit: compilers warn of a condition that is constant.
  if (!HAS_OTHER_ARRAYS &&
    ((pass == DEFORMVOLUME_PASS_DIRECT) | (KEEPS_KEYS & (pass == DEFORMVOLUME_PASS_OWNERS))))
  {
    if (pass == DEFORMVOLUME_PASS_OWNERS)
    {
      count = KeepClaimed(found, output);
    }
    found->Count = 0;
    if (count == 0)
    {
      return;
    }
    // The last one twice, where their number is odd.
    found->Places[count] = found->Places[count - 1];
    FetchFound(found, count, coverage ARRAY_ARGUMENTS);
    _Pragma("clang loop vectorize(disable) unroll_count(4)")
    for (uint i = 0; i < count; i += 2)
    {
      const ulong places = *(const TwoInts*)(found->Places + i);
      coverage[(uint)places] = 1;
      coverage[places >> 32] = 1;
    }
    LANE_ARRAYS(LANE_STORE_ALL)
    return;
  }
  if (pass != DEFORMVOLUME_PASS_DIRECT)
  {
    FetchWinners(found, output);
  }
  for (uint i = 0; i < count; ++i)
  {
    const uint place = found->Places[i];
    if (pass != DEFORMVOLUME_PASS_DIRECT)
    {
      const int cell = found->Cells[i];
      const KEY key = KEEPS_KEYS
        ? (KEY)(uint)cell
        : MakeKey(group->X + 2 * (cell & (INVERTED_LANE - 1)), group->Y, group->Z,
          cell & INVERTED_LANE, p);
      if (!TakesPlace(output, place, key, p))
      {
        continue;
      }
    }
    coverage[place] = 1;
    LANE_ARRAYS(LANE_STORE)
#if HAS_OTHER_ARRAYS
    StoreOtherArrays(group, found->Cells[i] & (INVERTED_LANE - 1), place, p ARRAY_ARGUMENTS);
#endif
  }
  found->Count = 0;
}

// Keeps the samples of some cells, as bits. places: in the output. inverted: lanes whose tetrahedra are. kept: how
// many are kept, in place of found->Count, which memory holds. All are stored where these are too many.
static __attribute__((always_inline)) void KeepSamples(const Group* group, uint bits, INTS places,
  INTS inverted, const SampleWeights* weights, Found* found, uint* kept, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  if (DEFORMVOLUME_IS_WRITING(p->Pass))
  {
    LANE_ARRAYS(LANE_RESULTS)
  }
  Append(places, bits, found->Places + *kept);
  if (KEEPS_KEYS && p->Pass != DEFORMVOLUME_PASS_DIRECT)
  {
    // The first cell of the row, as the first one of the group may lie before the volume.
    const INTS keys = (int)MakeKey(0, group->Y, group->Z, 0, p) + (group->X + 2 * LANE_INDEX);
    Append(keys | (inverted & (int)MakeKey(0, 0, 0, 1, p)), bits, found->Cells + *kept);
  }
  else if (HAS_OTHER_ARRAYS || p->Pass != DEFORMVOLUME_PASS_DIRECT)
  {
    Append(LANE_INDEX | (inverted & INVERTED_LANE), bits, found->Cells + *kept);
  }
  *kept += popcount(bits);
  if (*kept > FOUND_CAPACITY)
  {
    found->Count = *kept;
    *kept = 0;
    StoreFound(found, group, output, p ARRAY_ARGUMENTS);
  }
}
