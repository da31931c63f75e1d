// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFadedMesh_h
#define DeformVolumeFadedMesh_h

#include "DeformVolumeExport.h"
#include "FadedLinks.h"
#include "PointRanges.h"
#include "Tetrahedron.h"

#include <cstddef>
#include <vector>

namespace deformvolume
{

/// A deformation mesh with the faded tetrahedra of FadedLinks, for a VolumeDeformer. They follow
/// the tetrahedra of the mesh. The last node never moves.
class DEFORMVOLUME_EXPORT FadedMesh
{
public:
  /// Set the mesh. All displacements are zero until Move() is called.
  void Set(
    const FadedLinks& links, const std::vector<Tetrahedron>& tetrahedra, std::size_t numberOfNodes);
  /// Whether a mesh with this number of nodes fits without a new call of Set(). Set() reserves room
  /// for a quarter more nodes, so that the number of the node that never moves stays the same when
  /// a mesh is split.
  bool HasRoom(std::size_t numberOfNodes) const { return numberOfNodes < this->NumberOfNodes; }
  /// Applies changes of the nodes of tetrahedra. The positions at rest must not change. Returns the
  /// changes together with the resulting changes of faded tetrahedra.
  std::vector<TetrahedronChange> Change(
    const FadedLinks& links, const std::vector<TetrahedronChange>& changes);
  /// Set the displacements. changes: the nodes whose displacements have changed since the last
  /// call; null: any may have changed. Throws an Error if the mesh has no room for the nodes.
  void Move(const float* displacements, std::size_t numberOfNodes, const PointRanges* changes);

  /// The tetrahedra of the mesh, followed by the faded tetrahedra.
  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Tetrahedra; }
  /// Number of nodes, with those in reserve and the node that never moves, which is the last.
  std::size_t GetNumberOfNodes() const { return this->NumberOfNodes; }
  /// Displacements: three floats per node, in output voxels.
  const std::vector<float>& GetDisplacements() const { return this->Displacements; }

private:
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<float> Displacements;
  std::size_t NumberOfTetrahedra = 0; // of the mesh
  std::size_t NumberOfNodes = 0;
};

} // namespace deformvolume

#endif
