// SPDX-License-Identifier: BSD-3-Clause
// The measured values that validation.py reads from the results of tests.
#ifndef Measured_h
#define Measured_h

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

/// Records a measured value in the results of the current test (--gtest_output=json).
inline void RecordMeasured(const std::string& name, double value)
{
  char text[32];
  std::snprintf(text, sizeof(text), "%.11g", value);
  testing::Test::RecordProperty(name, text);
}

#endif
