// SPDX-License-Identifier: BSD-3-Clause
#include "ArrayText.h"

#include "Error.h"
#include "KernelText.h"

#include <cstddef>

namespace deformvolume
{

namespace
{

// Oclgrind does not support restrict in inlined functions.
const char* const Restrict =
  "#ifdef __x86_64__\n#define RESTRICT restrict\n#else\n#define RESTRICT\n"
  "#endif\n";

bool IsReal(ElementType type)
{
  return type == ElementType::Float32 || type == ElementType::Float64;
}

} // namespace

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

bool FitsFloat(const VolumeArray& array)
{
  return !array.Categorical && array.Components == 1 &&
    (array.Type == ElementType::Float32 || GetElementSize(array.Type) <= 2);
}

std::string MakeStore(const VolumeArray& array, const std::string& index)
{
  const std::string type = GetTypeName(array.Type);
  const std::string names = "source" + index + ", target" + index + ", ";
  const std::string components = std::to_string(array.Components);
  if (array.Categorical)
  {
    return "STORE_NEAREST(" + names + components + ") ";
  }
  const std::string convert = "convert_" + type + (IsReal(array.Type) ? "" : "_sat_rte");
  if (GetElementSize(array.Type) == 8 && !IsReal(array.Type))
  {
    return "STORE_LINEAR_64(" + names + components + ", " + type + ", " + convert + ") ";
  }
  return "STORE_LINEAR(" + names + components + ", " + convert + ") ";
}

std::string MakeArrayText(const OpenCLContext& context, const std::vector<VolumeArray>& arrays)
{
  std::string parameters;
  std::string arguments;
  std::string stores;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    if (arrays[i].Type == ElementType::Float64 && !HasDouble(context))
    {
      throw Error("The device \"" + context.GetDevice().Name +
        "\" has no double precision, but array " + std::to_string(i) +
        " of the volume has elements of type double. Convert the array to float, or use another "
        "device.");
    }
    if (!HasDouble(context) && !arrays[i].Categorical && !IsReal(arrays[i].Type) &&
      GetElementSize(arrays[i].Type) >= 4)
    {
      throw Error("The device \"" + context.GetDevice().Name +
        "\" has no double precision, which is needed to interpolate array " + std::to_string(i) +
        " of the volume, of 32-bit or 64-bit integers. Convert the array to 16 bits or to float, "
        "make it categorical, or use another device.");
    }
    const std::string index = std::to_string(i);
    const std::string type = GetTypeName(arrays[i].Type);
    parameters += ", __global const " + type + "* RESTRICT source" + index + ", __global " + type +
      "* RESTRICT target" + index;
    arguments += ", source" + index + ", target" + index;
    stores += MakeStore(arrays[i], index);
  }
  return GetReal(context) + Restrict + "#define ARRAY_PARAMETERS " + parameters +
    "\n#define ARRAY_ARGUMENTS " + arguments + "\n#define STORE_ARRAYS " + stores + "\n";
}

} // namespace deformvolume
