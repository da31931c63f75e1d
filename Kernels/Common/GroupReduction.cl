// SPDX-License-Identifier: BSD-3-Clause
// Reductions over the work-items of a group.

// Reduces rows of values in local memory, with one value per work-item in each row, by the expression JOIN(row, a, b).
// All work-items of the group must execute this macro. The result of a row replaces the value of its first work-item.
#define REDUCE_ROWS(rows, number, JOIN)                                                            \
  {                                                                                                \
    const size_t reduced = get_local_size(0);                                                      \
    barrier(CLK_LOCAL_MEM_FENCE);                                                                  \
    for (size_t left = reduced, middle = (left + 1) / 2; left > 1;                                 \
         left = middle, middle = (left + 1) / 2)                                                   \
    {                                                                                              \
      for (int row = 0; row < (number) && get_local_id(0) + middle < left; ++row)                  \
      {                                                                                            \
        const size_t own = row * reduced + get_local_id(0);                                        \
        rows[own] = JOIN(row, rows[own], rows[own + middle]);                                      \
      }                                                                                            \
      barrier(CLK_LOCAL_MEM_FENCE);                                                                \
    }                                                                                              \
  }
