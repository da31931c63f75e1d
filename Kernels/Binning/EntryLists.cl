// SPDX-License-Identifier: BSD-3-Clause
// Lists of the tetrahedra in each tile, for devices with many work-items.
//
// An entry is a tetrahedron in the list of a tile. Entries are made in the order of the tetrahedra; the entries of one
// tetrahedron are consecutive. Prefix sums of the numbers of tiles give the tetrahedron of each entry, so that many
// work-items make the entries of a large tetrahedron. The entries are then sorted by keys with a stable radix sort,
// beginning with the lowest bits. A key is twice the tile, plus 1 if the tetrahedron is inverted.
//
// Each work-group processes a range of tetrahedra, entries or tiles. The result does not depend on the number of
// ranges or work-items, or on their order: atomic operations only add numbers and set bits, and are complete at a
// barrier or at the end of the kernel.
//
// This text comes after TetrahedronBinning.cl.

// Divides `count` numbers into consecutive ranges, and returns the index of the first number of one range.
static uint RangeBegin(uint count, uint range, uint ranges)
{
  return (uint)((ulong)count * range / ranges);
}

#define GROUP_BEGIN(count) RangeBegin(count, get_group_id(0), get_num_groups(0))
#define GROUP_END(count) RangeBegin(count, get_group_id(0) + 1, get_num_groups(0))

// Finds the tiles of each tetrahedron, and their number. counters: see RasterParameters.h.
__kernel void FindTiles(__global const int4* tetrahedra, __global const int4* positions,
  __global uint2* boxes, __global uint* counters, __global uint* counts, const RasterParameters p)
{
  uint inverted = 0;
  uint overstretched = 0;
  const uint end = GROUP_END(p.Tetrahedra);
  for (uint t = GROUP_BEGIN(p.Tetrahedra) + get_local_id(0); t < end; t += get_local_size(0))
  {
    const Binned found = Bin(tetrahedra[t], positions, &p);
    inverted += found.Inverted;
    overstretched += found.Overstretched;
    boxes[t] = found.Tiles;
    const uint sizes = found.Tiles.y;
    counts[t] = GetSizeX(sizes) * GetSizeY(sizes) * GetSizeZ(sizes);
  }
  if (inverted > 0)
  {
    atomic_add(counters + DEFORMVOLUME_BINNED_INVERTED, inverted);
  }
  if (overstretched > 0)
  {
    atomic_add(counters + DEFORMVOLUME_BINNED_OVERSTRETCHED, overstretched);
  }
}

// Returns the sum over the work-items before this one, and sets `all` to the total. All work-items of the group must
// call this function.
static ulong SumItemsBefore(ulong own, __local ulong* shared, ulong* all)
{
  const uint item = get_local_id(0);
  const uint items = get_local_size(0);
  shared[item] = own;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0)
  {
    ulong sum = 0;
    for (uint i = 0; i < items; ++i)
    {
      const ulong number = shared[i];
      shared[i] = sum;
      sum += number;
    }
    shared[items] = sum;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  *all = shared[items];
  return shared[item];
}

// Finds the sum of each range of numbers. shared: one value more than there are work-items.
__kernel void SumRanges(
  __global const uint* numbers, const uint count, __global ulong* sums, __local ulong* shared)
{
  ulong own = 0;
  const uint end = GROUP_END(count);
  for (uint i = GROUP_BEGIN(count) + get_local_id(0); i < end; i += get_local_size(0))
  {
    own += numbers[i];
  }
  ulong all;
  SumItemsBefore(own, shared, &all);
  if (get_local_id(0) == 0)
  {
    sums[get_group_id(0)] = all;
  }
}

// Replaces each sum by the sum of the ranges before it, and appends the total. For one work-group.
__kernel void AddSums(const uint ranges, __global ulong* sums, __local ulong* shared)
{
  const uint begin = RangeBegin(ranges, get_local_id(0), get_local_size(0));
  const uint end = RangeBegin(ranges, get_local_id(0) + 1, get_local_size(0));
  ulong own = 0;
  for (uint i = begin; i < end; ++i)
  {
    own += sums[i];
  }
  ulong all;
  ulong sum = SumItemsBefore(own, shared, &all);
  for (uint i = begin; i < end; ++i)
  {
    const ulong number = sums[i];
    sums[i] = sum;
    sum += number;
  }
  if (get_local_id(0) == 0)
  {
    sums[ranges] = all;
  }
}

// Replaces each number by the sum of all numbers before it.
__kernel void AddNumbers(
  __global uint* numbers, const uint count, __global const ulong* sums, __local ulong* shared)
{
  const uint first = GROUP_BEGIN(count);
  const uint length = GROUP_END(count) - first;
  const uint begin = first + RangeBegin(length, get_local_id(0), get_local_size(0));
  const uint end = first + RangeBegin(length, get_local_id(0) + 1, get_local_size(0));
  uint own = 0;
  for (uint i = begin; i < end; ++i)
  {
    own += numbers[i];
  }
  ulong all;
  uint sum = (uint)(sums[get_group_id(0)] + SumItemsBefore(own, shared, &all));
  for (uint i = begin; i < end; ++i)
  {
    const uint number = numbers[i];
    numbers[i] = sum;
    sum += number;
  }
}

