// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointDifferences_h
#define DeformVolumePointDifferences_h

#include "DeformationMesh.h"
#include "NodeFaults.h"
#include "VectorArray.h"

#include <vector>

namespace deformvolume
{

/// Reads the differences between the points of `shape` and those of `rest`, part by part. Points of
/// `shape` that are not finite are marked in faults. memories: the last reading of each part, with
/// the same points of `rest`.
void ReadPointDifferences(const MeshParts& shape, const MeshParts& rest, const VectorTaker& take,
  std::vector<VectorMemory>& memories, NodeFaults& faults);

} // namespace deformvolume

#endif
