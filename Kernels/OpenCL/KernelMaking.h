// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeKernelMaking_h
#define DeformVolumeKernelMaking_h

#include "OpenCLContext.h"

namespace deformvolume
{

/// Makes a kernel of a program and sets all of its arguments.
template <typename... Arguments>
cl::Kernel MakeKernel(const cl::Program& program, const char* name, const Arguments&... arguments)
{
  cl::Kernel kernel(program, name);
  cl_uint i = 0;
  (kernel.setArg(i++, arguments), ...);
  return kernel;
}

} // namespace deformvolume

#endif
