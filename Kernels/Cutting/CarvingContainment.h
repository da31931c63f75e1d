// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCarvingContainment_h
#define DeformVolumeCarvingContainment_h

#include "SnappedPoint.h"

namespace deformvolume
{

struct CarvingTool;

/// How much of a box a tool may contain.
enum class CarvingContainment
{
  Nothing,
  Some,
  All // only found for linear tools
};

/// Finds how much of a box a tool contains. May return Some where Nothing or All is right.
CarvingContainment FindContainment(const SnappedBox& box, const CarvingTool& tool);

} // namespace deformvolume

#endif
