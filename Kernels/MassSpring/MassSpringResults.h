// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMassSpringResults_h
#define DeformVolumeMassSpringResults_h

#include "ElasticBody.h"
#include "ElementResults.h"

#include <vector>

namespace deformvolume
{

/// Computes the stress and deformation of the tetrahedra of a mass-spring body. displacements:
/// three floats per node, in m. cubeEdge: see FindCubeEdge.
std::vector<ElementResults> ComputeMassSpringResults(
  const ElasticBody& body, const std::vector<float>& displacements, double cubeEdge);

} // namespace deformvolume

#endif
