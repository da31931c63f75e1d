// SPDX-License-Identifier: BSD-3-Clause
// Propagates the motion of handles to other voxels. This text comes after ChainMailBlocks.cl.
//
// A system is one component of the displacements in one direction. When handles move, the links bound the displacement
// of each voxel: it is at most the displacement of a handle plus the limits of the links on any path from there, and at
// least that displacement minus the limits. The voxels of handles are marked. Voxels beyond their bound are moved to
// the bound and marked. Only marked voxels bound others. A visit computes the bounds in a block, from its marked voxels
// and those around it, until they do not change any more. Bounds are minima of sums of integers, so the final bounds do
// not depend on the order of visits and rows.
//
// Blocks that share a face are not visited in the same launch. Without SERIAL, neighboring rows are not updated between
// the same two barriers. Therefore no work-item reads what another one writes.

// Systems that push voxels up are computed like systems that pull voxels down, with reversed signs.
INLINE int8 Upright(int system, int8 x)
{
  return system < 3 ? x : -x;
}

// Bounds a row by marked voxels outside the block. Returns the new bounds.
INLINE int8 BoundByNeighbors(int8 bound, __global const int* displacements,
  __global const uchar* flags, __global const uchar* links, __global const uchar* materials,
  __global const int* limits, uint block, int r, int system, const ChainMailGrid* g)
{
  const size_t own = (size_t)block * VOXELS + 8 * r;
  const int c = system % 3;
  const int up = system / 3;
  for (int side = 0; side < 2; ++side)
  {
    if (!HasNeighbor(block, side, g))
    {
      continue;
    }
    const size_t beside =
      (size_t)NeighborOf(block, side, g) * VOXELS + 8 * r + (side ? 0 : 7);
    const size_t near = own + (side ? 7 : 0);
    if ((flags[beside] >> system & 1) && (links[side ? near : beside] & 1))
    {
      __global const int* table = Limits(limits, c, 0, side ^ up);
      const int x = *RowAt(displacements, beside, c);
      const int found =
        (up ? -x : x) + ((table[materials[beside]] + table[materials[near]]) >> 1);
      if (side)
      {
        bound.s7 = min(bound.s7, found);
      }
      else
      {
        bound.s0 = min(bound.s0, found);
      }
    }
  }
  for (int face = 2; face < 6; ++face)
  {
    const int index = face < 4 ? r & 7 : r >> 3;
    size_t beside;
    if (index != (face & 1 ? 7 : 0) || !FindRow(block, r, face, g, &beside))
    {
      continue;
    }
    const uchar8 marks = vload8(0, flags + beside) & (uchar8)(1 << system);
    if (!as_ulong(marks))
    {
      continue;
    }
    const int axis = face >> 1;
    __global const int* table = Limits(limits, c, axis, (face & 1) ^ up);
    const int8 x = Upright(system, vload8(0, RowAt(displacements, beside, c)));
    const int8 limit =
      LinkLimits(LookUp(table, vload8(0, materials + beside)),
        LookUp(table, vload8(0, materials + own)), vload8(0, links + (face & 1 ? own : beside)), axis);
    const int8 marked = convert_int8(marks) != 0;
    bound = min(bound, select((int8)(NO_LIMIT), x, marked) + limit);
  }
  return bound;
}

// Bounds voxels by other voxels of the same row. forward, backward: limits of the links that begin at the voxels.
INLINE int8 BoundAlongRow(int8 bound, int8 forward, int8 backward)
{
  const int none = NO_LIMIT;
  int8 sum = bound + forward;
  bound = min(bound, (int8)(none, sum.s0123, sum.s456));
  int8 limit = min(forward + (int8)(forward.s123, forward.s4567, none), (int8)(none)); // of two links
  sum = bound + limit;
  bound = min(bound, (int8)(none, none, sum.s0123, sum.s45));
  limit = min(limit + (int8)(limit.s23, limit.s4567, none, none), (int8)(none)); // of four links
  sum = bound + limit;
  bound = min(bound, (int8)(none, none, none, none, sum.s0123));
  limit = backward;
  bound = min(bound, (int8)(bound.s123, bound.s4567, none) + limit);
  limit = min(limit + (int8)(limit.s123, limit.s4567, none), (int8)(none));
  bound = min(bound, (int8)(bound.s23, bound.s4567, none, none) + limit);
  limit = min(limit + (int8)(limit.s23, limit.s4567, none, none), (int8)(none));
  return min(bound, (int8)(bound.s4567, none, none, none, none) + limit);
}

INLINE int IsAny(int8 a)
{
  const int4 four = a.lo | a.hi;
  const int2 two = four.lo | four.hi;
  return (two.x | two.y) != 0;
}

