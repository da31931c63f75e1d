// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVertexLink_h
#define DeformVolumeVertexLink_h

#include <cstdint>

namespace deformvolume
{

/// The static link of one voxel into the deformation mesh; 16 bytes.
struct VertexLink
{
  /// Index of the tetrahedron of the deformation mesh, or -1 for a voxel outside it.
  std::int32_t Tetrahedron = -1;
  /// Barycentric weights of the first three nodes; that of the fourth is what misses to 1.
  float Weights[3] = { 0.0F, 0.0F, 0.0F };
};

} // namespace deformvolume

#endif
