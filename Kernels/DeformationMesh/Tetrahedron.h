// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedron_h
#define DeformVolumeTetrahedron_h

#include "PointRanges.h"

#include <array>
#include <cstdint>

namespace deformvolume
{

/// The nodes of a tetrahedron of the deformation mesh.
using Tetrahedron = std::array<std::int32_t, 4>;

/// A tetrahedron that has got other nodes.
struct TetrahedronChange
{
  std::int32_t Number = 0;
  Tetrahedron Before{};
  Tetrahedron After{};
};

} // namespace deformvolume

#endif
