// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePointDifferences_h
#define DeformVolumePointDifferences_h

#include "DeformationMesh.h"
#include "NodeFaults.h"
#include "VectorArray.h"

#include <vector>

namespace deformvolume
{

/// What is to be added to the points of one mesh to have those of another, part by part. Points of
/// the second that are not finite are marked in faults. memories: of the last reading, from the
/// same points.
void ReadPointDifferences(const MeshParts& shape, const MeshParts& rest, const VectorTaker& take,
  std::vector<VectorMemory>& memories, NodeFaults& faults);

} // namespace deformvolume

#endif
