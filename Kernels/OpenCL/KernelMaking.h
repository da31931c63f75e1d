// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelMaking_h
#define DeformVolumeKernelMaking_h

#include "OpenCLContext.h"

namespace deformvolume
{

/// Sets consecutive arguments of a kernel. first: index of the first of them. Returns the index of
/// the next argument.
template <typename... Arguments>
cl_uint SetArguments(cl::Kernel& kernel, cl_uint first, const Arguments&... arguments)
{
  (kernel.setArg(first++, arguments), ...);
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
