/* SPDX-License-Identifier: BSD-3-Clause */
/* All kinds of symbols that the linker supports: functions and data of this object and of the C
 * library. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int64_t linked_data[3] = { 1, 2, 3 };
static int64_t zeroes[1000];
int64_t* linked_pointer = &linked_data[1];
static const double factors[4] = { 0.5, 0.25, 2.0, 4.0 };
extern char** environ;

static int compare(const void* a, const void* b)
{
  return *(const int64_t*)a < *(const int64_t*)b ? -1 : *(const int64_t*)a > *(const int64_t*)b;
}

static int (*const comparisons[2])(const void*, const void*) = { compare, NULL };

double linked_multiply(int which, double x)
{
  return factors[which] * x;
}

int64_t linked_sum(void)
{
  int64_t numbers[4] = { 40, 10, 30, 20 };
  int64_t copy[4];
  memset(zeroes, 1, sizeof(zeroes));
  memcpy(copy, numbers, sizeof(copy));
  qsort(copy, 4, sizeof(copy[0]), comparisons[0]);
  return copy[0] * 1000 + copy[3] + *linked_pointer + linked_data[0] + (zeroes[999] & 255) +
    (environ ? 100 : 0);
}

int* linked_errors(void)
{
  extern int* __errno_location(void);
  return __errno_location();
}
