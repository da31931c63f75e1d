// SPDX-License-Identifier: BSD-3-Clause
#include "RasterizationProgram.h"

#include "ArrayText.h"
#include "BinningProgram.h"
#include "KernelSources.h"
#include "KernelText.h"

#include <limits>
#include <string>

namespace deformvolume
{

cl::Program GetRasterizationProgram(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
  const VoxelGrid& voxelGrid, Interpolation interpolation, bool field, bool masks)
{
  const bool processor = context.GetDevice().HasVectors;
  std::string stores;
  std::string laneArrays;
  std::string tapArrays;
  for (std::size_t i = 0; i < arrays.size(); ++i)
  {
    const std::string index = std::to_string(i);
    const std::string element = " DO(" + index + ", " + GetTypeName(arrays[i].Type) + ", ";
    if (interpolation == Interpolation::Linear && FitsFloat(arrays[i]))
    {
      laneArrays += element + std::to_string(8 * GetElementSize(arrays[i].Type)) + ")";
    }
    else
    {
      tapArrays += element + std::to_string(arrays[i].Components) + ")";
      stores += "#define STORE_ARRAY_" + index + " " + MakeStore(arrays[i], index) + "\n";
    }
  }
  const bool wide = GetNumberOfPoints(voxelGrid.VertexExtent) > std::numeric_limits<cl_int>::max();
  return context.GetProgram(ProgramText(FiveTetrahedra_h) + RasterParameters_h +
      MakeArrayText(context, arrays) + stores + "#define LANES " +
      std::to_string(processor ? GetLanes(context) : 1) + "\n#define CUBIC " +
      (interpolation == Interpolation::Cubic ? "1" : "0") + "\n#define STRETCH " +
      (processor ? "32" : "1") + "\n#define HAS_MASKS " + (masks ? "1" : "0") + "\n#define INDEX " +
      (wide ? "long" : "int") + (laneArrays.empty() ? "" : "\n#define HAS_LANE_ARRAYS") +
      (tapArrays.empty() ? "" : "\n#define HAS_TAP_ARRAYS") + "\n#define LANE_ARRAYS(DO)" +
      laneArrays + "\n#define TAP_ARRAYS(DO)" + tapArrays + "\n" + MultiplyAdd_cl +
      GetTileText(!processor) + PointInTetrahedron_cl + LaneVectors_cl + LaneSampling_cl +
      VoxelTaps_cl + RestSampling_cl +
      (field ? ProgramText(FieldFading_cl) + FieldLookup_cl
             : ProgramText(RestCoordinates_cl) + MeshRasterization_cl),
    KernelOptions);
}

} // namespace deformvolume
