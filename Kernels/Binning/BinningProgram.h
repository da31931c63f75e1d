// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBinningProgram_h
#define DeformVolumeBinningProgram_h

#include "KernelText.h"
#include "OpenCLContext.h"

namespace deformvolume
{

/// Programs that make the lists of tetrahedra for each tile of an output.
cl::Program GetRangeListsProgram(OpenCLContext& context);
cl::Program GetEntryListsProgram(OpenCLContext& context);

/// Returns the text for tetrahedra in a tile (TileTetrahedra.cl), with the texts that it needs.
/// isShared: whether the work-items of a work-group set up tetrahedra for each other.
ProgramText GetTileText(bool isShared);

} // namespace deformvolume

#endif
