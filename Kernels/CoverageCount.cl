// SPDX-License-Identifier: BSD-3-Clause
// Passes over all voxels of the output. Here: counts those that are covered, a partial sum a work-item.
__kernel void CountCovered(
  __global const char* coverage, const ulong numberOfVoxels, __global uint* sums)
{
  const size_t item = get_global_id(0);
  const size_t begin = item * DEFORMVOLUME_COUNTED_VOXELS;
  const size_t end = min(begin + DEFORMVOLUME_COUNTED_VOXELS, (size_t)numberOfVoxels);
  uint sum = 0;
  for (size_t i = begin; i < end; ++i)
  {
    sum += coverage[i];
  }
  sums[item] = sum;
}

// After the pass that finds the voxels that several cells write: those that one cell writes are settled, as
// their keys say. Where that pass was not made, as no voxel is written twice, contested is 0, and all voxels
// are that are covered. words: uints of a key; unsettled: set for patches of the output with voxels that are not
// settled.
__kernel void Settle(__global const char* coverage, __global uint* winners, const uint words,
  const int contested, __global char* unsettled, const KernelParameters p)
{
  const size_t width = p.OutputSize[0];
  const size_t height = p.OutputSize[1];
  const size_t item = get_global_id(0);
  const size_t begin = item * DEFORMVOLUME_COUNTED_VOXELS;
  const size_t end = min(begin + DEFORMVOLUME_COUNTED_VOXELS, width * height * p.OutputSize[2]);
  for (size_t i = begin; i < end;)
  {
    const size_t row = i / width;
    const size_t first = i - row * width;
    const size_t last = min(width, first + end - i);
    __global char* patches = unsettled + PatchRow(row % height, row / height, &p);
    for (size_t x = first; x < last;)
    {
      const size_t patch = x / DEFORMVOLUME_PATCH;
      const size_t patchEnd = min((patch + 1) * DEFORMVOLUME_PATCH, last);
      uint unsettledKeys = 0;
      for (; x < patchEnd; ++x, ++i)
      {
        __global uint* highWord = winners + i * words + words - 1;
        if (!contested && coverage[i])
        {
          *highWord = 0;
        }
        unsettledKeys |= *highWord;
      }
      if (unsettledKeys >> 31)
      {
        patches[patch] = 1;
      }
    }
  }
}
