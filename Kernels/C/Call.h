// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCall_h
#define DeformVolumeCall_h

#include "Error.h"
#include "deformvolume.h"

#include <cstdint>
#include <exception>
#include <string>

namespace deformvolume
{

/// Keeps the text that dv_last_error() returns in this thread. Never throws.
void SetLastError(const char* message) noexcept;

/// Calls a function of the library, and returns the status for C. No exception leaves it.
template <class Function>
std::int32_t Call(Function&& function) noexcept
{
  try
  {
    function();
    return DV_OK;
  }
  catch (const Aborted&)
  {
    return DV_ABORTED;
  }
  catch (const std::bad_alloc&)
  {
    SetLastError("There is not enough memory on the host.");
  }
  catch (const std::exception& error)
  {
    SetLastError(error.what());
  }
  catch (...)
  {
    SetLastError("An unknown exception was thrown.");
  }
  return DV_ERROR;
}

} // namespace deformvolume

#endif
