// SPDX-License-Identifier: BSD-3-Clause
// Counts the covered voxels: a partial sum a work-item.
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
