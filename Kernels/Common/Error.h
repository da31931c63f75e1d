// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeError_h
#define DeformVolumeError_h

#include "DeformVolumeExport.h"

#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

/// The engine, which deforms arrays on OpenCL devices. Its interface uses no types of VTK or
/// OpenCL.
namespace deformvolume
{

/// The exception of this library. The message says what is wrong and how to correct it.
class DEFORMVOLUME_EXPORT Error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Thrown when a progress callback requested an abort. This is not a failure.
class DEFORMVOLUME_EXPORT Aborted : public std::exception
{
public:
  /// Returns "aborted".
  const char* what() const noexcept override { return "aborted"; }
};

/// Returns a number for a message, with up to seven significant digits.
inline std::string FormatNumber(double number)
{
  char digits[32];
  std::snprintf(digits, sizeof(digits), "%.7g", number);
  return digits;
}

} // namespace deformvolume

#endif
