// SPDX-License-Identifier: BSD-3-Clause
// The output of a launch, and the choice of the cell that wins a voxel which several cells write.
//
// Data:
//   coverage: 1 byte per output voxel, or 1 bit, in words of 32
//   winners: 4 or 8 bytes per output voxel, only where tetrahedra overlap; in the counting pass, the first 4 bytes
//     are the number of tetrahedra
//   patches: 1 byte per patch of the output
//
// The host defines before this text:
//   KEY, ATOMIC_MIN,     type of the winner's key, and its minimum and conditional exchange
//   ATOMIC_CMPXCHG
//   COVERAGE_IS_BITS     0 or 1

typedef struct
{
  __global char* Coverage;
  __global KEY* Winners;
  __global char* Patches; // states, then for each patch 1 if it has contested voxels
  __global uint* LargeCells; // their number, three unused integers, then the list
  // Counts of this work-item.
  uint Writes;
  uint Inverted;
  uint Overstretched;
  uint Missing; // cells at the border with a flat or absent tetrahedron
  uint Assumed; // whether cells at the border left samples to neighbors without checking these
  uint Candidates; // voxels whose winner this work-item has replaced
  uint Touched; // nonzero if the cell contains samples that it does not own
  uint Large; // cells that were added to LargeCells
} Output;

// The first parameters of each resampling kernel (ExactPasses::SetArguments), and the initializers of the mesh and of
// the output that consist of these parameters.
#define GIVEN_PARAMETERS                                                                           \
  MAPPING_PARAMETERS, __global const uchar *state, __global const uchar *active,                   \
    __global const float *distances, __global char *coverage, __global KEY *winners,               \
    __global char *patches, __global uint *largeCells, __global uint *counters CUT_PARAMETERS
#define GIVEN_MESH { MAPPING_ARGUMENTS, state, active, distances CUT_ARGUMENTS, 0, { 0, 0, 0 } }
#define GIVEN_OUTPUT { coverage, winners, patches, largeCells, 0, 0, 0, 0, 0, 0, 0, 0 }

// Marks a voxel as covered. The old value of a bit is not used: work-items would wait for it.
static void Cover(Output* output, size_t target)
{
#if COVERAGE_IS_BITS
  atomic_or((__global uint*)output->Coverage + (target >> 5), 1u << (target & 31));
#else
  output->Coverage[target] = 1;
#endif
}

// The counts, in the order of the counters of a section.
#define COUNTS_OF(output)                                                                          \
  {                                                                                                \
    (output)->Writes, (output)->Inverted, (output)->Overstretched, (output)->Missing,              \
      (output)->Assumed, (output)->Candidates, (output)->Touched, (output)->Large                  \
  }

// Adds to a counter of a section. Only the first pass counts everything.
static void AddCount(
  int i, uint count, size_t section, __global uint* counters, const KernelParameters* p)
{
  const int countsAll = p->Pass == DEFORMVOLUME_PASS_DIRECT || p->Pass == DEFORMVOLUME_PASS_OWNERS;
  if (count && (i == DEFORMVOLUME_COUNT_CANDIDATES || countsAll))
  {
    atomic_add(counters + section * DEFORMVOLUME_COUNTERS + i, count);
  }
}

// The winner of overlapping tetrahedra is the upright tetrahedron in the lowest cell; if all are inverted, the
// tetrahedron in the lowest cell. Within a cell the lowest tetrahedron is written last. A contested voxel has the
// highest bit of its key set, so that its key is greater than the keys of settled voxels.
#define CONTESTED ((KEY)1 << (sizeof(KEY) * 8 - 1))

static KEY MakeKey(int x, int y, int z, int inverted, const KernelParameters* p)
{
  const KEY cell = ((KEY)z * (p->Size[1] - 1) + y) * (p->Size[0] - 1) + x;
  return cell | (KEY)(inverted != 0) << (sizeof(KEY) * 8 - 2) |
    (DEFORMVOLUME_USES_CLOSED_TETRAHEDRA(p->Pass) ? CONTESTED : 0);
}

