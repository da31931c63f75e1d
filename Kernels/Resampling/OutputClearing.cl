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
