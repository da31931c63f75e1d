// SPDX-License-Identifier: BSD-3-Clause
// The range of a component of an output. The host defines before this text: TYPE; TYPE_LEAST and TYPE_MOST, the ends
// of the range of that type; IS_FINITE(value). This text comes after GroupReduction.cl.

// Joins two least values (row 0), or two largest values.
#define JOIN_ENDS(row, a, b) ((row) == 0 ? ((b) < (a) ? (b) : (a)) : ((b) > (a) ? (b) : (a)))

// Each work-group writes its least and its largest finite value; TYPE_MOST and TYPE_LEAST if there is none.
// Work-items with values that are not finite increment `others`. portion: number of consecutive tuples that a work-item
// processes at a time. ends: local memory for two values per work-item.
__kernel void FindRange(__global const TYPE* values, const ulong tuples, const uint components, const uint component,
  const uint portion, __global TYPE* found, __global uint* others, __local TYPE* ends)
{
  TYPE low = TYPE_MOST;
  TYPE high = TYPE_LEAST;
  int anyOther = 0;
  for (size_t first = get_global_id(0) * portion; first < tuples; first += get_global_size(0) * portion)
  {
    const size_t end = min(first + portion, (size_t)tuples);
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
