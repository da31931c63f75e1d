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

/// A change of the nodes of a tetrahedron.
struct TetrahedronChange
{
  /// The number of the tetrahedron.
  std::int32_t Number = 0;
  /// The previous nodes.
  Tetrahedron Before{};
  /// The new nodes.
  Tetrahedron After{};
};

} // namespace deformvolume

#endif
