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

/// Runs a function, with floating-point traps off and OpenCL's errors put into words: an Error with
/// their meaning and the advice. clean: called before that, and where memory of the host is short,
/// as what is on the device may be half done. Other errors leave what is there usable.
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

/// The same where nothing is to be cleaned up.
template <typename Function>
auto CallGuarded(Function&& function)
{
  return CallGuarded(function, [] {});
}

} // namespace deformvolume

#endif
