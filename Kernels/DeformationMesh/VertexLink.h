// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVertexLink_h
#define DeformVolumeVertexLink_h

#include <cstdint>

namespace deformvolume
{

/// The static link of a voxel to the deformation mesh; 16 bytes.
struct VertexLink
{
  /// Number of the tetrahedron, or -1 for a voxel outside the mesh.
  std::int32_t Tetrahedron = -1;
  /// Barycentric weights of the first three nodes. All four weights add up to 1.
  float Weights[3] = { 0.0F, 0.0F, 0.0F };
};

} // namespace deformvolume

#endif
