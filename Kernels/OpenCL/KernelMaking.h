// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelMaking_h
#define DeformVolumeKernelMaking_h

#include "OpenCLContext.h"

#include <type_traits>

namespace deformvolume
{

/// Sets consecutive arguments of a kernel. first: index of the first of them. Returns the index of
/// the next argument. A null buffer, which the kernel does not use, is replaced by another buffer
/// among the arguments: not all drivers accept a null pointer.
template <typename... Arguments>
cl_uint SetArguments(cl::Kernel& kernel, cl_uint first, const Arguments&... arguments)
{
  const cl::Buffer* other = nullptr;
  const auto find = [&](const auto& argument)
  {
    if constexpr (std::is_same_v<std::decay_t<decltype(argument)>, cl::Buffer>)
    {
      other = argument() ? &argument : other;
    }
  };
  const auto set = [&](const auto& argument)
  {
    if constexpr (std::is_same_v<std::decay_t<decltype(argument)>, cl::Buffer>)
    {
      kernel.setArg(first++, argument() || !other ? argument : *other);
    }
    else
    {
      kernel.setArg(first++, argument);
    }
  };
  (find(arguments), ...);
  (set(arguments), ...);
  return first;
}

/// Makes a kernel of a program and sets all of its arguments.
template <typename... Arguments>
cl::Kernel MakeKernel(const cl::Program& program, const char* name, const Arguments&... arguments)
{
  cl::Kernel kernel(program, name);
  SetArguments(kernel, 0, arguments...);
  return kernel;
}

} // namespace deformvolume

#endif
