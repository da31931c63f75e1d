// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStaticMapping_h
#define DeformVolumeStaticMapping_h

#include "DeformVolumeExport.h"
#include "Extent.h"
#include "FadedLinks.h"
#include "MeshBoundary.h"
#include "OutsideVoxels.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace deformvolume
{

class VoxelLinker;

/// The form of a static mapping: a link for each voxel, or runs of voxels.
enum class StaticMappingForm
{
  /// Runs if voxels outside the mesh are discarded, and if runs are long enough
  /// (LeastMeanRunLength) and need less memory than links. Otherwise links. The lengths are
  /// estimated from a deterministic sample of the volume.
  Automatic,
  /// A link for each voxel.
  Links,
  /// Runs. Only possible if voxels outside the mesh are discarded.
  Runs
};

/// Least mean length of runs, in voxels, for which StaticMappingForm::Automatic chooses runs. With
/// shorter runs, the search for the run of a voxel takes the time that is saved by less memory
/// access.
constexpr double LeastMeanRunLength = 3.0;

/// The static part of the deformation mapping: the tetrahedron of the deformation mesh at rest that
/// contains each voxel. It has one of two forms: links or runs.
struct StaticMapping
{
  /// One link per voxel, with x varying fastest. Empty if the mapping has runs.
  std::vector<VertexLink> Links;
  /// Runs of voxels. Empty if the mapping has links.
  VertexRuns Runs;
  /// The boundary of the mesh within the volume. Empty unless voxels outside the mesh are
  /// discarded.
  MeshBoundary Boundary;
  /// The links of voxels outside the mesh, if these voxels are kept (FadedMesh).
  FadedLinks Faded;
  /// Number of voxels inside the mesh. Extrapolated and kept voxels do not count.
  std::int64_t NumberOfInnerVoxels = 0;
  /// Number of tetrahedra without volume, which are skipped.
  std::int64_t NumberOfFlatTetrahedra = 0;
  /// A voxel that lies in two bodies of the mesh that overlap at rest. Empty if none was found.
  std::optional<glm::i64vec3> SharedVoxel;
};

/// Finds the tetrahedron of each voxel. The tetrahedra are rasterized into the voxel grid, in
/// parallel over tiles of voxels, with exact integer arithmetic on positions rounded to 1/256
/// voxel. So every voxel inside the mesh or on its surface is found, and the result does not depend
/// on the number of threads.
///
/// A voxel in several tetrahedra, such as a voxel on a face, is linked to the tetrahedron whose
/// nodes come first in lexicographic order: the positions of the first nodes are compared by x,
/// then y, then z, then those of the second nodes, and so on. If the tetrahedra belong to different
/// bodies, parts of the mesh that share no position of a node, a voxel in both follows the body
/// with less volume. So the mapping does not depend on the numbers of nodes and tetrahedra. Only if
/// tetrahedra have equal positions, the tetrahedron with the lowest number is used. Links and runs
/// select the same tetrahedra.
///
/// voxels: extent of the volume. restPoints: the nodes at rest, in continuous indices of the
/// volume. outside: voxels outside the mesh have no link (Discard), are linked to the tetrahedron
/// of the nearest voxel inside, in world distance, with weights outside 0 to 1 (Extrapolate), or
/// are kept (Keep, see FadedLinks).
class DEFORMVOLUME_EXPORT StaticMappingBuilder
{
public:
  /// Chooses the form. restPoints and tetrahedra must not change or be deleted before the last
  /// Build() returns. Throws Error if a node is more than 2^31 voxels away from index 0, and if
  /// runs are requested but voxels outside the mesh are not discarded.
  StaticMappingBuilder(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    const OutsideVoxels& outside, StaticMappingForm form = StaticMappingForm::Automatic);
  ~StaticMappingBuilder();
  StaticMappingBuilder(const StaticMappingBuilder&) = delete;
  StaticMappingBuilder& operator=(const StaticMappingBuilder&) = delete;

  /// Estimated bytes of the runs. 0 if the form is links.
  std::uint64_t GetRunBytes() const { return this->RunBytes; }

  /// Whether any tetrahedron contains a voxel of the volume. Fast if one of the first tetrahedra
  /// contains a voxel.
  bool HoldsVoxels() const;

  /// Builds the mapping of the whole volume. progress: as in DeformRequest. Throws Aborted if it
  /// returns false.
  StaticMapping Build(const std::function<bool(double)>& progress = {}) const
  {
    return this->Build(this->Voxels, progress);
  }
  /// Builds the mapping of a part of the volume, which must have complete rows. Voxels outside the
  /// mesh must be discarded. The displacements are bitwise equal to those of the whole volume.
  StaticMapping Build(const Extent& part, const std::function<bool(double)>& progress = {}) const;

private:
  /// Estimates the bytes of the runs. 0 if links are chosen.
  std::uint64_t EstimateRunBytes(StaticMappingForm form) const;
  void BuildLinks(
    const Extent& part, const std::function<void(double)>& report, StaticMapping& mapping) const;

  const Extent Voxels;
  const glm::dvec3 Spacing;
  const OutsideVoxels Outside;
  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
  std::uint64_t RunBytes = 0;
  std::unique_ptr<VoxelLinker> Linker; // null for a volume without voxels
};

/// Builds the static mapping of a whole volume with a StaticMappingBuilder.
DEFORMVOLUME_EXPORT StaticMapping BuildStaticMapping(const Extent& voxels,
  const glm::dvec3& spacing, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const OutsideVoxels& outside, StaticMappingForm form,
  const std::function<bool(double)>& progress = {});

} // namespace deformvolume

#endif
