// SPDX-License-Identifier: BSD-3-Clause
// Passes over all voxels of the output, or over all counters. It comes after GroupReduction.cl.

// Counts the voxels that are covered, a partial sum a work-item. voxelsOfItem: that it takes.
__kernel void CountCovered(__global const char* coverage, const ulong numberOfVoxels,
  const uint voxelsOfItem, __global uint* sums)
{
  const size_t item = get_global_id(0);
  const size_t begin = item * voxelsOfItem;
  const size_t end = min(begin + voxelsOfItem, (size_t)numberOfVoxels);
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

#define ADD(row, a, b) ((a) + (b))

// The covered voxels among words of bits, as far as a work-item sees them.
static uint CountBits(__global const uint* bits, ulong words)
{
  const size_t step = get_global_size(0);
  uint sum = 0;
  size_t i = get_global_id(0);
  for (; i + 3 * step < words; i += 4 * step) // memory is asked for all of them at once
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

// Adds up the counters of all sections, and the voxels that are covered where coverage is bits: DEFORMVOLUME_SUMMED
// partial sums a work-group, of as many groups as DEFORMVOLUME_PARTS says. words: of bits, 0 where these do not matter;
// rows: room for as many sums a work-item.
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

// What the parts add up to (DEFORMVOLUME_SUMMARY_WORDS), in one work-group.
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

// The counters of the sections of a list of bricks that are to be run are 0 again: an item a section.
__kernel void ClearSections(__global uint* counters, __global const uint* bricks, const uint sections)
{
  const size_t i = get_global_id(0);
  const uint brick = i < sections ? bricks[i / DEFORMVOLUME_SECTIONS] : 0; // no section of it
  const size_t section =
    DEFORMVOLUME_SECTIONS * (size_t)(brick & ((1u << DEFORMVOLUME_BRICK_BITS) - 1)) +
    i % DEFORMVOLUME_SECTIONS;
  for (int k = 0; k < DEFORMVOLUME_COUNTERS && IsSectionRun(brick, section); ++k)
  {
    counters[section * DEFORMVOLUME_COUNTERS + k] = 0;
  }
}

// Those counters of all sections are 0 again that tell the passes which choose winners where there is work.
__kernel void ClearWork(__global uint* counters, const uint sections)
{
  const size_t i = get_global_id(0);
  if (i < sections)
  {
    counters[i * DEFORMVOLUME_COUNTERS + DEFORMVOLUME_COUNT_CANDIDATES] = 0;
    counters[i * DEFORMVOLUME_COUNTERS + DEFORMVOLUME_COUNT_TOUCHED] = 0;
  }
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
  const int inSpan = (x - p->BrickOrigin[0]) % DEFORMVOLUME_SPAN;
  const size_t section = SectionOf(x, y, z, p);
  counters[section * DEFORMVOLUME_COUNTERS + DEFORMVOLUME_COUNT_CANDIDATES] = 1;
  run->Begin = cell - min(x, inSpan);
  run->End = cell + min((int)width - x, DEFORMVOLUME_SPAN - inSpan);
}

// After a pass that finds the voxels that several cells write, as their keys say: marks patches with voxels that
// are not settled, and the sections of bricks that hold winners so far. Where that pass was not made, as no voxel
// is written twice, claimed is 0: those that are covered are settled then. words: uints of a key; patches: what is
// known of them, in which voxels that are not covered can be won where cells touch them, and then, of as many, which
// have contested voxels. Patches that are kept are left out.
// patchesOfItem: those side by side that an item takes. An item has its patches alone, as it also writes what is
// known of them.
__kernel void Settle(__global const char* coverage, __global uint* winners, const uint words,
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
  const int lastZ = min(firstZ + DEFORMVOLUME_PATCH, p.OutputSize[2]); // none for items that only fill their group
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
            const uint part = high & (contested >> 1) - 1; // without the two bits that tell of keys
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
