// SPDX-License-Identifier: BSD-3-Clause
// Passes over all voxels of the output. Here: counts those that are covered, a partial sum a work-item.
__kernel void CountCovered(
  __global const char* coverage, const ulong numberOfVoxels, __global uint* sums)
{
  const size_t item = get_global_id(0);
  const size_t begin = item * DEFORMVOLUME_COUNTED_VOXELS;
  const size_t end = min(begin + DEFORMVOLUME_COUNTED_VOXELS, (size_t)numberOfVoxels);
  if (begin >= end)
  {
    return; // an item that only fills its group
  }
  uint sum = 0;
  for (size_t i = begin; i < end; ++i)
  {
    sum += coverage[i];
  }
  sums[item] = sum;
}

// Sections of bricks that hold the winners of voxels: counts in them are set where there is one. Voxels side by
// side mostly have winners side by side, and only cells outside a run are looked for.
typedef struct
{
  ulong Begin; // cells of a row in one section
  ulong End;
} CellRun;

static void MarkSection(ulong cell, CellRun* run, __global uint* counters, const KernelParameters* p)
{
  if (cell >= run->Begin && cell < run->End)
  {
    return;
  }
  const ulong width = p->Size[0] - 1;
  const ulong row = cell / width;
  const int x = cell - row * width;
  const int z = row / (p->Size[1] - 1);
  const int y = row - (ulong)z * (p->Size[1] - 1);
  const int inColumn = (x - p->BrickOrigin[0]) % DEFORMVOLUME_COLUMN;
  const size_t section = SectionOf(x, y, z, p);
  counters[section * DEFORMVOLUME_COUNTERS + DEFORMVOLUME_COUNT_CANDIDATES] = 1;
  run->Begin = cell - min(x, inColumn);
  run->End = cell + min((int)width - x, DEFORMVOLUME_COLUMN - inColumn);
}

// After a pass that finds the voxels that several cells write, as their keys say: marks patches with voxels that
// are not settled, and the sections of bricks that hold winners so far. Where that pass was not made, as no voxel
// is written twice, claimed is 0: those that are covered are settled then. words: uints of a key; patches: what is
// known of them, in which voxels that are not covered can be won where cells touch them, and then, of as many, which
// have contested voxels. Patches that are kept are left out.
__kernel void Settle(__global const char* coverage, __global uint* winners, const uint words,
  const int claimed, __global char* patches, __global uint* counters, const KernelParameters p)
{
  const uint contested = 1u << 31;
  const size_t width = p.OutputSize[0];
  const size_t height = p.OutputSize[1];
  const size_t item = get_global_id(0);
  const size_t begin = item * DEFORMVOLUME_COUNTED_VOXELS;
  const size_t end = min(begin + DEFORMVOLUME_COUNTED_VOXELS, width * height * p.OutputSize[2]);
  __global char* contestedPatches = patches + PatchRow(0, PatchedPlanes(&p), &p);
  CellRun run = { 0, 0 };
  for (size_t i = begin; i < end;)
  {
    const size_t row = i / width;
    const size_t first = i - row * width;
    const size_t last = min(width, first + end - i);
    const size_t firstPatch = PatchRow(row % height, row / height, &p);
    __global char* patchRow = patches + firstPatch;
    for (size_t x = first; x < last;)
    {
      const size_t patch = x / DEFORMVOLUME_PATCH;
      const size_t patchEnd = min((patch + 1) * DEFORMVOLUME_PATCH, last);
      if (patchRow[patch] == DEFORMVOLUME_PATCH_KEPT)
      {
        i += patchEnd - x;
        x = patchEnd;
        continue;
      }
      uint some = 0;
      uint none = 0;
      for (; x < patchEnd; ++x, ++i)
      {
        __global uint* key = winners + i * words;
        const uint high = key[words - 1];
        if (!claimed && coverage[i])
        {
          key[words - 1] = 0;
        }
        else if (high == 0xffffffff)
        {
          none = 1;
        }
        else if (high & contested)
        {
          some = 1;
          const uint part = high & (contested >> 1) - 1; // without the two bits that tell of keys
          MarkSection(
            words == 1 ? part : (ulong)part << 32 | key[0], &run, counters, &p);
        }
      }
      if (some)
      {
        contestedPatches[firstPatch + patch] = 1;
      }
      const int touched = patchRow[patch] & DEFORMVOLUME_PATCH_TOUCHED;
      if (some || (none && touched))
      {
        patchRow[patch] = touched | DEFORMVOLUME_PATCH_UNSETTLED;
      }
    }
  }
}
