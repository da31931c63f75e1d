// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeEdit_h
#define DeformVolumeVolumeEdit_h

#include "Carving.h"
#include "CrossingSet.h"
#include "DeformVolumeExport.h"
#include "DistanceSet.h"
#include "EditProgress.h"
#include "ImageGeometry.h"
#include "TetrahedronSet.h"
#include "VertexPositions.h"
#include "WorldSheet.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// The effect of one edit on a volume; see MaskEditor.
struct VolumeEdit
{
  /// The tetrahedra that the edit switches off.
  TetrahedronSet Tetrahedra;
  /// The distances of vertices to a smooth boundary.
  DistanceSet Distances;
  /// Where a sheet divides tetrahedra.
  CrossingSet Crossings;
};

/// The boundary distance that counts as far from any boundary: the diagonal of a volume, in world
/// units.
DEFORMVOLUME_EXPORT float GetFarDistance(const Extent& volume, const glm::dvec3& spacing);

/// Reads the labels of `count` consecutive voxels as doubles, x varying fastest. voxel: index of
/// the first of these; the first voxel of the volume has index 0. Called by several threads.
using LabelReader = std::function<void(std::int64_t voxel, std::int64_t count, double* labels)>;

/// Whether a voxel of the volume has the label.
DEFORMVOLUME_EXPORT bool HasLabel(const Extent& volume, const LabelReader& labels, double label);

/// Finds the effect of edits, given in world coordinates, on a volume. All functions throw an Error
/// if the functions of Cutting/ do, and Aborted if Progress returns false.
class DEFORMVOLUME_EXPORT EditFinder
{
public:
  /// The volume.
  ImageGeometry Volume;
  /// Returns the positions of the vertices. Called only when they are needed, after all other input
  /// was checked.
  std::function<const VertexPositions&()> GetVertices;
  /// See GetFarDistance().
  float FarDistance = 0.0F;
  /// Whether cuts divide tetrahedra, and carved regions have a boundary between voxels.
  bool IsSmooth = false;
  /// Which tetrahedra are carved out, if IsSmooth is false.
  CarvingRule Rule = CarvingRule::Centroid;
  /// Called with the completed fraction.
  EditProgress Progress;

  /// Cuts with a sheet.
  VolumeEdit Cut(const WorldSheet& sheet) const;
  /// Carves with a tool in world coordinates.
  VolumeEdit Carve(const CarvingTool& tool) const;
  /// Carves the interior of a closed surface.
  VolumeEdit CarveSurface(const WorldSheet& surface) const;
  /// Carves the path of a sphere from center to center, in world coordinates.
  VolumeEdit CarveSweptSphere(const std::vector<glm::dvec3>& centers, double radius) const;
  /// Carves the voxels with a label. A smooth boundary lies halfway between voxels.
  VolumeEdit CarveLabel(const LabelReader& labels, double label) const;

private:
  /// Carves with a tool in indices of the volume.
  VolumeEdit CarveInIndices(const CarvingTool& tool, const VertexPositions& vertices) const;
};

} // namespace deformvolume

#endif
