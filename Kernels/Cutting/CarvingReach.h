// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCarvingReach_h
#define DeformVolumeCarvingReach_h

#include "SnappedPoint.h"

namespace deformvolume
{

struct CarvingTool;

/// How much of a box a tool may hold.
enum class CarvingReach
{
  Nothing,
  Some,
  All // only told of linear tools
};

CarvingReach FindReach(const SnappedBox& box, const CarvingTool& tool);

} // namespace deformvolume

#endif
