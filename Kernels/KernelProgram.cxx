// SPDX-License-Identifier: BSD-3-Clause
#include "KernelProgram.h"

#include "KernelParameters.h"
#include "KernelSources.h"

#include <algorithm>
#include <limits>

namespace deformvolume
{

bool HasDouble(const OpenCLContext& context)
{
  return context.HasExtension("cl_khr_fp64");
}

namespace
{

// Oclgrind knows no restrict in functions that are inlined.
const char* const Restrict =
  "#ifdef __x86_64__\n#define RESTRICT restrict\n#else\n#define RESTRICT\n"
  "#endif\n";

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
  return HasDouble(context)
    ? "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
      "#define REAL double\n#define REAL_IS_DOUBLE 1\n#define EXACT double\n"
    : "#define REAL float\n#define REAL_IS_DOUBLE 0\n#define EXACT long\n";
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
    if (!HasDouble(context) && !arrays[i].Categorical && !IsReal(arrays[i].Type) &&
      GetElementSize(arrays[i].Type) >= 4)
    {
      throw Error("The device \"" + context.GetDevice().Name +
        "\" has no double precision, which integers of 32 or 64 bits need to be interpolated. "
        "Convert the array to 16 bits or to float, make it categorical, or use another device.");
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

/// Floats in a vector of the device that the kernels for processors use.
int GetLanes(const OpenCLContext& context)
{
  const cl_uint width = context.GetDevice().Device.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>();
  return width >= 16 ? 16 : width >= 8 ? 8 : 4;
}

/// Bytes that a work-item of the kernel ResampleBricks wants for so many arrays.
std::size_t GetBrickMemory(const OpenCLContext& context, std::size_t slots)
{
  const std::size_t lanes = static_cast<std::size_t>(GetLanes(context));
  const std::size_t halfRow = (DEFORMVOLUME_BRICK_X / 2 / lanes + 1) * lanes;
  const std::size_t row = 2 * (3 + slots) * halfRow;
  return (4 * halfRow + 3 * (DEFORMVOLUME_BRICK_X + 16) + 2 * (DEFORMVOLUME_BRICK_Y + 1) * row) *
    sizeof(cl_float);
}

/// Whether single precision is enough to interpolate an array, and vectors of it are worthwhile.
bool FitsFloat(const VolumeArray& array)
{
  return !array.Categorical && array.Components == 1 &&
    (array.Type == ElementType::Float32 || GetElementSize(array.Type) <= 2);
}

/// For each array whether the kernel ResampleBricks interpolates it in single precision: as many as
/// the local memory holds, if it is used.
std::vector<bool> FindLaneArrays(
  const OpenCLContext& context, const std::vector<VolumeArray>& arrays)
{
  const std::size_t memory = HasLocalBricks(context)
    ? context.GetDevice().Device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>()
    : std::numeric_limits<std::size_t>::max();
  std::vector<bool> found;
  std::size_t slots = 0;
  for (const VolumeArray& array : arrays)
  {
    const bool fits = FitsFloat(array) && GetBrickMemory(context, slots + 1) <= memory;
    found.push_back(fits);
    slots += fits;
  }
  return found;
}

/// What the texts from LaneVectors.cl to BrickResampling.cl expect in front of them.
std::string MakeLanePreamble(const OpenCLContext& context, const std::vector<VolumeArray>& arrays)
{
  const std::vector<bool> inLanes = FindLaneArrays(context, arrays);
  std::string list;
  std::string others;
  int slots = 0;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    const std::string index = std::to_string(i);
    if (!inLanes[i])
    {
      others += MakeStore(arrays[i], index);
      continue;
    }
    list += " DO(" + index + ", " + GetTypeName(arrays[i].Type) + ", " +
      std::to_string(8 * GetElementSize(arrays[i].Type)) + ", " + std::to_string(slots++) + ")";
  }
  const bool local = HasLocalBricks(context);
  return "#define LANES " + std::to_string(GetLanes(context)) + "\n#define ROW_MEMORY " +
    (local ? "__local" : "__global") + "\n#define ROWS_ARE_GLOBAL " + (local ? "0" : "1") +
    "\n#define LANE_SLOTS " + std::to_string(slots) + "\n#define LANE_ARRAYS(DO)" + list +
    "\n#define HAS_OTHER_ARRAYS " + (others.empty() ? "0" : "1") + "\n#define STORE_OTHER_ARRAYS " +
    others + "\n";
}

std::string GetSharedText()
{
  return std::string(FiveTetrahedra_h) + KernelParameters_h;
}

std::string GetMappingText(MappingForm mapping)
{
  switch (mapping)
  {
    case MappingForm::Links:
      return std::string("#define MAPPING 0\n") + MultiplyAdd_cl + DeformationMapping_cl;
    case MappingForm::Runs:
      return std::string("#define MAPPING 1\n") + MultiplyAdd_cl + RunMapping_cl +
        DeformationMapping_cl;
    case MappingForm::FieldInPlace:
      return std::string("#define MAPPING 3\n") + MultiplyAdd_cl + DeformationMapping_cl;
    default:
      return std::string("#define MAPPING 2\n") + MultiplyAdd_cl + DeformationMapping_cl;
  }
}

} // namespace

bool HasLocalBricks(const OpenCLContext& context)
{
  return GetBrickMemory(context, 0) <=
    context.GetDevice().Device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
}

cl::Program GetMappingProgram(OpenCLContext& context, MappingForm mapping)
{
  const std::string evaluation = mapping == MappingForm::Runs ? RunEvaluation_cl : "";
  return context.GetProgram(GetReal(context) + GetSharedText() + "#define HAS_MAPPING_KERNEL 1\n" +
      GetMappingText(mapping) + VertexState_cl + evaluation,
    Options);
}

cl::Program GetOutputProgram(OpenCLContext& context)
{
  return context.GetProgram(GetSharedText() + CoverageCount_cl + OutputClearing_cl, Options);
}

cl::Program GetResamplingProgram(OpenCLContext& context, MappingForm mapping,
  const std::vector<VolumeArray>& arrays, bool wideKeys, ResamplingForm form)
{
  std::string key = "#define KEY uint\n#define ATOMIC_MIN atomic_min\n"
                    "#define ATOMIC_CMPXCHG atomic_cmpxchg\n";
  if (wideKeys)
  {
    key = "#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable\n"
          "#pragma OPENCL EXTENSION cl_khr_int64_extended_atomics : enable\n"
          "#define KEY ulong\n#define ATOMIC_MIN atom_min\n#define ATOMIC_CMPXCHG atom_cmpxchg\n";
    if (!context.HasExtension("cl_khr_int64_base_atomics") ||
      !context.HasExtension("cl_khr_int64_extended_atomics"))
    {
      throw Error("The device \"" + context.GetDevice().Name +
        "\" lacks atomic operations of 64 bits, which a volume of more than 2^30 cells needs. Use "
        "a smaller volume or another device.");
    }
  }
  std::string text = Resampling_cl;
  if (form == ResamplingForm::Lanes)
  {
    text += MakeLanePreamble(context, arrays) + LaneVectors_cl + BrickMapping_cl + GroupSamples_cl +
      GroupCoverage_cl + GroupCandidates_cl + GroupResampling_cl + BrickResampling_cl;
  }
  else if (form == ResamplingForm::LargeCells)
  {
    text += LargeCells_cl;
  }
  return context.GetProgram(GetSharedText() + MakePreamble(context, arrays) + key +
      "#define HAS_MAPPING_KERNEL 0\n" + GetMappingText(mapping) + "#define HAS_CELL_KERNEL " +
      (form == ResamplingForm::Cells ? "1\n" : "0\n") + IntegerVectors_cl + CellCoverage_cl +
      SampleStoring_cl + VoxelWinners_cl + text,
    Options);
}

std::size_t GetBrickMemory(const OpenCLContext& context, const std::vector<VolumeArray>& arrays)
{
  const std::vector<bool> inLanes = FindLaneArrays(context, arrays);
  return GetBrickMemory(
    context, static_cast<std::size_t>(std::count(inLanes.begin(), inLanes.end(), true)));
}

cl::Program GetPublishedProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays)
{
  return context.GetProgram(
    GetSharedText() + MakePreamble(context, arrays) + PublishedResampling_cl, Options);
}

