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

/// Returns the memory of a work-item of the kernel ResampleBricks for `slots` arrays, in bytes.
std::size_t GetBrickMemory(const OpenCLContext& context, bool hasTurnedAxes, std::size_t slots)
{
  const std::size_t lanes = static_cast<std::size_t>(GetLanes(context));
  const std::size_t halfRow = (DEFORMVOLUME_BRICK_X / 2 / lanes + 1) * lanes;
  const std::size_t row = 2 * (3 + slots) * halfRow;
  // The sum BRICK_FLOATS of BrickResampling.cl; change both.
  return ((hasTurnedAxes ? 12 : 4) * halfRow + 3 * (DEFORMVOLUME_BRICK_X + 16) +
           2 * (DEFORMVOLUME_BRICK_Y + 1) * row) *
    sizeof(cl_float);
}

/// Returns the memory of a work-group of the kernel ResampleColumns, or of the kernels for deferred
/// cells, for `slots` arrays, in bytes. planes: number of planes of vertices.
std::size_t GetColumnMemory(std::size_t slots, std::size_t planes = 3)
{
  const std::size_t row = 2 * (3 + slots) * (DEFORMVOLUME_SPAN / 2 + 1);
  return planes * (DEFORMVOLUME_BRICK_Y / 2 + 1) * row * sizeof(cl_float);
}

/// Additional local memory of these kernels: flags of the vertices, and counts.
constexpr std::size_t OtherColumnMemory = 1024;

std::size_t GetLocalMemory(const OpenCLContext& context)
{
  return context.GetDevice().Device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
}

/// Returns for each array whether the kernel interpolates it in single precision. If the kernel
/// uses local memory, it does so for the first arrays that fit into local memory.
std::vector<bool> FindLaneArrays(const OpenCLContext& context,
  const std::vector<VolumeArray>& arrays, ResamplingKernel form, bool hasTurnedAxes)
{
  const bool lanes = form == ResamplingKernel::Lanes;
  const std::size_t memory = !lanes || HasLocalBricks(context, hasTurnedAxes)
    ? GetLocalMemory(context)
    : std::numeric_limits<std::size_t>::max();
  std::vector<bool> found;
  std::size_t slots = 0;
  for (const VolumeArray& array : arrays)
  {
    const std::size_t needed = lanes ? GetBrickMemory(context, hasTurnedAxes, slots + 1)
                                     : GetColumnMemory(slots + 1) + OtherColumnMemory;
    const bool fits = FitsFloat(array) && needed <= memory;
    found.push_back(fits);
    slots += fits;
  }
  return found;
}

std::size_t CountSlots(const OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  ResamplingKernel form, bool hasTurnedAxes)
{
  const std::vector<bool> found = FindLaneArrays(context, arrays, form, hasTurnedAxes);
  return static_cast<std::size_t>(std::count(found.begin(), found.end(), true));
}

/// Defines the macros of the texts from LaneVectors.cl to BrickResampling.cl or ColumnCells.cl.
std::string MakeLanePreamble(const OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  const ResamplingOptions& variant)
{
  const ResamplingKernel form = variant.Form;
  const bool hasTurnedAxes = variant.HasTurnedAxes;
  const std::vector<bool> inLanes = FindLaneArrays(context, arrays, form, hasTurnedAxes);
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
  const bool lanes = form == ResamplingKernel::Lanes;
  const bool local = !lanes || HasLocalBricks(context, hasTurnedAxes);
  const std::string shape = lanes
    ? "#define ROW_CELLS DEFORMVOLUME_BRICK_X\n#define CELL_ROWS DEFORMVOLUME_BRICK_Y\n"
    : "#define ROW_CELLS DEFORMVOLUME_SPAN\n#define CELL_ROWS (DEFORMVOLUME_BRICK_Y / 2)\n"
      "#define CELL_LAYERS (DEFORMVOLUME_BRICK_Z / 2)\n";
  return "#define LANES " + std::to_string(lanes ? GetLanes(context) : 1) +
    "\n#define ROW_MEMORY " + (local ? "__local" : "__global") + "\n#define ROWS_ARE_GLOBAL " +
    (local ? "0\n" : "1\n") + shape + "#define HAS_COLUMN_KERNEL " +
    (form == ResamplingKernel::DeferredInt64 ? "0" : "1") + "\n#define PASS_IS_DIRECT " +
    (variant.IsDirect ? "1" : "0") + "\n#define LANE_SLOTS " + std::to_string(slots) +
    "\n#define LANE_ARRAYS(DO)" + list + "\n#define HAS_OTHER_ARRAYS " +
    (others.empty() ? "0" : "1") + "\n#define STORE_OTHER_ARRAYS " + others + "\n";
}

