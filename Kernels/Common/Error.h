// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeError_h
#define DeformVolumeError_h

#include "DeformVolumeExport.h"

#include <exception>
#include <stdexcept>
#include <string>

/// The engine: deforms arrays on OpenCL devices. It has no type of VTK or of OpenCL in its
/// interface.
namespace deformvolume
{

/// What this library throws. The message says what is wrong and what to do about it.
class DEFORMVOLUME_EXPORT Error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Thrown when a progress callback asked for an end: not a failure.
class DEFORMVOLUME_EXPORT Aborted : public std::exception
{
public:
  /// Says "aborted".
  const char* what() const noexcept override { return "aborted"; }
};

} // namespace deformvolume

#endif
