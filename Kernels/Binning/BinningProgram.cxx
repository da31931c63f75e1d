// SPDX-License-Identifier: BSD-3-Clause
#include "BinningProgram.h"

#include "KernelSources.h"

namespace deformvolume
{

cl::Program GetRangeListsProgram(OpenCLContext& context)
{
  return context.GetProgram(
    ProgramText(RasterParameters_h) + IntegerVectors_cl + TetrahedronBinning_cl + RangeLists_cl,
    KernelOptions);
}

cl::Program GetEntryListsProgram(OpenCLContext& context)
{
  return context.GetProgram(
    ProgramText(RasterParameters_h) + IntegerVectors_cl + TetrahedronBinning_cl + EntryLists_cl,
    KernelOptions);
}

ProgramText GetTileText(bool isShared)
{
  return ProgramText(isShared ? "#define SETUP_IS_SHARED 1\n" : "#define SETUP_IS_SHARED 0\n") +
    IntegerVectors_cl + TetrahedronBinning_cl + TileTetrahedra_cl;
}

} // namespace deformvolume
