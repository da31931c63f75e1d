// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFadedLinks_h
#define DeformVolumeFadedLinks_h

#include "BoundaryFaces.h"
#include "DeformVolumeExport.h"
#include "Extent.h"
#include "IndexBounds.h"
#include "StretchedTetrahedra.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VoxelGrid.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// Links of the voxels outside a deformation mesh for OutsideVoxels::Modes::Keep. A voxel at the
/// distance d from the mesh is displaced by w(d / FadeDistance) times the displacement of the
/// closest point on the boundary, where w(s) = 1 - 3 s^2 + 2 s^3 for s < 1 and 0 otherwise.
///
/// The closest point lies on a face, so its weights make a link. Links refer to faded tetrahedra:
/// additional tetrahedra whose numbers follow those of the mesh. All of them contain a node that
/// never moves. It has the remaining weight, so that the weights add up to 1. The first faded
/// tetrahedron is for voxels that do not move, and consists of this node only. Each further one has
/// the nodes of one boundary face and this node.
class DEFORMVOLUME_EXPORT FadedLinks
{
public:
  /// Links the voxels that have no tetrahedron. spacing: of the volume, in world units. If several
  /// faces are equally close, the choice is deterministic. progress: called with the fraction done;
  /// it may throw.
  void Link(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    double fadeDistance, std::vector<VertexLink>& links,
    const std::function<void(double)>& progress);

  /// Whether there are no faded tetrahedra: voxels outside the mesh are not kept.
  bool IsEmpty() const { return this->FadeDistance < 0.0; }
  /// The faces of the faded tetrahedra after the first, in ascending order of tetrahedra.
  const std::vector<TetrahedronFace>& GetFaces() const { return this->Faces; }
  /// Number of faded tetrahedra.
  std::size_t GetNumberOfFadedTetrahedra() const
  {
    return this->IsEmpty() ? 0 : 1 + this->Faces.size();
  }
  /// Returns the nodes of a faded tetrahedron. still: the node that never moves. tetrahedra: the
  /// current tetrahedra of the mesh.
  Tetrahedron GetFadedTetrahedron(
    std::size_t index, const std::vector<Tetrahedron>& tetrahedra, std::int32_t still) const;

  /// Returns the displacement of a linked voxel. tetrahedra: the current tetrahedra of the mesh.
  /// displacements: three floats per node.
  glm::dvec3 Displace(const VertexLink& link, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements) const;

  /// Computes bounds of the deformed positions of the voxels outside. The bounds may be too large,
  /// but never too small. displacements: three floats per node, in output voxels.
  IndexBounds ComputeBounds(const VoxelGrid& voxelGrid, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements) const;

  /// Counts the tetrahedra of the sampling mesh that are stretched over more than 2 output voxels
  /// on an axis because their vertices follow distant parts of the boundary. isWhole: as in
  /// StretchedTetrahedra. If there are many candidates, the number is an estimate from a sample of
  /// them.
  std::int64_t CountStretched(const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements,
    const std::function<bool(const StretchedTetrahedra::Candidate&)>& isWhole = {}) const;
  /// Whether the number of the last CountStretched() is an estimate.
  bool IsCountEstimated() const { return this->Stretched.IsCountEstimated(); }

  /// Returns the longest displacement of the nodes of the faces, in world units. displacements: in
  /// output voxels. spacing: of the output.
  double GetLongestDisplacement(const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements, const glm::dvec3& spacing) const;

private:
  /// A block of voxels that are linked to boundary faces.
  struct Block
  {
    Extent Voxels;
    double GreatestWeight;
    std::size_t FacesEnd; // end of its faces in FacesOfBlocks; they begin at the previous FacesEnd
  };

  void LinkRows(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    std::vector<VertexLink>& links, const std::function<void(double)>& progress);
  /// Removes the faces to which no voxel is linked.
  void DropUnused(std::size_t numberOfTetrahedra, std::vector<VertexLink>& links);
  void FindBlocks(
    const Extent& voxels, std::size_t numberOfTetrahedra, const std::vector<VertexLink>& links);

  double FadeDistance = -1.0; // negative: there are no faded tetrahedra
  std::vector<TetrahedronFace> Faces;
  std::vector<Block> Blocks;
  std::vector<std::int32_t> FacesOfBlocks;
  Extent StillVoxels = EmptyExtent; // bounding box of the voxels that do not move
  StretchedTetrahedra Stretched;
};

} // namespace deformvolume

#endif
