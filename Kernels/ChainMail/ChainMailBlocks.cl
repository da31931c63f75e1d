// SPDX-License-Identifier: BSD-3-Clause
// Code that the ChainMail kernels share: blocks of voxels, their links, and their rows in the output.
//
// A work-group processes a block of the list, and its work-items share the rows of eight voxels. On CPUs a work-group
// is a single work-item, and SERIAL is 1.
//
// displacements: for each block, 512 integers for each axis. flags, links, materials: for each block, 512 bytes.
//
// limits: for component c and axis a of a link, ((3 c + a) * 2 + way) * 256 + material. Way 0: how much greater the
// displacement may be at the upper end of the link than at the lower end. Way 1: how much smaller. The limit of a
// link is the mean of those of its two voxels.
//
// saved: three numbers per voxel of the volume. This is the memory of the output, which is not needed during a step.
// For each block that the step has changed, it holds the displacements before the step.

#define INLINE static inline __attribute__((always_inline))
#define ROWS DEFORMVOLUME_BLOCK_ROWS
#define VOXELS DEFORMVOLUME_BLOCK_VOXELS
#define NO_LIMIT DEFORMVOLUME_NO_LIMIT
// Keeps arrays of vectors in registers.
#define UNROLL _Pragma("unroll")
// For loops over the faces: unrolled, they would need more registers than GPUs have.
#if SERIAL
#define UNROLL_FACES UNROLL
#else
#define UNROLL_FACES _Pragma("unroll 1")
#endif

#if SERIAL
#define BARRIER()
#define OR_INTO(word, bits) (*(word) |= (bits))
#define FOR_ROWS(r) for (int r = 0; r < ROWS; ++r)
#else
#define BARRIER() barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE)
#define OR_INTO(word, bits) atomic_or(word, bits)
// All work-items make the same number of iterations. PoCL 6.0 on CPUs with AVX-512 miscompiles loops of r that begin at
// the number of the work-item, and does not compile this loop without the casts.
#define FOR_ROWS(r)                                                                                \
  for (int turn = 0, r = (int)get_local_id(0);                                                     \
       turn < (int)(ROWS + get_local_size(0) - 1) / (int)get_local_size(0);                        \
       ++turn, r += (int)get_local_size(0))                                                        \
    if (r < ROWS)
#endif

// Whether a block has a neighbor on a face, and the number of that neighbor.
INLINE int HasNeighbor(uint block, int face, const ChainMailGrid* g)
{
  const int at[3] = { block % g->Blocks[0], block / g->Blocks[0] % g->Blocks[1],
    block / (g->Blocks[0] * g->Blocks[1]) };
  const int axis = face >> 1;
  return face & 1 ? at[axis] + 1 < g->Blocks[axis] : at[axis] > 0;
}
INLINE uint NeighborOf(uint block, int face, const ChainMailGrid* g)
{
  const uint steps[3] = { 1, g->Blocks[0], g->Blocks[0] * g->Blocks[1] };
  return face & 1 ? block + steps[face >> 1] : block - steps[face >> 1];
}

INLINE __global const int* Limits(__global const int* limits, int component, int axis, int way)
{
  return limits + ((3 * component + axis) * 2 + way) * 256;
}

// Looks up the values of eight materials, which are mostly the same.
INLINE int8 LookUp(__global const int* table, uchar8 m)
{
  const ulong all = as_ulong(m);
  if (all == (all & 255) * 0x0101010101010101UL)
  {
    return (int8)(table[m.s0]);
  }
  return (int8)(table[m.s0], table[m.s1], table[m.s2], table[m.s3], table[m.s4], table[m.s5],
    table[m.s6], table[m.s7]);
}

// Whether the 16 materials of a and b are all the same.
INLINE int AreAlike(uchar8 a, uchar8 b)
{
  const ulong all = as_ulong(a);
  return all == as_ulong(b) && all == (all & 255) * 0x0101010101010101UL;
}

