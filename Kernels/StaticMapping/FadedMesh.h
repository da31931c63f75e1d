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

/// A deformation mesh as faded links name it, and as a VolumeDeformer is to be given it: its
/// tetrahedra and then the records of the links, its nodes and then one that never moves.
class DEFORMVOLUME_EXPORT FadedMesh
{
public:
  /// Displacements are those of Move from then on; before they are zero.
  void Set(
    const FadedLinks& links, const std::vector<Tetrahedron>& tetrahedra, std::size_t numberOfNodes);
  /// Whether there is room for so many nodes, else Set has to be called again: the node that never
  /// moves has the same number as long as a mesh that is split does not grow by a quarter.
  bool HasRoom(std::size_t numberOfNodes) const { return numberOfNodes < this->NumberOfNodes; }
  /// Some tetrahedra have got other nodes in the same places; returns the changes with those of
  /// records.
  std::vector<TetrahedronChange> Change(
    const FadedLinks& links, const std::vector<TetrahedronChange>& changes);
  /// changes: all others are those of the last call; null: any may have changed.
  void Move(const float* displacements, std::size_t numberOfNodes, const PointRanges* changes);

  /// The tetrahedra of the mesh, and then the records.
  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Tetrahedra; }
  /// The one that never moves is the last.
  std::size_t GetNumberOfNodes() const { return this->NumberOfNodes; }
  /// Three floats a node, in output voxels.
  const std::vector<float>& GetDisplacements() const { return this->Displacements; }

private:
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<float> Displacements;
  std::size_t NumberOfTetrahedra = 0; // without records
  std::size_t NumberOfNodes = 0;
};

} // namespace deformvolume

#endif
