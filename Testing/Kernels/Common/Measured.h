// SPDX-License-Identifier: BSD-3-Clause
// What validation.py reads of the results of tests.
#ifndef Measured_h
#define Measured_h

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

/// Has a number that was measured in the results of the test that runs (--gtest_output=json).
inline void RecordMeasured(const std::string& name, double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.11g", value);
  testing::Test::RecordProperty(name, text);
}

#endif