// A cell that writes a voxel stores its key there. If there is a key already, the lower key stays, and the voxel is
// marked as contested. Returns whether the voxel belongs to this cell so far. Contested voxels are written only in
// DEFORMVOLUME_PASS_WINNER, so a cell that finds its own contested key, as in an incremental update, returns 0 here.
static int Claim(__global KEY* winner, KEY key)
{
  const KEY none = (KEY)-1;
  KEY found = *winner;
  for (;;)
  {
    const KEY next = found == none || found == key ? key : CONTESTED | min(key, found & ~CONTESTED);
    if (next == found)
    {
      return found == key;
    }
    const KEY seen = ATOMIC_CMPXCHG(winner, found, next);
    if (seen == found)
    {
      return found == none;
    }
    found = seen;
  }
}

// Marks a voxel of this cell as contested, because several tetrahedra of the cell write it: tetrahedra of other cells
// that contain the voxel may win.
static void Contest(__global KEY* winner, KEY key)
{
  ATOMIC_CMPXCHG(winner, key, CONTESTED | key);
}

// Whether a voxel lies in a patch that keeps its values.
static int IsKept(const Output* output, size_t target, const KernelParameters* p)
{
  const size_t row = target / p->OutputSize[0];
  const size_t x = target - row * p->OutputSize[0];
  const size_t z = row / p->OutputSize[1];
  const size_t y = row - z * p->OutputSize[1];
  return output->Patches[PatchRow(y, z, p) + x / DEFORMVOLUME_PATCH] == DEFORMVOLUME_PATCH_KEPT;
}

// Handles a voxel that a cell writes, in all passes but the first. Returns whether values must be written.
static int WinsVoxel(Output* output, size_t target, KEY key, const KernelParameters* p)
{
  __global KEY* winner = output->Winners + target;
  const KEY found = *winner;
  if (p->Pass == DEFORMVOLUME_PASS_WINNER)
  {
    // The winner of a voxel that is kept is not written again: this pass need not visit all of its samples.
    return found == key && !(p->KeepsPatches && IsKept(output, target, p));
  }
  if (p->Pass == DEFORMVOLUME_PASS_MARK)
  {
    if (found > key)
    {
      ATOMIC_MIN(winner, key);
      output->Candidates++;
    }
    return 0;
  }
  return Claim(winner, key);
}

// Whether a patch with voxels from first to last (inclusive) has work for the current pass.
static int AnyUnsettled(
  __global const char* patches, const int* first, const int* last, const KernelParameters* p)
{
  // Owned samples have been claimed before. Therefore the pass MARK needs only unsettled patches that are also touched:
  // cells contain samples of these patches that they do not own.
  const char wanted = DEFORMVOLUME_PATCH_UNSETTLED |
    (p->Pass == DEFORMVOLUME_PASS_MARK ? DEFORMVOLUME_PATCH_TOUCHED : 0);
  for (int z = first[2] / DEFORMVOLUME_PATCH; z <= last[2] / DEFORMVOLUME_PATCH; ++z)
  {
    for (int y = first[1] / DEFORMVOLUME_PATCH; y <= last[1] / DEFORMVOLUME_PATCH; ++y)
    {
      __global const char* row = patches + PatchRow(y * DEFORMVOLUME_PATCH, z * DEFORMVOLUME_PATCH, p);
      for (int x = first[0] / DEFORMVOLUME_PATCH; x <= last[0] / DEFORMVOLUME_PATCH; ++x)
      {
        if ((row[x] & wanted) == wanted)
        {
          return 1;
        }
      }
    }
  }
  return 0;
}

// Records that a cell contains a voxel that it does not own, and that it may therefore win.
static OUTLINED void Touch(int x, int y, int z, Output* output, const KernelParameters* p)
{
  __global char* patch = output->Patches + PatchRow(y, z, p) + x / DEFORMVOLUME_PATCH;
  if (*patch != DEFORMVOLUME_PATCH_KEPT)
  {
    *patch = DEFORMVOLUME_PATCH_TOUCHED;
    output->Touched = 1;
  }
}
