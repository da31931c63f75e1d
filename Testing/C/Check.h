/* SPDX-License-Identifier: BSD-3-Clause */
/* What the tests in C have in common, each of which is one source file. */
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
      printf("line %d: %s is false. Last error: %s\n", __LINE__, #condition, dv_last_error());     \
      ++Failures;                                                                                  \
    }                                                                                              \
  } while (0)

/* A call that fails with an error that holds some words. */
#define REFUSED(call, words)                                                                       \
  do                                                                                               \
  {                                                                                                \
    CHECK((call) == DV_ERROR);                                                                     \
    CHECK(strstr(dv_last_error(), words) != NULL);                                                 \
  } while (0)

#endif
