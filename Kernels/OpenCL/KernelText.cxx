// SPDX-License-Identifier: BSD-3-Clause
#include "KernelText.h"

namespace deformvolume
{

// Without warnings: PoCL counts them on the user's terminal. On processors without AVX-512, clang
// warns that functions with vectors of 64 bytes would not fit those compiled for others, of which
// there are none.
const char* const KernelOptions = "-cl-std=CL1.2 -w";

bool HasDouble(const OpenCLContext& context)
{
  return context.HasExtension("cl_khr_fp64");
}

int GetLanes(const OpenCLContext& context)
{
  const cl_uint width = context.GetDevice().Device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>();
  return width >= 16 ? 16 : width >= 8 ? 8 : 4;
}

std::string GetReal(const OpenCLContext& context)
{
  return HasDouble(context)
    ? "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
      "#define REAL double\n#define REAL_IS_DOUBLE 1\n#define EXACT double\n"
    : "#define REAL float\n#define REAL_IS_DOUBLE 0\n#define EXACT long\n";
}

} // namespace deformvolume
