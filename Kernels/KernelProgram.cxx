// SPDX-License-Identifier: BSD-3-Clause
#include "KernelProgram.h"

#include "KernelSources.h"

#include <algorithm>

namespace deformvolume
{

bool HasDouble(const OpenCLContext& context)
{
  return context.HasExtension("cl_khr_fp64");
}

namespace
{

const char* const Options = "-cl-std=CL1.2";

std::string GetTypeName(ElementType type)
{
  switch (type)
  {
#define DEFORMVOLUME_CASE(name, ctype, cl)                                                         \
  case ElementType::name:                                                                          \
    return cl;
    DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_CASE)
#undef DEFORMVOLUME_CASE
  }
  return "";
}

bool IsReal(ElementType type)
{
  return type == ElementType::Float32 || type == ElementType::Float64;
}

/// The statement that stores one array at a sample.
std::string MakeStore(const VolumeArray& array, const std::string& index)
{
  const std::string type = GetTypeName(array.Type);
  const std::string places = "source" + index + ", target" + index + ", ";
  const std::string components = std::to_string(array.Components);
  if (array.Categorical)
  {
    return "STORE_NEAREST(" + places + components + ") ";
  }
  const std::string convert = "convert_" + type + (IsReal(array.Type) ? "" : "_sat_rte");
  if (GetElementSize(array.Type) == 8 && !IsReal(array.Type))
  {
    return "STORE_LINEAR_64(" + places + components + ", " + type + ", " + convert + ") ";
  }
  return "STORE_LINEAR(" + places + components + ", " + convert + ") ";
}

/// The type of arithmetic that is as precise as the device has it.
std::string GetReal(const OpenCLContext& context)
{
  return HasDouble(context) ? "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
                              "#define REAL double\n"
                            : "#define REAL float\n";
}

/// What the resampling kernels expect in front of them.
std::string MakePreamble(const OpenCLContext& context, const std::vector<VolumeArray>& arrays)
{
  std::string parameters;
  std::string arguments;
  std::string stores;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    if (arrays[i].Type == ElementType::Float64 && !HasDouble(context))
    {
      throw Error("The device \"" + context.GetDevice().Name +
        "\" has no double precision, which an array of the volume needs. Convert the array to "
        "float, or use another device.");
    }
    const std::string index = std::to_string(i);
    const std::string type = GetTypeName(arrays[i].Type);
    parameters += ", __global const " + type + "* restrict source" + index + ", __global " + type +
      "* restrict target" + index;
    arguments += ", source" + index + ", target" + index;
    stores += MakeStore(arrays[i], index);
  }
  return GetReal(context) + "#define ARRAY_PARAMETERS " + parameters +
    "\n#define ARRAY_ARGUMENTS " + arguments + "\n#define STORE_ARRAYS " + stores + "\n";
}

/// What LaneResampling.cl expects in front of it.
std::string MakeLanePreamble(const OpenCLContext& context, const std::vector<VolumeArray>& arrays)
{
  const cl_uint width = context.GetDevice().Device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>();
  std::string list;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    list += " DO(" + std::to_string(i) + ", " + GetTypeName(arrays[i].Type) + ", " +
      std::to_string(8 * GetElementSize(arrays[i].Type)) + ")";
  }
  return "#define LANES " +
    std::string(width >= 16 ? "16"
        : width >= 8        ? "8"
                            : "4") +
    "\n#define LANE_ARRAYS(DO)" + list + "\n";
}

std::string GetSharedText()
{
  return std::string(FiveTetrahedra_h) + KernelParameters_h;
}

} // namespace

cl::Program GetMappingProgram(OpenCLContext& context)
{
  return context.GetProgram(
    GetReal(context) + GetSharedText() + DeformationMapping_cl + RunMapping_cl, Options);
}

cl::Program GetResamplingProgram(
  OpenCLContext& context, const std::vector<VolumeArray>& arrays, bool wideKeys)
{
  std::string key = "#define KEY uint\n#define ATOMIC_MIN atomic_min\n";
  if (wideKeys)
  {
    key = "#pragma OPENCL EXTENSION cl_khr_int64_extended_atomics : enable\n"
          "#define KEY ulong\n#define ATOMIC_MIN atom_min\n";
    if (!context.HasExtension("cl_khr_int64_extended_atomics"))
    {
      throw Error("The device \"" + context.GetDevice().Name +
        "\" lacks atomic operations of 64 bits, which a volume of more than 2^31 cells needs. Use "
        "a smaller volume or another device.");
    }
  }
  const std::string lanes =
    FitsLanes(arrays) ? MakeLanePreamble(context, arrays) + LaneResampling_cl : "";
  return context.GetProgram(
    GetSharedText() + MakePreamble(context, arrays) + key + CellCoverage_cl + Resampling_cl + lanes,
    Options);
}

bool FitsLanes(const std::vector<VolumeArray>& arrays)
{
  return std::all_of(arrays.begin(), arrays.end(),
    [](const VolumeArray& array)
    {
      return !array.Categorical && array.Components == 1 &&
        (array.Type == ElementType::Float32 || GetElementSize(array.Type) <= 2);
    });
}

cl::Program GetPublishedProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays)
{
  return context.GetProgram(
    GetSharedText() + MakePreamble(context, arrays) + PublishedResampling_cl, Options);
}

} // namespace deformvolume