// Updates the bounds of one row in a sweep. Returns whether they changed.
INLINE int SweepRow(__local int8* bounds, __local int8* forward, __local int8* backward,
  int backwardAxis, int r, int first)
{
  const int y = r & 7;
  const int z = r >> 3;
  __local int8* backwardX = backwardAxis == 0 ? backward : forward;
  __local int8* backwardY = backwardAxis == 1 ? backward : forward + ROWS;
  __local int8* backwardZ = backwardAxis == 2 ? backward : forward + 2 * ROWS;
  const int8 before = bounds[r];
  int8 bound = before;
  if (y > 0)
  {
    bound = min(bound, bounds[r - 1] + forward[ROWS + r - 1]);
  }
  if (y < 7)
  {
    bound = min(bound, bounds[r + 1] + backwardY[r]);
  }
  if (z > 0)
  {
    bound = min(bound, bounds[r - 8] + forward[2 * ROWS + r - 8]);
  }
  if (z < 7)
  {
    bound = min(bound, bounds[r + 8] + backwardZ[r]);
  }
  if (first || IsAny(bound < before))
  {
    bound = BoundAlongRow(bound, forward[r], backwardX[r]);
    bounds[r] = bound;
  }
  return IsAny(bound < before);
}

// Sweeps over the rows until nothing changes. Limits are not negative, so no shortest path visits a voxel twice, and the
// sweeps end: at the latest after as many as the block has voxels.
INLINE void SweepBlock(__local int8* bounds, __local int8* forward, __local int8* backward,
  int backwardAxis, __local int* changed)
{
  for (int sweep = 0; sweep <= VOXELS; ++sweep)
  {
#if SERIAL
    int isChanged = 0;
    for (int k = 0; k < ROWS; ++k)
    {
      isChanged |=
        SweepRow(bounds, forward, backward, backwardAxis, sweep & 1 ? ROWS - 1 - k : k, sweep == 0);
    }
#else
    if (get_local_id(0) == 0)
    {
      *changed = 0;
    }
    for (int parity = 0; parity < 2; ++parity)
    {
      BARRIER();
      FOR_ROWS(r)
      {
        if (((r ^ r >> 3) & 1) == parity &&
          SweepRow(bounds, forward, backward, backwardAxis, r, sweep == 0))
        {
          OR_INTO(changed, 1);
        }
      }
    }
    BARRIER();
    const int isChanged = *changed;
    BARRIER();
#endif
    if (!isChanged)
    {
      return;
    }
  }
}

// Finds the limits of the links inside a block. Links of the last rows lead to other blocks and are not included.
INLINE void FindLimits(__local int8* forward, __local int8* backward, __global const uchar* links,
  __global const uchar* materials, __global const int* limits, uint block, int r, int system)
{
  const int c = system % 3;
  const int up = system / 3;
  const int steps[3] = { 0, 1, 8 };
  const uchar8 l = vload8(r, links + (size_t)block * VOXELS);
  const uchar8 m = vload8(r, materials + (size_t)block * VOXELS);
  for (int axis = 0; axis < 3; ++axis)
  {
    const int index = axis == 1 ? r & 7 : r >> 3;
    if (axis > 0 && index == 7)
    {
      continue;
    }
    const uchar8 next = axis == 0
      ? (uchar8)(m.s123, m.s4567, m.s7)
      : vload8(r + steps[axis], materials + (size_t)block * VOXELS);
    __global const int* table = Limits(limits, c, axis, up);
    int8 limit = LinkLimits(LookUp(table, m), LookUp(table, next), l, axis);
    limit.s7 = axis == 0 ? NO_LIMIT : limit.s7;
    forward[axis * ROWS + r] = limit;
    if (axis == c)
    {
      table = Limits(limits, c, axis, 1 - up);
      limit = LinkLimits(LookUp(table, m), LookUp(table, next), l, axis);
      limit.s7 = axis == 0 ? NO_LIMIT : limit.s7;
      backward[r] = limit;
    }
  }
}

