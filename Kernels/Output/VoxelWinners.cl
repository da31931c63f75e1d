// SPDX-License-Identifier: BSD-3-Clause
// The output of a launch, and which cell wins a voxel that several cells write.
//
// Data: coverage 1 byte an output voxel, or 1 bit, in words of 32; winners 4 or 8 bytes an output voxel (only where tetrahedra overlap; in the pass that counts, the number of tetrahedra in their first 4 bytes);
// patches of the output 1 byte each.
//
// What the host puts in front of this text:
//   KEY, ATOMIC_MIN,     type of the winner's key, and its minimum and conditional exchange
//   ATOMIC_CMPXCHG
//   COVERAGE_IS_BITS     0 or 1

typedef struct
{
  __global char* Coverage;
  __global KEY* Winners;
  __global char* Patches; // what is known of them; then for each 1 where cells have contested a voxel
  __global uint* LargeCells; // their number and three integers that are not used; then the list
  // Counts of this work-item.
  uint Writes;
  uint Inverted;
  uint Overstretched;
  uint Missing; // cells on the border with a tetrahedron that is flat or left out
  uint Assumed; // whether cells on the border left samples to the next cells without looking at these
  uint Candidates; // voxels that were won, as far as others had marked them by then
  uint Touched; // nonzero where samples are held that others write, or none
  uint Large; // cells that were put into the list
} Output;

// What each of these kernels is given first (ExactPasses::SetArguments), and the mesh and the output made of it.
#define GIVEN_PARAMETERS                                                                           \
  MAPPING_PARAMETERS, __global const uchar *state, __global const uchar *active,                   \
    __global const float *distances, __global char *coverage, __global KEY *winners,               \
    __global char *patches, __global uint *largeCells, __global uint *counters CUT_PARAMETERS
#define GIVEN_MESH { MAPPING_ARGUMENTS, state, active, distances CUT_ARGUMENTS, 0, { 0, 0, 0 } }
#define GIVEN_OUTPUT { coverage, winners, patches, largeCells, 0, 0, 0, 0, 0, 0, 0, 0 }

// A voxel is covered. What a bit was before is not asked for: items would wait for the answer.
static void Cover(Output* output, size_t target)
{
#if COVERAGE_IS_BITS
  atomic_or((__global uint*)output->Coverage + (target >> 5), 1u << (target & 31));
#else
  output->Coverage[target] = 1;
#endif
}

// The counts in the order of the counters of a section.
#define COUNTS_OF(output)                                                                          \
  {                                                                                                \
    (output)->Writes, (output)->Inverted, (output)->Overstretched, (output)->Missing,              \
      (output)->Assumed, (output)->Candidates, (output)->Touched, (output)->Large                  \
  }

// Adds to a counter of a section. The passes that come later count nothing again.
static void AddCount(
  int i, uint count, size_t section, __global uint* counters, const KernelParameters* p)
{
  const int countsAll = p->Pass == DEFORMVOLUME_PASS_DIRECT || p->Pass == DEFORMVOLUME_PASS_OWNERS;
  if (count && (i == DEFORMVOLUME_COUNT_CANDIDATES || countsAll))
  {
    atomic_add(counters + section * DEFORMVOLUME_COUNTERS + i, count);
  }
}

// Of overlapping tetrahedra upright ones win, then the lowest cell. Within a cell the order of
// writing decides, the lowest tetrahedron last. The key of a voxel that is contested has the highest bit: so it is
// more than those of settled voxels.
#define CONTESTED ((KEY)1 << (sizeof(KEY) * 8 - 1))

static KEY MakeKey(int x, int y, int z, int inverted, const KernelParameters* p)
{
  const KEY cell = ((KEY)z * (p->Size[1] - 1) + y) * (p->Size[0] - 1) + x;
  return cell | (KEY)(inverted != 0) << (sizeof(KEY) * 8 - 2) |
    (DEFORMVOLUME_IS_CLOSED(p->Pass) ? CONTESTED : 0);
}

// A cell that writes a voxel leaves its key there: the first one, or the lowest, which has the voxel then
// contested. Returns whether the voxel is the cell's so far. What is contested is written by its winner, later: so
// cells that write again what they wrote for the last output leave it alone.
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

// Several tetrahedra of a cell write a voxel, which is the cell's so far: others that hold it may win.
static void Contest(__global KEY* winner, KEY key)
{
  ATOMIC_CMPXCHG(winner, key, CONTESTED | key);
}

// Whether a voxel lies in a patch that stays as it is.
static int IsKept(const Output* output, size_t target, const KernelParameters* p)
{
  const size_t row = target / p->OutputSize[0];
  const size_t x = target - row * p->OutputSize[0];
  const size_t z = row / p->OutputSize[1];
  const size_t y = row - z * p->OutputSize[1];
  return output->Patches[PatchRow(y, z, p) + x / DEFORMVOLUME_PATCH] == DEFORMVOLUME_PATCH_KEPT;
}

// What passes but the first do with a voxel that a cell writes. Returns whether values are to follow.
static int TakesPlace(Output* output, size_t target, KEY key, const KernelParameters* p)
{
  __global KEY* winner = output->Winners + target;
  const KEY found = *winner;
  if (p->Pass == DEFORMVOLUME_PASS_WINNER)
  {
    // What has won a voxel that stays need not have all of its samples looked at in this pass.
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

// Whether in one of the patches that hold the voxels of the output from first to last there is work for a pass.
static int AnyUnsettled(
  __global const char* patches, const int* first, const int* last, const KernelParameters* p)
{
  // What cells own has been claimed before.
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

// A cell holds a voxel of the output that it does not own. If there turns out to be a winner, it may be this cell.
static OUTLINED void Touch(int x, int y, int z, Output* output, const KernelParameters* p)
{
  __global char* patch = output->Patches + PatchRow(y, z, p) + x / DEFORMVOLUME_PATCH;
  if (*patch != DEFORMVOLUME_PATCH_KEPT)
  {
    *patch = DEFORMVOLUME_PATCH_TOUCHED;
    output->Touched = 1;
  }
}
