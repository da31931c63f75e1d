// SPDX-License-Identifier: BSD-3-Clause
// The output of ChainMail, and the check of the limits. This text comes after ChainMailBlocks.cl.

// Writes the displacements of a row in world units. fma rounds once on every device, so all devices give the same
// results.
INLINE void WriteRow(
  const int8* x, __global int* output, size_t index, int count, const ChainMailGrid* g)
{
  float8 world[3];
  for (int k = 0; k < 3; ++k)
  {
    const float scale = 1.0f / DEFORMVOLUME_CHAINMAIL_UNITS;
    world[k] = fma((float8)(g->ToWorld[3 * k]), convert_float8(x[0]) * scale,
      fma((float8)(g->ToWorld[3 * k + 1]), convert_float8(x[1]) * scale,
        (float8)(g->ToWorld[3 * k + 2]) * (convert_float8(x[2]) * scale)));
  }
  int values[3][8];
  for (int k = 0; k < 3; ++k)
  {
    vstore8(as_int8(world[k]), 0, values[k]);
  }
  for (int i = 0; i < count; ++i)
  {
    output[index + 3 * i] = values[0][i];
    output[index + 3 * i + 1] = values[1][i];
    output[index + 3 * i + 2] = values[2][i];
  }
}

// Restores blocks to their state before the step. isEnd: whether the step ends here, so that `saved` must become the
// output again.
__kernel void Restore(__global int* displacements, __global uchar* flags, __global int* saved,
  __global const uint* list, const int isEnd, const ChainMailGrid g)
{
  const uint block = list[2 * get_group_id(0)];
  FOR_ROWS(r)
  {
    size_t index;
    const int count = FindOutputRow(block, r, &g, &index);
    int8 x[3];
    for (int c = 0; c < 3; ++c)
    {
      __global int* row = displacements + ((size_t)block * 3 + c) * VOXELS + 8 * r;
      for (int i = 0; i < count; ++i)
      {
        row[i] = saved[index + c * count + i];
      }
      x[c] = vload8(0, row);
    }
    vstore8((uchar8)(0), 0, flags + (size_t)block * VOXELS + 8 * r);
    if (isEnd)
    {
      WriteRow(x, saved, index, count, &g);
    }
  }
}

// Returns the largest violation of limits of a row.
INLINE int FindViolation(const int8* x, uchar8 m, __global const int* displacements,
  __global const uchar* links, __global const uchar* materials, __global const int* limits,
  uint block, int r, const ChainMailGrid* g)
{
  int8 largest = 0;
  UNROLL_FACES
  for (int face = 0; face < 6; ++face)
  {
    Neighbors n;
    FindNeighbors(&n, displacements, links, materials, block, r, face, g);
    const int8 there = convert_int8(n.Links) != 0;
    int8 over[3], under[3];
    FindLimitsBeside(limits, m, n.Materials, face, over, under);
    UNROLL
    for (int c = 0; c < 3; ++c)
    {
      const int8 difference = x[c] - n.Displacements[c];
      largest = max(
        largest, select((int8)(0), max(difference - over[c], -difference - under[c]), there));
    }
  }
  const int4 four = max(largest.lo, largest.hi);
  const int2 two = max(four.lo, four.hi);
  return max(two.x, two.y);
}

// Finds the largest violation in blocks.
__kernel void Check(__global const int* displacements, __global const uchar* links,
  __global const uchar* materials, __global const int* limits, __global uint* shared,
  __global const uint* list, const ChainMailGrid g)
{
  const uint block = list[2 * get_group_id(0)];
  FOR_ROWS(r)
  {
    int8 x[3];
    for (int c = 0; c < 3; ++c)
    {
      x[c] = vload8(r, displacements + ((size_t)block * 3 + c) * VOXELS);
    }
    const uchar8 m = vload8(r, materials + (size_t)block * VOXELS);
    const int violation =
      FindViolation(x, m, displacements, links, materials, limits, block, r, &g);
    if (violation > 0)
    {
      atomic_max(shared + DEFORMVOLUME_VIOLATION, (uint)violation);
    }
  }
}

// Writes the output of blocks.
__kernel void Write(__global const int* displacements, __global int* output,
  __global const uint* list, const ChainMailGrid g)
{
  const uint block = list[2 * get_group_id(0)];
  FOR_ROWS(r)
  {
    size_t index;
    const int count = FindOutputRow(block, r, &g, &index);
    int8 x[3];
    for (int c = 0; c < 3; ++c)
    {
      x[c] = vload8(r, displacements + ((size_t)block * 3 + c) * VOXELS);
    }
    WriteRow(x, output, index, count, &g);
  }
}

// Ends a step, for blocks that were saved: clears flags, counts moved voxels, checks limits and writes the output.
__kernel void Finish(__global const int* displacements, __global uchar* flags,
  __global const uchar* links, __global const uchar* materials, __global const int* limits,
  __global int* output, __global uint* shared, __global const uint* list, __global uint* results,
  const ChainMailGrid g)
{
  __local uint moved;
  if (get_local_id(0) == 0)
  {
    moved = 0;
  }
  BARRIER();
  const uint block = list[2 * get_group_id(0)];
  uint movedRows = 0;
  FOR_ROWS(r)
  {
    size_t index;
    const int count = FindOutputRow(block, r, &g, &index);
    int8 x[3];
    int8 isMoved = 0;
    for (int c = 0; c < 3; ++c)
    {
      x[c] = vload8(r, displacements + ((size_t)block * 3 + c) * VOXELS);
      int before[8];
      vstore8(x[c], 0, before);
      for (int i = 0; i < count; ++i)
      {
        before[i] = output[index + c * count + i];
      }
      isMoved |= vload8(0, before) != x[c];
    }
    vstore8((uchar8)(0), r, flags + (size_t)block * VOXELS);
    const uchar8 m = vload8(r, materials + (size_t)block * VOXELS);
    const int4 four = isMoved.lo + isMoved.hi;
    const int rowMoved = -(four.x + four.y + four.z + four.w);
    if (rowMoved)
    {
      const int violation =
        FindViolation(x, m, displacements, links, materials, limits, block, r, &g);
      if (violation > 0)
      {
        atomic_max(shared + DEFORMVOLUME_VIOLATION, (uint)violation);
      }
      movedRows += rowMoved;
    }
    WriteRow(x, output, index, count, &g);
  }
#if SERIAL
  moved = movedRows;
#else
  atomic_add(&moved, movedRows);
#endif
  BARRIER();
  if (get_local_id(0) == 0)
  {
    results[get_group_id(0)] = moved;
  }
}
