// SPDX-License-Identifier: BSD-3-Clause
// Fills voxels that the deformed volume does not cover with their background. Elements are handled as unsigned
// integers of their size, whatever their type.
//
// clEnqueueFillBuffer is not used: some CPU drivers fill with one thread, and the first access to new memory is slow.
// On an H200, clEnqueueFillBuffer took 13 to 28 microseconds to clear the bits or the counters of 13 million voxels; a
// kernel takes about 13.

// Each work-item fills DEFORMVOLUME_FILLED_BYTES bytes. size: number of elements.
#define FILL(NAME, TYPE, VECTOR)                                                                   \
  __kernel void NAME(__global TYPE* restrict target, const ulong size, const TYPE value)           \
  {                                                                                                \
    const size_t step = DEFORMVOLUME_FILLED_BYTES / sizeof(TYPE);                                  \
    size_t i = get_global_id(0) * step;                                                            \
    const size_t end = min(i + step, (size_t)size);                                                \
    for (; i + 16 <= end; i += 16)                                                                 \
    {                                                                                              \
      vstore16((VECTOR)value, 0, target + i);                                                      \
    }                                                                                              \
    for (; i < end; ++i)                                                                           \
    {                                                                                              \
      target[i] = value;                                                                           \
    }                                                                                              \
  }

// In most fills, all bytes are equal. memset can use instructions that do not read the memory first.
#ifdef __x86_64__
__kernel void Fill1(__global uchar* restrict target, const ulong size, const uchar value)
{
  const size_t begin = get_global_id(0) * DEFORMVOLUME_FILLED_BYTES;
  const size_t end = min(begin + DEFORMVOLUME_FILLED_BYTES, (size_t)size);
  __builtin_memset((void*)(size_t)(target + begin), value, end - begin);
}
#else
FILL(Fill1, uchar, uchar16)
#endif
FILL(Fill2, ushort, ushort16)
FILL(Fill4, uint, uint16)
FILL(Fill8, ulong, ulong16)

// Whether a pointer is aligned for 16-byte stores.
#define IS_ALIGNED(target) (((size_t)(target) & (sizeof(uint4) - 1)) == 0)

// For devices whose work-items are lanes: neighboring work-items store 16 neighboring bytes of a pattern each.
__kernel void FillWide(__global uchar* restrict target, const ulong bytes, const uint4 pattern)
{
  const size_t whole = IS_ALIGNED(target) ? bytes / sizeof(uint4) : 0;
  for (size_t i = get_global_id(0); i < whole; i += get_global_size(0))
  {
    ((__global uint4*)target)[i] = pattern;
  }
  const uchar* value = (const uchar*)&pattern;
  for (size_t i = whole * sizeof(uint4) + get_global_id(0); i < bytes; i += get_global_size(0))
  {
    target[i] = value[i % sizeof(uint4)];
  }
}

// A row of voxels of a patch, [First, End). Empty if the row is outside the output.
typedef struct
{
  size_t First, End;
} VoxelRow;

static VoxelRow RowOfPatch(size_t patch, size_t i, const KernelParameters* p)
{
  const size_t width = p->OutputSize[0];
  const size_t height = p->OutputSize[1];
  const size_t row = patch / DEFORMVOLUME_PATCHES(width);
  const size_t beginX = patch % DEFORMVOLUME_PATCHES(width) * DEFORMVOLUME_PATCH;
  const size_t y = row % DEFORMVOLUME_PATCHES(height) * DEFORMVOLUME_PATCH + i % DEFORMVOLUME_PATCH;
  const size_t z = row / DEFORMVOLUME_PATCHES(height) * DEFORMVOLUME_PATCH + i / DEFORMVOLUME_PATCH;
  const int isThere = y < height && z < (size_t)p->OutputSize[2];
  const size_t first = (z * height + y) * width + beginX;
  const VoxelRow voxels = { first,
    isThere ? first + min((size_t)DEFORMVOLUME_PATCH, width - beginX) : first };
  return voxels;
}

#define ROWS_OF_PATCH (DEFORMVOLUME_PATCH * DEFORMVOLUME_PATCH)

// Fills listed patches, one for each work-group. elements: number of elements of a voxel.
#define FILL_PATCHES(NAME, TYPE)                                                                   \
  __kernel void NAME(__global TYPE* restrict target, const uint elements, const TYPE value,        \
    __global const uint* patches, const KernelParameters p)                                        \
  {                                                                                                \
    for (size_t i = get_local_id(0); i < ROWS_OF_PATCH; i += get_local_size(0))                    \
    {                                                                                              \
      const VoxelRow row = RowOfPatch(patches[get_group_id(0)], i, &p);                            \
      for (size_t e = row.First * elements; e < row.End * elements; ++e)                           \
      {                                                                                            \
        target[e] = value;                                                                         \
      }                                                                                            \
    }                                                                                              \
  }

FILL_PATCHES(FillPatches1, uchar)
FILL_PATCHES(FillPatches2, ushort)
FILL_PATCHES(FillPatches4, uint)
FILL_PATCHES(FillPatches8, ulong)

