/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks for the tests in C. Each test is one source file, which has its own count of failures. */
#ifndef Check_h
#define Check_h

#include "deformvolume.h"

#include <stdio.h>
#include <string.h>

static int Failures = 0;

#define CHECK(condition)                                                                           \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      printf(                                                                                      \
        "%s:%d: not true: %s. Last error: %s\n", __FILE__, __LINE__, #condition, dv_last_error()); \
      ++Failures;                                                                                  \
    }                                                                                              \
  } while (0)

/* Checks that a call fails with an error that contains these words. */
#define REFUSED(call, words)                                                                       \
  do                                                                                               \
  {                                                                                                \
    CHECK((call) == DV_ERROR);                                                                     \
    CHECK(strstr(dv_last_error(), words) != NULL);                                                 \
  } while (0)

#endif
