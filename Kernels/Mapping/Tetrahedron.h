// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeTetrahedron_h
#define DeformVolumeTetrahedron_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// The nodes of a tetrahedron of the deformation mesh.
using Tetrahedron = std::array<std::int32_t, 4>;

/// Points of a deformation: of each range the first one, and one past the last. In ascending order.
using PointRanges = std::vector<std::array<std::size_t, 2>>;

} // namespace deformvolume

#endif