// Returns the voxels of a row that are beyond their bounds and can move. For voxels that do not yield, records the
// distance by which they would have to move.
INLINE int8 FindMoved(int8 x, int8 bound, uchar8 flags, uchar8 links, int system,
  __global uint* shared)
{
  const int8 beyond = bound < x;
  if (!IsAny(beyond))
  {
    return beyond;
  }
  const int8 f = convert_int8(flags);
  const int8 pinned = (convert_int8(links) & DEFORMVOLUME_PINNED) != 0;
  const int8 held = ((f & (DEFORMVOLUME_HELD | DEFORMVOLUME_FIXED)) != 0) | pinned;
  const int8 fixedOnes = ((f & DEFORMVOLUME_FIXED) != 0) | pinned;
  const int8 opposite = (f & (1 << (system + 3) % 6)) != 0;
  if (IsAny(beyond & fixedOnes))
  {
    const int8 far = select((int8)(0), x - bound, beyond & fixedOnes);
    const int4 four = max(far.lo, far.hi);
    const int2 two = max(four.lo, four.hi);
    atomic_max(shared + system, (uint)max(two.x, two.y));
  }
  if (IsAny(beyond & ~held & opposite))
  {
    atomic_or(shared + DEFORMVOLUME_CONFLICTS, 1u);
  }
  return beyond & ~held & ~opposite;
}

// Returns the faces of the block on which moved voxels of a row lie, as bits.
INLINE uint FacesOf(int8 moved, int r)
{
  const int y = r & 7;
  const int z = r >> 3;
  return (moved.s0 & 1) | (moved.s7 & 2) | (y == 0 ? 4 : 0) | (y == 7 ? 8 : 0) |
    (z == 0 ? 16 : 0) | (z == 7 ? 32 : 0);
}

// list: for each block, its number and a task. The bits below DEFORMVOLUME_SYSTEMS are the systems in which voxels
// around the block changed. Bit DEFORMVOLUME_SYSTEMS: the block is already saved.
__kernel void Propagate(__global int* displacements, __global uchar* flags,
  __global const uchar* links, __global const uchar* materials, __global const int* limits,
  __global int* saved, __global uint* shared, __global const uint* list, __global uint* results,
  const ChainMailGrid g)
{
  __local int8 bounds[ROWS];
  __local int8 forward[3 * ROWS];
  __local int8 backward[ROWS];
  __local int changed;
  __local uint result;
  const uint block = list[2 * get_group_id(0)];
  const uint task = list[2 * get_group_id(0) + 1];
  // Whether the block is saved is kept in local memory: PoCL 7.1 lost a private variable that the loop sets.
  if (get_local_id(0) == 0)
  {
    result = task >> DEFORMVOLUME_SYSTEMS & 1 ? DEFORMVOLUME_SAVED : 0;
  }
  for (int system = 0; system < DEFORMVOLUME_SYSTEMS; ++system)
  {
    if (!(task >> system & 1))
    {
      continue;
    }
    const int c = system % 3;
    __global int* own = displacements + ((size_t)block * 3 + c) * VOXELS;
    __global uchar* ownFlags = flags + (size_t)block * VOXELS;
    __global const uchar* ownLinks = links + (size_t)block * VOXELS;
    BARRIER();
    FOR_ROWS(r)
    {
      const int8 marked = (convert_int8(vload8(r, ownFlags)) & (1 << system)) != 0;
      const int8 bound =
        select((int8)(NO_LIMIT), Upright(system, vload8(r, own)), marked);
      bounds[r] = BoundByNeighbors(
        bound, displacements, flags, links, materials, limits, block, r, system, &g);
      FindLimits(forward, backward, links, materials, limits, block, r, system);
    }
    BARRIER();
    SweepBlock(bounds, forward, backward, c, &changed);
    if (get_local_id(0) == 0)
    {
      changed = 0;
    }
    BARRIER();
    FOR_ROWS(r)
    {
      const int8 moved = FindMoved(Upright(system, vload8(r, own)), bounds[r],
        vload8(r, ownFlags), vload8(r, ownLinks), system, shared);
      if (IsAny(moved))
      {
        OR_INTO(&changed, 1);
        OR_INTO(&result, FacesOf(moved, r) | 1u << (DEFORMVOLUME_CHANGED_SYSTEMS + system));
      }
    }
    BARRIER();
    if (!changed)
    {
      continue;
    }
    if (!(result & DEFORMVOLUME_SAVED))
    {
      SaveBlock(displacements, saved, block, &g);
      BARRIER();
      if (get_local_id(0) == 0)
      {
        result |= DEFORMVOLUME_SAVED;
      }
    }
    FOR_ROWS(r)
    {
      const int8 x = vload8(r, own);
      const uchar8 f = vload8(r, ownFlags);
      const int8 moved = FindMoved(
        Upright(system, x), bounds[r], f, vload8(r, ownLinks), system, shared);
      vstore8(select(x, Upright(system, bounds[r]), moved), r, own);
      vstore8(f | (convert_uchar8(moved & 1) << (uchar8)(system)), r, ownFlags);
    }
  }
  BARRIER();
  if (get_local_id(0) == 0)
  {
    results[get_group_id(0)] = result;
  }
}
