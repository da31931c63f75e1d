// SPDX-License-Identifier: BSD-3-Clause
// Keeps and stores the samples that were found in packets of cells (PacketVertices.cl).

#define LANE_STORE(index, TYPE, BITS, SLOT)                                                        \
  target##index[voxel] = LANE_CONVERT_##BITS(TYPE, found->Values##index[i]);

typedef ulong __attribute__((may_alias)) TwoInts;

// Reads two values at once, because reading costs as much as writing.
#define LANE_STORE_ALL(index, TYPE, BITS, SLOT)                                                    \
  found->Values##index[count] = found->Values##index[count - 1];                                   \
  _Pragma("clang loop vectorize(disable) unroll_count(4)")                                         \
  for (uint i = 0; i < count; i += 2)                                                              \
  {                                                                                                \
    const ulong voxels = *(const TwoInts*)(found->Voxels + i);                                     \
    const ulong values = *(const TwoInts*)(found->Values##index + i);                              \
    target##index[(uint)voxels] = LANE_CONVERT_##BITS(TYPE, (int)values);                          \
    target##index[voxels >> 32] = LANE_CONVERT_##BITS(TYPE, (int)(values >> 32));                  \
  }

#define FOUND_CAPACITY 256
#define INVERTED_LANE 16 // flag that is added to the lane of an inverted cell
#define FOUND_VALUES(index, TYPE, BITS, SLOT)                                                      \
  int Values##index[FOUND_CAPACITY + 2 * LANES] __attribute__((aligned(8)));

// Whether samples are kept with their winner's key; otherwise with the lane of their cell.
#define KEEPS_KEYS (!HAS_OTHER_ARRAYS && sizeof(KEY) == sizeof(int))
// Whether storing samples needs their packet, so that they are stored after each packet: if weights must be computed
// again, keys are too long, or won voxels are counted.
#define KEEPS_PACKET(p)                                                                             \
  (HAS_OTHER_ARRAYS || (!KEEPS_KEYS && (p)->Pass != DEFORMVOLUME_PASS_DIRECT) ||                   \
    (p)->Pass == DEFORMVOLUME_PASS_MARK)

// Samples that were found but not stored yet. Many samples are stored at once, because the end of a short loop is
// mispredicted each time. Appending always writes LANES values, whatever the number of samples.
typedef struct
{
  int Voxels[FOUND_CAPACITY + 2 * LANES] __attribute__((aligned(8))); // output voxels
  int Cells[FOUND_CAPACITY + 2 * LANES]; // keys or lanes (KEEPS_KEYS); in the first pass only used for other arrays
  LANE_ARRAYS(FOUND_VALUES)
  uint Count;
} Found;

#define KEEP_LANE_VALUE(index, TYPE, BITS, SLOT)                                                   \
  {                                                                                                \
    INTERPOLATE_LANES(v, TYPE, BITS, SLOT)                                                         \
    Append(AS_INTS(v), bits, found->Values##index + *kept);                                        \
  }

#define KEEP_VALUE(index, TYPE, BITS, SLOT) found->Values##index[kept] = found->Values##index[i];

// Prefetches the winners: an atomic operation waits for memory and blocks all following operations.
static __attribute__((always_inline)) void FetchWinners(const Found* found, const Output* output)
{
  for (uint i = 0; i < found->Count; ++i)
  {
    PREFETCH_TO_WRITE(output->Winners + (uint)found->Voxels[i])
  }
}

// Claims the samples for their cells. Moves the samples whose cell is the winner so far to the front, and returns their
// number.
static uint KeepClaimed(Found* found, const Output* output)
{
  FetchWinners(found, output);
  uint kept = 0;
  for (uint i = 0; i < found->Count; ++i)
  {
    const uint voxel = found->Voxels[i];
    found->Voxels[kept] = voxel;
    LANE_ARRAYS(KEEP_VALUE)
    kept += Claim(output->Winners + voxel, (KEY)(uint)found->Cells[i]);
  }
  return kept;
}

#define FETCH_OUTPUT(index, TYPE, BITS, SLOT) PREFETCH_TO_WRITE(target##index + voxel)

// Prefetches the output where samples will be stored. Stores retire in order, so a store that misses the innermost
// cache or the TLB delays all following stores. For neighboring samples, which share cache lines, one prefetch for four
// samples is enough.
static __attribute__((always_inline)) void FetchFound(
  const Found* found, uint count, __global char* coverage ARRAY_PARAMETERS)
{
  const int apart = found->Voxels[count / 2] - found->Voxels[count / 2 + 1];
  const uint step = abs(apart) > 64 ? 1 : 4;
  for (uint i = 0; i < count; i += step)
  {
    const uint voxel = found->Voxels[i];
    LANE_ARRAYS(FETCH_OUTPUT)
    PREFETCH_TO_WRITE(coverage + voxel)
  }
}

// Stores the samples, and clears the list.
static void StoreFound(Found* found, const Packet* packet, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  const int pass = p->Pass;
  uint count = found->Count;
  __global char* const coverage = output->Coverage;
  // Bitwise operators: compilers warn of constant logical conditions.
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
    // If the number is odd, the last sample is stored twice.
    found->Voxels[count] = found->Voxels[count - 1];
    FetchFound(found, count, coverage ARRAY_ARGUMENTS);
    _Pragma("clang loop vectorize(disable) unroll_count(4)")
    for (uint i = 0; i < count; i += 2)
    {
      const ulong voxels = *(const TwoInts*)(found->Voxels + i);
      coverage[(uint)voxels] = 1;
      coverage[voxels >> 32] = 1;
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
    const uint voxel = found->Voxels[i];
    if (pass != DEFORMVOLUME_PASS_DIRECT)
    {
      const int cell = found->Cells[i];
      const KEY key = KEEPS_KEYS
        ? (KEY)(uint)cell
        : MakeKey(packet->X + 2 * (cell & (INVERTED_LANE - 1)), packet->Y, packet->Z,
          cell & INVERTED_LANE, p);
      if (!WinsVoxel(output, voxel, key, p))
      {
        continue;
      }
    }
    coverage[voxel] = 1;
    LANE_ARRAYS(LANE_STORE)
#if HAS_OTHER_ARRAYS
    StoreOtherArrays(packet, found->Cells[i] & (INVERTED_LANE - 1), voxel, p ARRAY_ARGUMENTS);
#endif
  }
  found->Count = 0;
}

// Keeps the samples of cells, given as bits. voxels: output voxels. inverted: lanes with inverted tetrahedra.
// kept: the number of kept samples, which replaces found->Count, because it can stay in a register. Stores all samples
// if there are too many.
static __attribute__((always_inline)) void KeepSamples(const Packet* packet, uint bits, INTS voxels,
  INTS inverted, const SampleWeights* weights, Found* found, uint* kept, Output* output,
  const KernelParameters* p ARRAY_PARAMETERS)
{
  if (DEFORMVOLUME_IS_WRITING(p->Pass))
  {
    LANE_ARRAYS(KEEP_LANE_VALUE)
  }
  Append(voxels, bits, found->Voxels + *kept);
  if (KEEPS_KEYS && p->Pass != DEFORMVOLUME_PASS_DIRECT)
  {
    // Start from the first cell of the row: the first cell of the packet may lie before the volume.
    const INTS keys = (int)MakeKey(0, packet->Y, packet->Z, 0, p) + (packet->X + 2 * LANE_INDEX);
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
    StoreFound(found, packet, output, p ARRAY_ARGUMENTS);
  }
}
