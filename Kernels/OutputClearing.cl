// SPDX-License-Identifier: BSD-3-Clause
// Gives output voxels what those hold that the deformed volume does not cover: whole arrays, or some
// blocks of them. Elements are moved as bits of their size, whatever their type.
//
// Why not clEnqueueFillBuffer: some drivers for processors fill with one thread, and the first
// touch of fresh memory costs more than all else.

// A work-item fills as many bytes as DEFORMVOLUME_FILLED_BYTES says; size: elements.

// Bytes, and values whose bytes are alike: most of what is filled. The C library sets memory without reading it
// before, where the processor can.
__kernel void Fill1(__global uchar* restrict target, const ulong size, const uchar value)
{
  const size_t begin = get_global_id(0) * DEFORMVOLUME_FILLED_BYTES;
  const size_t end = min(begin + DEFORMVOLUME_FILLED_BYTES, (size_t)size);
  __builtin_memset((void*)(size_t)(target + begin), value, end - begin);
}

// Other values.
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

FILL(Fill2, ushort, ushort16)
FILL(Fill4, uint, uint16)
FILL(Fill8, ulong, ulong16)

// The voxels of a patch of the output.
typedef struct
{
  int First[3];
  int End[3];
} Patch;

static Patch PatchOf(uint number, const KernelParameters* p)
{
  const uint width = DEFORMVOLUME_PATCHES(p->OutputSize[0]);
  const uint height = DEFORMVOLUME_PATCHES(p->OutputSize[1]);
  const uint index[3] = { number % width, number / width % height, number / width / height };
  Patch patch;
  for (int axis = 0; axis < 3; ++axis)
  {
    patch.First[axis] = index[axis] * DEFORMVOLUME_PATCH;
    patch.End[axis] = min(patch.First[axis] + DEFORMVOLUME_PATCH, p->OutputSize[axis]);
  }
  return patch;
}

static size_t OutputPlace(int x, int y, int z, const KernelParameters* p)
{
  return ((size_t)z * p->OutputSize[1] + y) * p->OutputSize[0] + x;
}

// A work-item clears a patch. patches: their numbers; components: elements a voxel.
#define CLEAR_PATCHES(NAME, TYPE)                                                                  \
  __kernel void NAME(__global TYPE* restrict target, const int components, const TYPE value,       \
    __global const uint* restrict patches, const KernelParameters p)                               \
  {                                                                                                \
    const Patch patch = PatchOf(patches[get_global_id(0)], &p);                                    \
    const int size = (patch.End[0] - patch.First[0]) * components;                                 \
    for (int z = patch.First[2]; z < patch.End[2]; ++z)                                            \
    {                                                                                              \
      for (int y = patch.First[1]; y < patch.End[1]; ++y)                                          \
      {                                                                                            \
        __global TYPE* row = target + OutputPlace(patch.First[0], y, z, &p) * components;          \
        for (int i = 0; i < size; ++i)                                                             \
        {                                                                                          \
          row[i] = value;                                                                          \
        }                                                                                          \
      }                                                                                            \
    }                                                                                              \
  }

CLEAR_PATCHES(ClearPatches1, uchar)
CLEAR_PATCHES(ClearPatches2, ushort)
CLEAR_PATCHES(ClearPatches4, uint)
CLEAR_PATCHES(ClearPatches8, ulong)

// A work-item counts the covered voxels of a patch.
__kernel void CountPatches(__global const char* restrict coverage,
  __global const uint* restrict patches, __global uint* restrict sums, const KernelParameters p)
{
  const Patch patch = PatchOf(patches[get_global_id(0)], &p);
  uint sum = 0;
  for (int z = patch.First[2]; z < patch.End[2]; ++z)
  {
    for (int y = patch.First[1]; y < patch.End[1]; ++y)
    {
      __global const char* row = coverage + OutputPlace(0, y, z, &p);
      for (int x = patch.First[0]; x < patch.End[0]; ++x)
      {
        sum += row[x];
      }
    }
  }
  sums[get_global_id(0)] = sum;
}