// Finds how much greater (over) and how much smaller (under) each component of displacements may be than that of the
// neighbors on a face.
INLINE void FindLimitsBeside(
  __global const int* limits, uchar8 m, uchar8 beside, int face, int8* over, int8* under)
{
  const int axis = face >> 1;
  const int areAlike = AreAlike(m, beside);
  UNROLL
  for (int c = 0; c < 3; ++c)
  {
    __global const int* more = Limits(limits, c, axis, face & 1);
    __global const int* less = Limits(limits, c, axis, ~face & 1);
    if (areAlike)
    {
      over[c] = (int8)(more[m.s0]);
      under[c] = (int8)(less[m.s0]);
    }
    else
    {
      over[c] = (LookUp(more, m) + LookUp(more, beside)) >> 1;
      under[c] = (LookUp(less, m) + LookUp(less, beside)) >> 1;
    }
  }
}

// Returns the limits of eight links from the values of their two voxels. links: the bytes of the voxels at the lower
// ends.
INLINE int8 LinkLimits(int8 a, int8 b, uchar8 links, int axis)
{
  const int8 there = (convert_int8(links) & (1 << axis)) != 0;
  return select((int8)(NO_LIMIT), (a + b) >> 1, there);
}

// Finds the row next to row r on one of the faces -y to +z: its offset in flags, links and materials. Returns whether
// that row exists.
INLINE int FindRow(uint block, int r, int face, const ChainMailGrid* g, size_t* offset)
{
  const int steps[3] = { 0, 1, 8 };
  const int word = face < 4 ? r & 7 : r >> 3;
  const int step = steps[face >> 1];
  if (face & 1 ? word < 7 : word > 0)
  {
    *offset = (size_t)block * VOXELS + 8 * (face & 1 ? r + step : r - step);
    return 1;
  }
  const int has = HasNeighbor(block, face, g);
  *offset = has
    ? (size_t)NeighborOf(block, face, g) * VOXELS + 8 * (face & 1 ? r - 7 * step : r + 7 * step)
    : (size_t)block * VOXELS + 8 * r;
  return has;
}

// Returns a component of the displacements of the row at an offset.
INLINE __global const int* RowAt(__global const int* displacements, size_t offset, int component)
{
  return displacements + offset / VOXELS * 3 * VOXELS + component * VOXELS + offset % VOXELS;
}

// The neighbors of the voxels of a row on one side.
typedef struct
{
  int8 Displacements[3];
  uchar8 Links; // nonzero if there is a link to the neighbor
  uchar8 Materials;
} Neighbors;

INLINE void FindNeighbors(Neighbors* n, __global const int* displacements,
  __global const uchar* links, __global const uchar* materials, uint block, int r, int face,
  const ChainMailGrid* g)
{
  const size_t own = (size_t)block * VOXELS + 8 * r;
  if (face >= 2)
  {
    size_t offset;
    const int has = FindRow(block, r, face, g, &offset);
    const uchar8 lower = vload8(0, links + (face & 1 ? own : offset));
    n->Links = has ? (lower >> (uchar8)(face >> 1)) & (uchar8)(1) : (uchar8)(0);
    n->Materials = vload8(0, materials + offset);
    UNROLL
    for (int c = 0; c < 3; ++c)
    {
      n->Displacements[c] = vload8(0, RowAt(displacements, offset, c));
    }
    return;
  }
  const int has = HasNeighbor(block, face, g);
  const size_t beside =
    has ? (size_t)NeighborOf(block, face, g) * VOXELS + 8 * r + (face ? 0 : 7) : own;
  const uchar8 l = vload8(0, links + own);
  const uchar8 m = vload8(0, materials + own);
  const uchar linkBeside = has ? links[beside] : 0;
  const uchar materialBeside = materials[beside];
  n->Links = face ? l & (uchar8)(1) : (uchar8)(linkBeside, l.s0123, l.s456) & (uchar8)(1);
  n->Links.s7 = face && !has ? 0 : n->Links.s7;
  n->Materials =
    face ? (uchar8)(m.s123, m.s4567, materialBeside) : (uchar8)(materialBeside, m.s0123, m.s456);
  UNROLL
  for (int c = 0; c < 3; ++c)
  {
    const int8 x = vload8(0, RowAt(displacements, own, c));
    const int xBeside = *RowAt(displacements, beside, c);
    n->Displacements[c] = face ? (int8)(x.s123, x.s4567, xBeside) : (int8)(xBeside, x.s0123, x.s456);
  }
}

