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

/// The deformation of points by a mesh. A point follows the tetrahedron that contains it; of
/// several, the first one in the TetrahedronOrder. The arguments of the constructor must outlive
/// the object.
class DEFORMVOLUME_EXPORT MeshPointMap : public PointMap
{
public:
  /// points: the nodes at rest. Tetrahedra without volume contain no point.
  MeshPointMap(const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra);
  ~MeshPointMap() override;

  /// Set the displacements of the nodes. isInverse: whether to prepare for Invert(). Without it,
  /// call only Map().
  void Set(std::vector<glm::dvec3> displacements, const OutsideVoxels& outside, bool isInverse);

  /// Set whether the points to map were rounded to single precision. Points outside the mesh by no
  /// more than this rounding then count as inside. Default: false.
  void SetPointsAreFloats(bool areFloats);

  /// Maps a point. Outside the mesh, OutsideVoxels applies. With Extrapolate, the point follows the
  /// affine map of the tetrahedron with the closest boundary face.
  bool Map(const glm::dvec3& point, Image& image) const override;

private:
  bool InvertInside(const glm::dvec3& point, Image& image) const override;

  class Internals;
  std::unique_ptr<Internals> Inside;
};

} // namespace deformvolume

#endif
