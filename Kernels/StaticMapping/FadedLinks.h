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

/// How voxels outside a deformation mesh are kept where they are (OutsideVoxels::Modes::Keep): a
/// voxel at the distance d from the mesh takes w(d / FadeDistance) times the displacement of the
/// closest point of the mesh's boundary, with w(s) = 1 - 3 s^2 + 2 s^3 before 1 and 0 from there
/// on. That is a link, since the point lies on a face. There are records, behind the tetrahedra of
/// the mesh, that links name by their numbers as if they were tetrahedra: the first one is of
/// voxels that do not move, and has four times the node that never moves; the others have the nodes
/// of a face of the boundary, and that node, which takes what the weights miss to 1.
class DEFORMVOLUME_EXPORT FadedLinks
{
public:
  /// Links the voxels that have no tetrahedron. spacing: the world distance of neighbours. Where
  /// several faces are equally close, one is taken that depends on neither threads nor runs.
  /// progress gets the fraction done and may throw.
  void Link(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    double fadeDistance, std::vector<VertexLink>& links,
    const std::function<void(double)>& progress);

  /// Whether there is a record at all.
  bool AreThere() const { return this->FadeDistance >= 0.0; }
  /// In ascending order of tetrahedra.
  const std::vector<TetrahedronFace>& GetFaces() const { return this->Faces; }
  /// How many records there are behind the tetrahedra of the mesh.
  std::size_t GetNumberOfRecords() const { return this->AreThere() ? 1 + this->Faces.size() : 0; }
  /// The nodes of a record. still: the node that never moves. tetrahedra: of the mesh, as they are
  /// now.
  Tetrahedron GetRecord(
    std::size_t record, const std::vector<Tetrahedron>& tetrahedra, std::int32_t still) const;

  /// The displacement of a voxel with a link, by the tetrahedra as they are now. displacements: of
  /// the nodes, three floats each.
  glm::dvec3 Displace(const VertexLink& link, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements) const;

  /// Bounds of the voxels outside after the deformation, not smaller than the truth.
  /// displacements: of the nodes, three floats each, in output voxels.
  IndexBounds ComputeBounds(const VoxelGrid& voxelGrid, const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements) const;

  /// Tetrahedra of the sampling mesh, active or not, that are stretched over more than 2 output
  /// voxels on an axis because they reach from voxels to others that follow a distant part of the
  /// boundary. Where many are in question, the number is an estimate from some of them.
  std::int64_t CountStretched(
    const std::vector<Tetrahedron>& tetrahedra, const float* displacements) const;
  /// Whether the number of the last CountStretched() is an estimate.
  bool IsCountEstimated() const { return this->Stretched.IsCountEstimated(); }

  /// The longest displacement of the nodes of faces. spacing: of the output.
  double GetLongestDisplacement(const std::vector<Tetrahedron>& tetrahedra,
    const float* displacements, const glm::dvec3& spacing) const;

private:
  /// Some of the voxels that fade, close to each other.
  struct Block
  {
    Extent Voxels;
    double GreatestWeight;
    std::size_t FacesEnd; // of its faces in FacesOfBlocks; they begin where those of the last end
  };

  void LinkRows(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    std::vector<VertexLink>& links, const std::function<void(double)>& progress);
  /// Leaves out the faces that no link names.
  void DropUnused(std::size_t numberOfTetrahedra, std::vector<VertexLink>& links);
  void FindBlocks(
    const Extent& voxels, std::size_t numberOfTetrahedra, const std::vector<VertexLink>& links);

  double FadeDistance = -1.0; // none: there are no records
  std::vector<TetrahedronFace> Faces;
  std::vector<Block> Blocks;
  std::vector<std::int32_t> FacesOfBlocks;
  Extent StillVoxels{ { 0, -1, 0, -1, 0, -1 } }; // a box of them
  StretchedTetrahedra Stretched;
};

} // namespace deformvolume

#endif
