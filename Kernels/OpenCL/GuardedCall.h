// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeGuardedCall_h
#define DeformVolumeGuardedCall_h

#include "Error.h"
#include "FloatingPointTrapGuard.h"
#include "OpenCLContext.h"

#include <new>
#include <string>

namespace deformvolume
{

/// Calls a function with floating-point traps off. Converts a cl::Error to an Error whose message
/// explains the OpenCL error and ends with `advice`. After a cl::Error or std::bad_alloc, the data
/// on the device may be incomplete, so clean() is called. Other exceptions leave the data valid.
template <typename Function, typename Cleaner>
auto CallGuarded(Function&& function, Cleaner&& clean, const char* advice = "")
{
  const FloatingPointTrapGuard guard;
  try
  {
    return function();
  }
  catch (const cl::Error& error)
  {
    clean();
    throw Error(GetMessage(error) + advice);
  }
  catch (const std::bad_alloc&)
  {
    clean();
    throw;
  }
}

/// The overload for functions that need no cleanup.
template <typename Function>
auto CallGuarded(Function&& function)
{
  return CallGuarded(function, [] {});
}

} // namespace deformvolume

#endif
