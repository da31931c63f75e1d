// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSplitNodes_h
#define DeformVolumeSplitNodes_h

#include "DeformVolumeExport.h"
#include "Extent.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace deformvolume
{

struct MeshAtRest;
struct StaticMapping;

/// The nodes of a mesh that share their position at rest with other nodes.
class DEFORMVOLUME_EXPORT SplitNodes
{
public:
  /// Finds the nodes, unless this is the mesh of the last call. onFaces: whether only nodes of
  /// faces count that coincide with another face. Without voxels outside the mesh, cells of the
  /// volume between two bodies are stretched only where faces of both coincide (MeshBoundary).
  void Update(const MeshAtRest& mesh, bool onFaces);
  /// Returns the beginning of a warning if such nodes move apart by more than an output voxel, so
  /// that the volume is stretched over a gap; otherwise "". displacements: three floats per node,
  /// in output voxels. voxels: those of the volume. Splits beside them do not count.
  std::string Describe(const float* displacements, const Extent& voxels) const;

private:
  /// Two nodes that tetrahedra use.
  struct Pair
  {
    std::int32_t First;
    std::int32_t Second;
    glm::dvec3 Position; // of both
  };
  std::vector<Pair> Pairs;
  const void* Owner = nullptr;
  std::uint64_t Connectivity = 0;
  bool OnFaces = false;
};

/// Returns a warning if bodies of the mesh overlap at rest; otherwise "".
DEFORMVOLUME_EXPORT std::string DescribeOverlap(const StaticMapping& mapping);

} // namespace deformvolume

#endif