/// Returns the texts of a form, without those that all forms have.
ProgramText GetFormText(const OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  const ResamplingOptions& variant)
{
  switch (variant.Form)
  {
    case ResamplingKernel::Lanes:
      return ProgramText(MakeLanePreamble(context, arrays, variant)) + LaneVectors_cl +
        PacketVertices_cl + RowDisplacements_cl + BrickMapping_cl + PacketValues_cl +
        PacketSamples_cl + PacketCoverage_cl + PacketCandidates_cl + PacketWeights_cl +
        PacketWalk_cl + PacketResampling_cl + BrickResampling_cl;
    case ResamplingKernel::Columns:
    case ResamplingKernel::DeferredInt32:
    case ResamplingKernel::DeferredInt64:
      return ProgramText(MakeLanePreamble(context, arrays, variant)) + LaneVectors_cl +
        PacketVertices_cl + PacketValues_cl + PacketCoverage_cl + PacketCandidates_cl +
        PacketWeights_cl + PacketWalk_cl + ColumnCells_cl +
        (variant.Form == ResamplingKernel::DeferredInt64 ? DeferredResampling_cl
                                                         : ColumnResampling_cl);
    case ResamplingKernel::LargeCells:
      return LargeCells_cl;
    case ResamplingKernel::Cells:
      break;
  }
  return {};
}

/// Additional compiler options of a form. The kernels for columns wait for memory more than they
/// compute. Four work-groups on a multiprocessor are faster than two, although some values then do
/// not fit into registers (Documents/resampling.md, GPUs).
std::string GetFormOptions(const OpenCLContext& context, ResamplingKernel form)
{
  const bool isColumns =
    form == ResamplingKernel::Columns || form == ResamplingKernel::DeferredInt32;
  return isColumns && context.HasExtension("cl_nv_compiler_options") ? " -cl-nv-maxrregcount=64"
                                                                     : "";
}

} // namespace

bool HasLocalBricks(const OpenCLContext& context, bool hasTurnedAxes)
{
  return GetBrickMemory(context, hasTurnedAxes, 0) <= GetLocalMemory(context);
}

bool HasLocalColumns(const OpenCLContext& context)
{
  return GetColumnMemory(0) + OtherColumnMemory <= GetLocalMemory(context);
}

cl::Program GetOutputProgram(OpenCLContext& context)
{
  return context.GetProgram(
    GetSamplingMeshText() + GroupReduction_cl + CoverageCount_cl + OutputClearing_cl,
    KernelOptions);
}

cl::Program GetResamplingProgram(OpenCLContext& context, MappingKind mapping,
  const std::vector<VolumeArray>& arrays, const ResamplingOptions& variant)
{
  const ResamplingKernel form = variant.Form;
  ProgramText key = "#define KEY uint\n#define ATOMIC_MIN atomic_min\n"
                    "#define ATOMIC_CMPXCHG atomic_cmpxchg\n";
  if (variant.WideKeys)
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
  key += variant.IsCubic ? "#define CUBIC 1\n" : "#define CUBIC 0\n";
  key += variant.CoverageBits ? "#define COVERAGE_IS_BITS 1\n" : "#define COVERAGE_IS_BITS 0\n";
  return context.GetProgram(GetSamplingMeshText(variant.WithCut) + MakeArrayText(context, arrays) +
      key + GetMappingText(mapping, variant.HasTurnedAxes) + "#define HAS_CELL_KERNEL " +
      (form == ResamplingKernel::Cells ? "1\n" : "0\n") + "#define OUTLINED" +
      (form == ResamplingKernel::DeferredInt64 ? " __attribute__((noinline))\n" : "\n") +
      IntegerVectors_cl + CellVertices_cl + CutCells_cl + CellCoverage_cl +
      (variant.IsCubic ? ProgramText(VoxelTaps_cl) : ProgramText()) + SampleStoring_cl +
      VoxelWinners_cl + Resampling_cl + GetFormText(context, arrays, variant),
    std::string(KernelOptions) + GetFormOptions(context, form));
}

std::size_t GetBrickMemory(
  const OpenCLContext& context, bool hasTurnedAxes, const std::vector<VolumeArray>& arrays)
{
  return GetBrickMemory(
    context, hasTurnedAxes, CountSlots(context, arrays, ResamplingKernel::Lanes, hasTurnedAxes));
}

std::size_t GetColumnMemory(
  const OpenCLContext& context, const std::vector<VolumeArray>& arrays, ResamplingKernel form)
{
  return GetColumnMemory(
    CountSlots(context, arrays, form, false), form == ResamplingKernel::Columns ? 3 : 2);
}

} // namespace deformvolume
