// SPDX-License-Identifier: BSD-3-Clause
// Sums over all output voxels, and over all counters. GroupReduction.cl comes before this text.

// Counts covered voxels: one partial sum for each work-item, which processes voxelsOfItem voxels.
__kernel void CountCovered(__global const char* coverage, const ulong numberOfVoxels,
  const uint voxelsOfItem, __global uint* sums)
{
  const size_t item = get_global_id(0);
  const size_t begin = item * voxelsOfItem;
  const size_t end = min(begin + voxelsOfItem, (size_t)numberOfVoxels);
  if (begin >= end)
  {
    return; // padding of the last work-group
  }
  uint sum = 0;
  for (size_t i = begin; i < end; ++i)
  {
    sum += coverage[i];
  }
  sums[item] = sum;
}

#define ADD(row, a, b) ((a) + (b))

// Counts the covered voxels of this work-item in words of bits.
static uint CountBits(__global const uint* bits, ulong words)
{
  const size_t step = get_global_size(0);
  uint sum = 0;
  size_t i = get_global_id(0);
  for (; i + 3 * step < words; i += 4 * step) // four independent loads
  {
    const uint4 some = (uint4)(bits[i], bits[i + step], bits[i + 2 * step], bits[i + 3 * step]);
    const uint4 counts = popcount(some);
    sum += counts.x + counts.y + counts.z + counts.w;
  }
  for (; i < words; i += step)
  {
    sum += popcount(bits[i]);
  }
  return sum;
}

// Adds up the counters of all sections, and the covered voxels if coverage is bits. Each of DEFORMVOLUME_PARTS
// work-groups writes DEFORMVOLUME_SUMMED partial sums. words: number of words of `bits`; 0 if bits are not to be
// counted. rows: DEFORMVOLUME_SUMMED values for each work-item.
__kernel void SumParts(__global const uint* counters, const uint sections,
  __global const uint* bits, const ulong words, __global ulong* parts, __local ulong* rows)
{
  const size_t item = get_local_id(0);
  const size_t items = get_local_size(0);
  ulong sums[DEFORMVOLUME_SUMMED] = { 0 };
  for (size_t section = get_global_id(0); section < sections; section += get_global_size(0))
  {
    const uint8 some = vload8(section, counters);
    const uint counts[DEFORMVOLUME_COUNTERS] = { some.s0, some.s1, some.s2, some.s3, some.s4, some.s5,
      some.s6, some.s7 };
#pragma unroll
    for (int i = 0; i < DEFORMVOLUME_COUNTERS; ++i)
    {
      sums[i] += counts[i];
    }
  }
  sums[DEFORMVOLUME_SUMMED_COVERED] = CountBits(bits, words);
#pragma unroll
  for (int i = 0; i < DEFORMVOLUME_SUMMED; ++i)
  {
    rows[i * items + item] = sums[i];
  }
  REDUCE_ROWS(rows, DEFORMVOLUME_SUMMED, ADD)
  for (size_t i = item; i < DEFORMVOLUME_SUMMED; i += items)
  {
    parts[get_group_id(0) * DEFORMVOLUME_SUMMED + i] = rows[i * items];
  }
}

// Adds up the partial sums into DEFORMVOLUME_SUMMARY_WORDS words, in one work-group.
__kernel void Summarize(__global const ulong* parts, __global uint* summary, __local ulong* rows)
{
  const size_t item = get_local_id(0);
  const size_t items = get_local_size(0);
  for (int i = 0; i < DEFORMVOLUME_SUMMED; ++i)
  {
    ulong sum = 0;
    for (size_t part = item; part < DEFORMVOLUME_PARTS; part += items)
    {
      sum += parts[part * DEFORMVOLUME_SUMMED + i];
    }
    rows[i * items + item] = sum;
  }
  REDUCE_ROWS(rows, DEFORMVOLUME_SUMMED, ADD)
  if (item == 0)
  {
#define SUM_OF(counter) rows[(counter)*items]
    const ulong wide[3] = { SUM_OF(DEFORMVOLUME_COUNT_WRITES), SUM_OF(DEFORMVOLUME_SUMMED_COVERED),
      SUM_OF(DEFORMVOLUME_COUNT_INVERTED) };
    for (int i = 0; i < 3; ++i)
    {
      summary[2 * i] = (uint)wide[i];
      summary[2 * i + 1] = (uint)(wide[i] >> 32);
    }
    summary[6] = (uint)min(SUM_OF(DEFORMVOLUME_COUNT_OVERSTRETCHED), (ulong)UINT_MAX);
    summary[7] = (SUM_OF(DEFORMVOLUME_COUNT_MISSING) && SUM_OF(DEFORMVOLUME_COUNT_ASSUMED)
                     ? DEFORMVOLUME_SUMMARY_MISSING_WHERE_ASSUMED
                     : 0) |
      (SUM_OF(DEFORMVOLUME_COUNT_LARGE) ? DEFORMVOLUME_SUMMARY_LARGE : 0);
  }
}

