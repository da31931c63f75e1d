// SPDX-License-Identifier: BSD-3-Clause
// The range of what a component of an output holds. In front of this text: TYPE, TYPE_LEAST and TYPE_MOST, of which all
// values of the type lie between, and IS_FINITE(value).

// A work-group leaves its least and its largest finite value side by side, those that are TYPE_MOST and TYPE_LEAST
// where there is none, and adds 1 to others where it has met other values. run: tuples in a row that an item takes,
// before those of the other items follow. least, most: a value an item.
__kernel void FindRange(__global const TYPE* values, const ulong tuples, const uint components, const uint component,
  const uint run, __global TYPE* found, __global uint* others, __local TYPE* least, __local TYPE* most)
{
  TYPE low = TYPE_MOST;
  TYPE high = TYPE_LEAST;
  int anyOther = 0;
  for (size_t first = get_global_id(0) * run; first < tuples; first += get_global_size(0) * run)
  {
    const size_t end = min(first + run, (size_t)tuples);
    for (size_t i = first; i < end; ++i)
    {
      const TYPE value = values[i * components + component];
      const int isFinite = IS_FINITE(value);
      low = isFinite && value < low ? value : low;
      high = isFinite && value > high ? value : high;
      anyOther |= !isFinite;
    }
  }
  const size_t item = get_local_id(0);
  least[item] = low;
  most[item] = high;
  if (anyOther)
  {
    atomic_inc(others);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (size_t left = get_local_size(0); left > 1;)
  {
    const size_t middle = (left + 1) / 2;
    if (item + middle < left)
    {
      least[item] = least[item + middle] < least[item] ? least[item + middle] : least[item];
      most[item] = most[item + middle] > most[item] ? most[item + middle] : most[item];
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    left = middle;
  }
  if (item == 0)
  {
    found[2 * get_group_id(0)] = least[0];
    found[2 * get_group_id(0) + 1] = most[0];
  }
}
