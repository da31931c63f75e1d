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

// After the pass that marks contested voxels: those that one cell writes are settled, and the others have
// no winner yet. words: uints of a key.
__kernel void Settle(__global char* coverage, __global uint* winners, const ulong numberOfVoxels,
  const uint words)
{
  const size_t item = get_global_id(0);
  const size_t begin = item * DEFORMVOLUME_COUNTED_VOXELS;
  const size_t end = min(begin + DEFORMVOLUME_COUNTED_VOXELS, (size_t)numberOfVoxels);
  for (size_t i = begin; i < end; ++i)
  {
    const uint key = coverage[i] == 1 ? 0 : UINT_MAX;
    for (uint word = 0; word < words; ++word)
    {
      winners[i * words + word] = key;
    }
    coverage[i] = coverage[i] != 0;
  }
}