// Returns the number of voxels of a block's row that lie in the volume. word: set to the offset of the first of them in
// the output.
INLINE int FindOutputRow(uint block, int r, const ChainMailGrid* g, size_t* word)
{
  const int x = block % g->Blocks[0] * 8;
  const int y = block / g->Blocks[0] % g->Blocks[1] * 8 + (r & 7);
  const int z = block / (g->Blocks[0] * g->Blocks[1]) * 8 + (r >> 3);
  *word = (((size_t)z * g->Size[1] + y) * g->Size[0] + x) * 3;
  return y < g->Size[1] && z < g->Size[2] ? min(8, g->Size[0] - x) : 0;
}

INLINE void SaveBlock(
  __global const int* displacements, __global int* saved, uint block, const ChainMailGrid* g)
{
  FOR_ROWS(r)
  {
    size_t word;
    const int count = FindOutputRow(block, r, g, &word);
    for (int c = 0; c < 3; ++c)
    {
      __global const int* row = displacements + ((size_t)block * 3 + c) * VOXELS + 8 * r;
      for (int i = 0; i < count; ++i)
      {
        saved[word + c * count + i] = row[i];
      }
    }
  }
}

__kernel void Save(__global const int* displacements, __global int* saved,
  __global const uint* list, const ChainMailGrid g)
{
  SaveBlock(displacements, saved, list[2 * get_group_id(0)], &g);
}

__kernel void ClearFlags(__global uchar* flags, __global const uint* list)
{
  const uint block = list[2 * get_group_id(0)];
  FOR_ROWS(r)
  {
    vstore8((uchar8)(0), 0, flags + (size_t)block * VOXELS + 8 * r);
  }
}

__kernel void ResetDisplacements(__global int* displacements, __global const uint* list)
{
  const uint block = list[2 * get_group_id(0)];
  FOR_ROWS(r)
  {
    for (int c = 0; c < 3; ++c)
    {
      vstore8((int8)(0), 0, displacements + ((size_t)block * 3 + c) * VOXELS + 8 * r);
    }
  }
}

// Moves the voxels of handles. voxels: for each voxel, its index in the arrays of all blocks, and its handle. targets:
// for each handle, its displacement, and the flags of its voxels. If the flags have no bits of systems, the voxels are
// held at their current displacement.
__kernel void Hold(__global int* displacements, __global uchar* flags, __global const uchar* links,
  __global const uint* voxels, __global const int* targets, __global uint* shared,
  __global uint* counts, const uint end)
{
  const uint i = get_global_id(0);
  if (i >= end)
  {
    return;
  }
  const uint voxel = voxels[2 * i];
  const uint handle = voxels[2 * i + 1];
  const uchar kind = links[voxel];
  const uchar set = targets[4 * handle + 3];
  if (!(kind & DEFORMVOLUME_ELEMENT) || (kind & DEFORMVOLUME_PINNED) || !set)
  {
    return;
  }
  atomic_inc(counts + handle);
  flags[voxel] = set;
  if (!(set & DEFORMVOLUME_ALL_SYSTEMS))
  {
    return;
  }
  uint needed = 0;
  for (int c = 0; c < 3; ++c)
  {
    __global int* x =
      displacements + (size_t)(voxel / VOXELS) * 3 * VOXELS + c * VOXELS + voxel % VOXELS;
    const int target = targets[4 * handle + c];
    needed |= target < *x ? 1u << c : target > *x ? 8u << c : 0;
    *x = target;
  }
  if (needed)
  {
    atomic_or(shared + DEFORMVOLUME_NEEDED, needed);
  }
}