cl::Program GetBinningProgram(OpenCLContext& context)
{
  return context.GetProgram(
    std::string(RasterParameters_h) + IntegerVectors_cl + TetrahedronBinning_cl, Options);
}

cl::Program GetRasterizationProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  const Lattice& lattice, Interpolation interpolation, bool field)
{
  const bool processor = context.GetDevice().HasVectors;
  std::string stores;
  std::string laneArrays;
  std::string tapArrays;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    const std::string index = std::to_string(i);
    const std::string element = " DO(" + index + ", " + GetTypeName(arrays[i].Type) + ", ";
    if (processor && interpolation == Interpolation::Linear && FitsFloat(arrays[i]))
    {
      laneArrays += element + std::to_string(8 * GetElementSize(arrays[i].Type)) + ")";
    }
    else
    {
      tapArrays += element + std::to_string(arrays[i].Components) + ")";
      stores += "#define STORE_ARRAY_" + index + " " + MakeStore(arrays[i], index) + "\n";
    }
  }
  const bool wide = GetNumberOfPoints(lattice.VertexExtent) > std::numeric_limits<cl_int>::max();
  return context.GetProgram(std::string(FiveTetrahedra_h) + RasterParameters_h +
      MakePreamble(context, arrays) + stores + "#define LANES " +
      std::to_string(processor ? GetLanes(context) : 4) + "\n#define CUBIC " +
      (interpolation == Interpolation::Cubic ? "1" : "0") + "\n#define CHUNK " +
      (processor ? "32" : "1") + "\n#define INDEX " + (wide ? "long" : "int") +
      (laneArrays.empty() ? "" : "\n#define HAS_LANE_ARRAYS") +
      (tapArrays.empty() ? "" : "\n#define HAS_TAP_ARRAYS") + "\n#define LANE_ARRAYS(DO)" +
      laneArrays + "\n#define TAP_ARRAYS(DO)" + tapArrays + "\n" + MultiplyAdd_cl +
      IntegerVectors_cl + TetrahedronBinning_cl + LaneVectors_cl + LaneSampling_cl +
      RestSampling_cl +
      (field ? std::string(FieldLookup_cl)
             : std::string(RestCoordinates_cl) + MeshRasterization_cl),
    Options);
}

} // namespace deformvolume