// Clears the counters of the sections that the listed bricks select. One work-item per section.
__kernel void ClearSections(__global uint* counters, __global const uint* bricks, const uint sections)
{
  const size_t i = get_global_id(0);
  const uint brick = i < sections ? bricks[i / DEFORMVOLUME_SECTIONS] : 0; // 0: a brick without sections
  const size_t section =
    DEFORMVOLUME_SECTIONS * (size_t)(brick & ((1u << DEFORMVOLUME_BRICK_BITS) - 1)) +
    i % DEFORMVOLUME_SECTIONS;
  for (int k = 0; k < DEFORMVOLUME_COUNTERS && IsSectionResampled(brick, section); ++k)
  {
    counters[section * DEFORMVOLUME_COUNTERS + k] = 0;
  }
}

// Clears, for all sections, the counters by which the passes for winners find their work.
__kernel void ClearWinnerCounters(__global uint* counters, const uint sections)
{
  const size_t i = get_global_id(0);
  if (i < sections)
  {
    counters[i * DEFORMVOLUME_COUNTERS + DEFORMVOLUME_COUNT_CANDIDATES] = 0;
    counters[i * DEFORMVOLUME_COUNTERS + DEFORMVOLUME_COUNT_TOUCHED] = 0;
  }
}

// Marks the sections of bricks that contain winners. Neighboring voxels usually have winners in the same section.
// Therefore a range of cells in the last section is stored, for which the section is marked already.
typedef struct
{
  ulong Begin; // a range of cells of a row in one section
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
  const int inSpan = (x - p->BrickOrigin[0]) % DEFORMVOLUME_SPAN;
  const size_t section = SectionOf(x, y, z, p);
  counters[section * DEFORMVOLUME_COUNTERS + DEFORMVOLUME_COUNT_CANDIDATES] = 1;
  run->Begin = cell - min(x, inSpan);
  run->End = cell + min((int)width - x, DEFORMVOLUME_SPAN - inSpan);
}

// Runs after the pass in which each cell writes its key to the voxels that it owns (DEFORMVOLUME_PASS_OWNERS). Finds
// the patches that later passes must visit: patches with a contested voxel, which several tetrahedra write, and patches
// with an uncovered voxel that some cell contains but does not own. Marks the sections of the current winners. Skips
// patches that the update does not clear. claimed: 0 if the pass of the owners was skipped because no voxel is written
// twice; covered voxels then count as settled. words: number of uints of a key. patches: first the state of each
// patch, then for each patch whether it has contested voxels.
// patchesOfItem: number of neighboring patches that a work-item processes. No other work-item writes to them.
__kernel void FindUnsettledVoxels(__global const char* coverage, __global uint* winners, const uint words,
  const int claimed, __global char* patches, __global uint* counters, const uint patchesOfItem,
  const KernelParameters p)
{
  const uint contested = 1u << 31;
  const size_t width = DEFORMVOLUME_PATCHES(p.OutputSize[0]);
  const size_t itemsOfRow = (width + patchesOfItem - 1) / patchesOfItem;
  const size_t row = get_global_id(0) / itemsOfRow;
  const size_t first = get_global_id(0) % itemsOfRow * patchesOfItem;
  const size_t last = min(first + patchesOfItem, width);
  const size_t height = DEFORMVOLUME_PATCHES(p.OutputSize[1]);
  const int firstZ = row / height * DEFORMVOLUME_PATCH;
  const int lastZ = min(firstZ + DEFORMVOLUME_PATCH, p.OutputSize[2]); // empty for the padding of the last work-group
  const int firstY = row % height * DEFORMVOLUME_PATCH;
  const int lastY = min(firstY + DEFORMVOLUME_PATCH, p.OutputSize[1]);
  __global char* contestedPatches = patches + PatchRow(0, PatchedPlanes(&p), &p);
  CellRun run = { 0, 0 };
  for (int z = firstZ; z < lastZ; ++z)
  {
    for (int y = firstY; y < lastY; ++y)
    {
      const size_t rowOfVoxels = ((size_t)z * p.OutputSize[1] + y) * p.OutputSize[0];
      for (size_t patch = first; patch < last; ++patch)
      {
        const size_t known = row * width + patch;
        if (patches[known] == DEFORMVOLUME_PATCH_KEPT)
        {
          continue;
        }
        uint some = 0;
        uint none = 0;
        const size_t end =
          rowOfVoxels + min((patch + 1) * DEFORMVOLUME_PATCH, (size_t)p.OutputSize[0]);
        for (size_t i = rowOfVoxels + patch * DEFORMVOLUME_PATCH; i < end; ++i)
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
            const uint part = high & (contested >> 1) - 1; // without the two flag bits
            MarkSection(words == 1 ? part : (ulong)part << 32 | key[0], &run, counters, &p);
          }
        }
        if (some)
        {
          contestedPatches[known] = 1;
        }
        const int touched = patches[known] & DEFORMVOLUME_PATCH_TOUCHED;
        if (some || (none && touched))
        {
          patches[known] = touched | DEFORMVOLUME_PATCH_UNSETTLED;
        }
      }
    }
  }
}
