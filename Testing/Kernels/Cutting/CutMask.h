// SPDX-License-Identifier: BSD-3-Clause
#ifndef CutMask_h
#define CutMask_h

#include "CuttingReference.h"
#include "SheetCut.h"

/// The tetrahedra that the engine switches off for a sheet.
inline reference::Mask Cut(
  const deformvolume::VertexPositions& positions, const deformvolume::Sheet& sheet)
{
  return reference::GetMask(
    positions.GetBricks(), deformvolume::FindCrossedTetrahedra(positions, sheet));
}

#endif
