// SPDX-License-Identifier: BSD-3-Clause
#ifndef CaughtError_h
#define CaughtError_h

#include "Error.h"

#include <string>

/// Returns the message of the error that a call throws; empty if it throws none.
template <typename Call>
std::string GetError(Call&& call)
{
  try
  {
    call();
  }
  catch (const deformvolume::Error& error)
  {
    return error.what();
  }
  return "";
}

#endif
