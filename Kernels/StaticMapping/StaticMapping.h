// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStaticMapping_h
#define DeformVolumeStaticMapping_h

#include "DeformVolumeExport.h"
#include "Extent.h"
#include "FadedLinks.h"
#include "MappingSurvey.h"
#include "MeshBoundary.h"
#include "OutsideVoxels.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace deformvolume
{

class VoxelLinker;

/// The static part of the deformation mapping: where each voxel of the volume lies in the
/// tetrahedra of the deformation mesh at rest. In one of two forms.
struct StaticMapping
{
  /// One link a voxel, x varying fastest; or none.
  std::vector<VertexLink> Links;
  /// Runs of voxels; or none.
  VertexRuns Runs;
  /// Where the boundary of the mesh passes through the volume; empty unless voxels outside the mesh
  /// are discarded.
  MeshBoundary Boundary;
  /// What links name besides the tetrahedra, where voxels outside the mesh are kept (FadedMesh).
  FadedLinks Faded;
  /// Voxels inside the mesh (those that are extrapolated or kept do not count).
  std::int64_t NumberOfInnerVoxels = 0;
  /// Tetrahedra without volume; they are skipped.
  std::int64_t NumberOfFlatTetrahedra = 0;
};

/// Finds the tetrahedron of each voxel by rasterising the tetrahedra into the voxel grid, in
/// parallel over slabs of voxels, with exact integer arithmetic on positions rounded to 1/256
/// voxel: no voxel inside the mesh is missed, those on its surface included, and the result does
/// not depend on the number of threads. A voxel that several tetrahedra hold, such as one on a
/// face, goes to the tetrahedron whose nodes come first by their positions: those of the first
/// nodes are compared by x, then y, then z, then those of the second nodes, and so on. So the
/// mapping does not depend on how nodes and tetrahedra are numbered; only of tetrahedra in one
/// place the lowest index gets the voxel. Both forms give a voxel to the same tetrahedron.
///
/// voxels: structured indices of the volume. restPoints: the nodes at rest in continuous indices
/// of the volume. outside: voxels outside the mesh have no link; or are linked to the tetrahedron
/// of the nearest voxel (in continuous indices times spacing, hence world distance) inside it, with
/// weights outside 0 to 1; or are kept (FadedLinks).
class DEFORMVOLUME_EXPORT StaticMappingBuilder
{
public:
  /// Decides on the form. restPoints and tetrahedra must live and stay the same until Build
  /// returns. Throws Error where a tetrahedron has a node more than 2^31 voxels away from index 0,
  /// and where runs are demanded of voxels outside the mesh that are not discarded.
  StaticMappingBuilder(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    const OutsideVoxels& outside, StaticMappingForm form = StaticMappingForm::Automatic);
  ~StaticMappingBuilder();
  StaticMappingBuilder(const StaticMappingBuilder&) = delete;
  StaticMappingBuilder& operator=(const StaticMappingBuilder&) = delete;

  /// Bytes of the runs, about; 0 for links.
  std::uint64_t GetRunBytes() const { return this->RunBytes; }

  /// Whether any tetrahedron holds a voxel of the volume: at once where one of the first does.
  bool HoldsVoxels() const;

  /// progress: as in DeformRequest; throws Aborted where it returns false.
  StaticMapping Build(const std::function<bool(double)>& progress = {}) const
  {
    return this->Build(this->Voxels, progress);
  }
  /// The mapping of a part of the volume alone, whole rows of voxels, where voxels outside the mesh
  /// are discarded. Voxels are displaced as by the mapping of the whole, to the last bit.
  StaticMapping Build(const Extent& part, const std::function<bool(double)>& progress = {}) const;

private:
  void BuildLinks(
    const Extent& part, const std::function<void(double)>& report, StaticMapping& mapping) const;

  const Extent Voxels;
  const glm::dvec3 Spacing;
  const OutsideVoxels Outside;
  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
  MappingSurvey Survey;
  std::uint64_t RunBytes = 0;
  std::unique_ptr<VoxelLinker> Linker; // null for a volume without voxels
};

/// Build by a StaticMappingBuilder.
DEFORMVOLUME_EXPORT StaticMapping BuildStaticMapping(const Extent& voxels,
  const glm::dvec3& spacing, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const OutsideVoxels& outside, StaticMappingForm form,
  const std::function<bool(double)>& progress = {});

} // namespace deformvolume

#endif
