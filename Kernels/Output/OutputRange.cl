// SPDX-License-Identifier: BSD-3-Clause
// The range of what a component of an output holds. In front of this text: TYPE, TYPE_LEAST and TYPE_MOST, of which all
// values of the type lie between, and IS_FINITE(value); and GroupReduction.cl.

// The least values, and the largest ones.
#define JOIN_ENDS(row, a, b) ((row) == 0 ? ((b) < (a) ? (b) : (a)) : ((b) > (a) ? (b) : (a)))

// A work-group leaves its least and its largest finite value side by side, those that are TYPE_MOST and TYPE_LEAST
// where there is none, and adds 1 to others where it has met other values. run: tuples in a row that an item takes,
// before those of the other items follow. ends: two values an item.
__kernel void FindRange(__global const TYPE* values, const ulong tuples, const uint components, const uint component,
  const uint run, __global TYPE* found, __global uint* others, __local TYPE* ends)
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
  ends[get_local_id(0)] = low;
  ends[get_local_size(0) + get_local_id(0)] = high;
  if (anyOther)
  {
    atomic_inc(others);
  }
  REDUCE_ROWS(ends, 2, JOIN_ENDS)
  if (get_local_id(0) == 0)
  {
    found[2 * get_group_id(0)] = ends[0];
    found[2 * get_group_id(0) + 1] = ends[get_local_size(0)];
  }
}