// Counts the covered voxels of listed patches, one patch for each work-item.
__kernel void CountCoveredInPatches(__global const uchar* coverage, __global const uint* patches, const uint count,
  __global uint* sums, const KernelParameters p)
{
  const size_t item = get_global_id(0);
  if (item >= count)
  {
    return; // padding of the last work-group
  }
  uint sum = 0;
  for (size_t i = 0; i < ROWS_OF_PATCH; ++i)
  {
    const VoxelRow row = RowOfPatch(patches[item], i, &p);
    for (size_t voxel = row.First; voxel < row.End; ++voxel)
    {
      sum += coverage[voxel];
    }
  }
  sums[item] = sum;
}

// The following functions are for coverage that is stored as bits, in words of 32.

static uint IsCovered(__global const uint* bits, size_t voxel)
{
  return bits[voxel >> 5] >> (voxel & 31) & 1;
}

// Returns the bits of DEFORMVOLUME_EXPANDED voxels, whose bytes are stored at once. Neighboring work-items process
// neighboring voxels.
static uint CoveredOf(__global const uint* bits, size_t first)
{
  return bits[first >> 5] >> (first & 31) & 0xffff;
}

// Expands four bits to four bytes.
static uint BytesOf(uint bits)
{
  return (bits & 15) * 0x00204081 & 0x01010101;
}

// Expands the bits of all voxels to bytes.
__kernel void ExpandCoverage(__global const uint* bits, __global uchar* coverage, const ulong voxels)
{
  const size_t whole = IS_ALIGNED(coverage) ? voxels / DEFORMVOLUME_EXPANDED : 0;
#pragma unroll 4
  for (size_t i = get_global_id(0); i < whole; i += get_global_size(0))
  {
    const uint covered = CoveredOf(bits, i * DEFORMVOLUME_EXPANDED);
    ((__global uint4*)coverage)[i] = (uint4)(
      BytesOf(covered), BytesOf(covered >> 4), BytesOf(covered >> 8), BytesOf(covered >> 12));
  }
  for (size_t i = whole * DEFORMVOLUME_EXPANDED + get_global_id(0); i < voxels;
       i += get_global_size(0))
  {
    coverage[i] = IsCovered(bits, i);
  }
}

// Fills the elements of voxels that are not covered, so that each element of an output is written only once. Each
// work-item loads several bits before it stores. Neighboring work-items process neighboring voxels: most stores lie at
// the border of covered voxels, where stores cannot be combined within a work-item.
#define FILLED_AT_ONCE 8
#define FILL_UNCOVERED(NAME, TYPE)                                                                 \
  __kernel void NAME(__global TYPE* restrict target, const ulong voxels, const TYPE value,         \
    __global const uint* bits, const uint elements)                                                \
  {                                                                                                \
    const size_t step = get_global_size(0);                                                        \
    for (size_t first = get_global_id(0); first < voxels; first += FILLED_AT_ONCE * step)          \
    {                                                                                              \
      uint covered[FILLED_AT_ONCE];                                                                \
      _Pragma("unroll")                                                                            \
      for (int k = 0; k < FILLED_AT_ONCE; ++k)                                                     \
      {                                                                                            \
        const size_t voxel = first + k * step;                                                     \
        covered[k] = voxel < voxels ? IsCovered(bits, voxel) : 1;                                  \
      }                                                                                            \
      _Pragma("unroll")                                                                            \
      for (int k = 0; k < FILLED_AT_ONCE; ++k)                                                     \
      {                                                                                            \
        for (uint e = 0; e < elements && !covered[k]; ++e)                                         \
        {                                                                                          \
          target[(first + k * step) * elements + e] = value;                                       \
        }                                                                                          \
      }                                                                                            \
    }                                                                                              \
  }

FILL_UNCOVERED(FillUncovered1, uchar)
FILL_UNCOVERED(FillUncovered2, ushort)
FILL_UNCOVERED(FillUncovered4, uint)
FILL_UNCOVERED(FillUncovered8, ulong)

// Clears the bits of listed patches. One patch for each work-group.
__kernel void ClearPatchBits(
  __global uint* bits, __global const uint* patches, const KernelParameters p)
{
  for (size_t i = get_local_id(0); i < ROWS_OF_PATCH; i += get_local_size(0))
  {
    // A row has fewer voxels than a word has bits, but can continue in the next word.
    const VoxelRow row = RowOfPatch(patches[get_group_id(0)], i, &p);
    const ulong mask = ((1ul << (row.End - row.First)) - 1) << (row.First & 31);
    const uint low = mask, high = mask >> 32;
    if (low)
    {
      atomic_and(bits + (row.First >> 5), ~low);
    }
    if (high)
    {
      atomic_and(bits + (row.First >> 5) + 1, ~high);
    }
  }
}


// Expands the bits of listed patches to bytes. One patch for each work-group.
__kernel void ExpandPatches(__global const uint* bits, __global uchar* coverage,
  __global const uint* patches, const KernelParameters p)
{
  for (size_t i = get_local_id(0); i < ROWS_OF_PATCH; i += get_local_size(0))
  {
    const VoxelRow row = RowOfPatch(patches[get_group_id(0)], i, &p);
    for (size_t voxel = row.First; voxel < row.End; ++voxel)
    {
      coverage[voxel] = IsCovered(bits, voxel);
    }
  }
}
