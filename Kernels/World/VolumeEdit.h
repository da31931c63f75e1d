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

/// What one edit does to a volume; see MaskEditor.
struct VolumeEdit
{
  /// The tetrahedra that it switches off.
  TetrahedronSet Tetrahedra;
  /// The distances of vertices to a smooth boundary.
  DistanceSet Distances;
  /// Where a sheet divides tetrahedra.
  CrossingSet Crossings;
};

/// The boundary distance that counts as far from any boundary: the diagonal of a volume, in world
/// units.
DEFORMVOLUME_EXPORT float GetFarDistance(const Extent& volume, const glm::dvec3& spacing);

/// The labels of some voxels that follow each other, x varying fastest, as doubles. The first voxel
/// of the volume has the number 0. Called by many threads.
using LabelReader = std::function<void(std::int64_t voxel, std::int64_t count, double* labels)>;

/// Whether a voxel of the volume has the label.
DEFORMVOLUME_EXPORT bool HasLabel(const Extent& volume, const LabelReader& labels, double label);

/// Finds what an edit that is given in world coordinates does to a volume. Functions throw Error as
/// those of Cutting/ do that they call, and Aborted.
class DEFORMVOLUME_EXPORT EditFinder
{
public:
  /// The volume.
  ImageGeometry Volume;
  /// Where the vertices are. It is called where it matters only, after what can be checked before.
  std::function<const VertexPositions&()> GetVertices;
  /// See GetFarDistance().
  float FarDistance = 0.0F;
  /// A sheet divides tetrahedra, and what is carved out has a boundary between the voxels.
  bool IsSmooth = false;
  /// Which tetrahedra are carved out, where the boundary is not smooth.
  CarvingRule Rule = CarvingRule::Centroid;
  /// Called with the fraction that is done.
  EditProgress Progress;

  /// What a sheet cuts.
  VolumeEdit Cut(const WorldSheet& sheet) const;
  /// What a tool in world coordinates carves out.
  VolumeEdit Carve(const CarvingTool& tool) const;
  /// What a closed surface encloses.
  VolumeEdit CarveSurface(const WorldSheet& surface) const;
  /// What a sphere sweeps from center to center, in world coordinates.
  VolumeEdit CarveSweptSphere(const std::vector<glm::dvec3>& centers, double radius) const;
  /// Where voxels have a label. The smooth surface lies halfway between voxels.
  VolumeEdit CarveLabel(const LabelReader& labels, double label) const;

private:
  /// With a tool in indices of the volume.
  VolumeEdit CarveInIndices(const CarvingTool& tool) const;
};

} // namespace deformvolume

#endif
