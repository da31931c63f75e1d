// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFailure_h
#define DeformVolumeFailure_h

#include <stdexcept>

/// An error that ends the program with the exit code 1.
class Failure : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// An error in the command line, which ends the program with the exit code 2.
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

#endif
