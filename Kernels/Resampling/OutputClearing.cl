// SPDX-License-Identifier: BSD-3-Clause
// Gives output voxels what those hold that the deformed volume does not cover. Elements are moved as bits of their
// size, whatever their type.
//
// Why not clEnqueueFillBuffer: some drivers for processors fill with one thread, and the first
// touch of fresh memory costs more than all else.

// A work-item fills as many bytes as DEFORMVOLUME_FILLED_BYTES says; size: elements.
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

// Bytes, and values whose bytes are alike: most of what is filled. The C library sets memory without reading it
// before, where the processor can.
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

// The patches of a list: a work-group takes one. elements: of a voxel.
#define FILL_PATCHES(NAME, TYPE)                                                                   \
  __kernel void NAME(__global TYPE* restrict target, const uint elements, const TYPE value,        \
    __global const uint* patches, const KernelParameters p)                                        \
  {                                                                                                \
    const size_t patch = patches[get_group_id(0)];                                                 \
    const size_t width = p.OutputSize[0];                                                          \
    const size_t height = p.OutputSize[1];                                                         \
    const size_t row = patch / DEFORMVOLUME_PATCHES(width);                                        \
    const size_t beginX = patch % DEFORMVOLUME_PATCHES(width) * DEFORMVOLUME_PATCH;                \
    const size_t beginY = row % DEFORMVOLUME_PATCHES(height) * DEFORMVOLUME_PATCH;                 \
    const size_t beginZ = row / DEFORMVOLUME_PATCHES(height) * DEFORMVOLUME_PATCH;                 \
    const size_t endX = min(beginX + DEFORMVOLUME_PATCH, width);                                   \
    for (size_t i = get_local_id(0); i < DEFORMVOLUME_PATCH * DEFORMVOLUME_PATCH;                  \
         i += get_local_size(0))                                                                   \
    {                                                                                              \
      const size_t y = beginY + i % DEFORMVOLUME_PATCH;                                            \
      const size_t z = beginZ + i / DEFORMVOLUME_PATCH;                                            \
      const int isThere = y < height && z < (size_t)p.OutputSize[2];                               \
      const size_t first = (z * height + y) * width;                                               \
      const size_t end = isThere ? (first + endX) * elements : 0;                                  \
      for (size_t e = (first + beginX) * elements; e < end; ++e)                                   \
      {                                                                                            \
        target[e] = value;                                                                         \
      }                                                                                            \
    }                                                                                              \
  }

FILL_PATCHES(FillPatches1, uchar)
FILL_PATCHES(FillPatches2, ushort)
FILL_PATCHES(FillPatches4, uint)
FILL_PATCHES(FillPatches8, ulong)