// Returns the tetrahedron of an entry, which must not be before `first`. begins: first entry of each tetrahedron.
static uint FindTetrahedron(__global const uint* begins, uint count, uint first, uint entry)
{
  uint low = first;
  uint step = 1;
  while (low + step < count && begins[low + step] <= entry)
  {
    low += step;
    step *= 2;
  }
  uint high = min(low + step, count); // the tetrahedron is before this one
  while (high - low > 1)
  {
    const uint middle = low + (high - low) / 2;
    if (begins[middle] <= entry)
    {
      low = middle;
    }
    else
    {
      high = middle;
    }
  }
  return low;
}

// Finds the key and the tetrahedron of each entry. boxes: the tiles of each tetrahedron. begins: the first entry of
// each tetrahedron.
__kernel void MakeEntries(__global const uint2* boxes, __global const uint* begins,
  const uint entries, __global uint* keys, __global int* lists, const RasterParameters p)
{
  uint t = 0;
  const uint end = GROUP_END(entries);
  for (uint i = GROUP_BEGIN(entries) + get_local_id(0); i < end; i += get_local_size(0))
  {
    t = FindTetrahedron(begins, p.Tetrahedra, t, i);
    const uint2 box = boxes[t];
    const uint inBox = i - begins[t];
    const uint row = inBox / GetSizeX(box.y);
    const uint x = inBox - row * GetSizeX(box.y);
    const uint z = row / GetSizeY(box.y);
    const uint y = row - z * GetSizeY(box.y);
    const uint tile = box.x + (z * p.TileCount[1] + y) * p.TileCount[0] + x;
    keys[i] = 2 * tile + IsInverted(box.y);
    lists[i] = (int)t;
  }
}

static uint GetDigit(uint key, DigitParameters d)
{
  return key >> d.Shift & ((1u << d.Bits) - 1);
}

// Counts the entries with each digit. counters: the number of entries, for each digit and each range of entries.
__kernel void CountDigits(__global const uint* keys, __global uint* counters,
  const DigitParameters d)
{
  __local uint counts[1 << DEFORMVOLUME_DIGIT_BITS];
  const uint item = get_local_id(0);
  const uint items = get_local_size(0);
  for (uint digit = item; digit < 1u << d.Bits; digit += items)
  {
    counts[digit] = 0;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const uint end = GROUP_END(d.Entries);
  for (uint i = GROUP_BEGIN(d.Entries) + item; i < end; i += items)
  {
    atomic_inc(counts + GetDigit(keys[i], d));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (uint digit = item; digit < 1u << d.Bits; digit += items)
  {
    counters[digit * get_num_groups(0) + get_group_id(0)] = counts[digit];
  }
}

// Sorts the entries by a digit of their keys. counters: the index of the first entry, for each digit and each range of
// entries. masks: for each digit, a bit for each work-item. A work-item counts the bits before its own bit to find how
// many work-items before it have the same digit.
__kernel void SortByDigits(__global const uint* keys, __global const int* lists,
  __global const uint* counters, __global uint* sortedKeys, __global int* sortedLists,
  __local uint* masks, const DigitParameters d)
{
  __local uint indices[1 << DEFORMVOLUME_DIGIT_BITS];
  const uint item = get_local_id(0);
  const uint items = get_local_size(0);
  const uint words = (items + 31) / 32;
  for (uint digit = item; digit < 1u << d.Bits; digit += items)
  {
    indices[digit] = counters[digit * get_num_groups(0) + get_group_id(0)];
    for (uint word = 0; word < words; ++word)
    {
      masks[digit * words + word] = 0;
    }
  }
  const uint end = GROUP_END(d.Entries);
  for (uint begin = GROUP_BEGIN(d.Entries); begin < end; begin += items)
  {
    const uint i = begin + item;
    const uint key = i < end ? keys[i] : 0;
    const uint digit = GetDigit(key, d);
    __local uint* mask = masks + digit * words;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (i < end)
    {
      atomic_or(mask + item / 32, 1u << item % 32);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    uint before = 0;
    uint all = 0;
    if (i < end)
    {
      for (uint word = 0; word < words; ++word)
      {
        before += word < item / 32 ? popcount(mask[word]) : 0;
        all += popcount(mask[word]);
      }
      before += popcount(mask[item / 32] & ((1u << item % 32) - 1));
      const uint index = indices[digit] + before;
      sortedKeys[index] = key;
      sortedLists[index] = lists[i];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (i < end && before == all - 1)
    {
      indices[digit] += all;
      for (uint word = 0; word < words; ++word)
      {
        mask[word] = 0;
      }
    }
  }
}

// Finds the first entry of the list of each tile, and the end of the last list. keys: sorted.
__kernel void FindBegins(
  __global const uint* keys, const uint entries, const uint tiles, __global uint* begins)
{
  const uint end = GROUP_END(tiles + 1);
  for (uint tile = GROUP_BEGIN(tiles + 1) + get_local_id(0); tile < end; tile += get_local_size(0))
  {
    uint low = 0;
    uint high = entries;
    while (low < high)
    {
      const uint middle = low + (high - low) / 2;
      if (keys[middle] >> 1 < tile)
      {
        low = middle + 1;
      }
      else
      {
        high = middle;
      }
    }
    begins[tile] = low;
  }
}
