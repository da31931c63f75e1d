// SPDX-License-Identifier: BSD-3-Clause
#include "KernelText.h"

namespace deformvolume
{

// -w, since PoCL prints the number of warnings on the user's terminal. Without AVX-512, Clang warns
// that functions with 64-byte vectors are not compatible with code compiled for other processors.
// There is no such code.
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
