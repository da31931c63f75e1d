// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshPointMap_h
#define DeformVolumeMeshPointMap_h

#include "OutsideVoxels.h"
#include "PointMap.h"
#include "Tetrahedron.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The map of a deformation mesh: a point follows the first tetrahedron that holds it. What it is
/// made of must outlive it.
class DEFORMVOLUME_EXPORT MeshPointMap : public PointMap
{
public:
  /// points: at rest. Tetrahedra without volume hold no point.
  MeshPointMap(const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra);
  ~MeshPointMap() override;

  /// What the map is from then on. isInverse: whether Invert is to be called, and not Map.
  void Set(std::vector<glm::dvec3> displacements, const OutsideVoxels& outside, bool isInverse);

  /// Outside the mesh as OutsideVoxels says; Extrapolate: by the affine map of the tetrahedron with
  /// the closest face of the boundary.
  bool Map(const glm::dvec3& point, Image& image) const override;

private:
  bool InvertInside(const glm::dvec3& point, Image& image) const override;

  class Internals;
  std::unique_ptr<Internals> Inside;
};

} // namespace deformvolume

#endif
