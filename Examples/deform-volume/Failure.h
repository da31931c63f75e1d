// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFailure_h
#define DeformVolumeFailure_h

#include <stdexcept>

/// The program cannot go on: exit code 1.
class Failure : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// The program was called in a way that makes no sense: exit code 2.
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

#endif
