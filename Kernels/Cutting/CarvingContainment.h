// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCarvingContainment_h
#define DeformVolumeCarvingContainment_h

#include "SnappedPoint.h"

namespace deformvolume
{

struct CarvingTool;

/// How much of a box a tool may hold.
enum class CarvingContainment
{
  Nothing,
  Some,
  All // only told of linear tools
};

CarvingContainment FindContainment(const SnappedBox& box, const CarvingTool& tool);

} // namespace deformvolume

#endif
