// SPDX-License-Identifier: BSD-3-Clause
#include "ResamplingProgram.h"

#include "ArrayText.h"
#include "Error.h"
#include "KernelParameters.h"
#include "KernelSources.h"
#include "KernelText.h"
#include "SamplingMeshText.h"

#include <algorithm>
#include <limits>
#include <string>

namespace deformvolume
{

namespace
{

/// Bytes that a work-item of the kernel ResampleBricks wants for so many arrays.
std::size_t GetBrickMemory(const OpenCLContext& context, std::size_t slots)
{
  const std::size_t lanes = static_cast<std::size_t>(GetLanes(context));
  const std::size_t halfRow = (DEFORMVOLUME_BRICK_X / 2 / lanes + 1) * lanes;
  const std::size_t row = 2 * (3 + slots) * halfRow;
  return (4 * halfRow + 3 * (DEFORMVOLUME_BRICK_X + 16) + 2 * (DEFORMVOLUME_BRICK_Y + 1) * row) *
    sizeof(cl_float);
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

} // namespace

bool HasLocalBricks(const OpenCLContext& context)
{
  return GetBrickMemory(context, 0) <=
    context.GetDevice().Device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
}

cl::Program GetOutputProgram(OpenCLContext& context)
{
  return context.GetProgram(
    GetSamplingMeshText() + CoverageCount_cl + OutputClearing_cl, KernelOptions);
}

cl::Program GetResamplingProgram(OpenCLContext& context, MappingForm mapping,
  const std::vector<VolumeArray>& arrays, bool wideKeys, ResamplingForm form, bool withCut)
{
  ProgramText key = "#define KEY uint\n#define ATOMIC_MIN atomic_min\n"
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
  ProgramText text = Resampling_cl;
  if (form == ResamplingForm::Lanes)
  {
    text += ProgramText(MakeLanePreamble(context, arrays)) + LaneVectors_cl + RowDisplacements_cl +
      BrickMapping_cl + GroupVertices_cl + GroupSamples_cl + GroupCoverage_cl + GroupCandidates_cl +
      GroupWeights_cl + GroupResampling_cl + BrickResampling_cl;
  }
  else if (form == ResamplingForm::LargeCells)
  {
    text += LargeCells_cl;
  }
  return context.GetProgram(GetSamplingMeshText(withCut) + MakeArrayText(context, arrays) + key +
      "#define HAS_MAPPING_KERNEL 0\n" + GetMappingText(mapping) + "#define HAS_CELL_KERNEL " +
      (form == ResamplingForm::Cells ? "1\n" : "0\n") + IntegerVectors_cl + CellVertices_cl +
      CutCells_cl + CellCoverage_cl + SampleStoring_cl + VoxelWinners_cl + text,
    KernelOptions);
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
    GetSamplingMeshText() + MakeArrayText(context, arrays) + PublishedResampling_cl, KernelOptions);
}

} // namespace deformvolume
