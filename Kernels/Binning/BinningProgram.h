// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBinningProgram_h
#define DeformVolumeBinningProgram_h

#include "KernelText.h"
#include "OpenCLContext.h"

namespace deformvolume
{

/// Programs that list the tetrahedra in each tile of an output.
cl::Program GetRangeListsProgram(OpenCLContext& context);
cl::Program GetEntryListsProgram(OpenCLContext& context);

/// Tetrahedra in a tile (TileTetrahedra.cl) and what that needs. isShared: whether the items of a
/// work-group set tetrahedra up for each other.
ProgramText GetTileText(bool isShared);

} // namespace deformvolume

#endif
