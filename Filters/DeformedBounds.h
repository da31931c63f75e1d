// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformedBounds_h
#define DeformVolumeDeformedBounds_h

#include "VolumeDeformer.h" // for Extent, Lattice, Tetrahedron, DisplacementField, VertexLink

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// A box in continuous output indices.
struct IndexBounds
{
  glm::dvec3 Min{ 1.0 };
  glm::dvec3 Max{ -1.0 };
  bool IsEmpty() const { return this->Min.x > this->Max.x; }
  void Add(const glm::dvec3& point);
  void Add(const IndexBounds& other);
};

/// Bounds of the part of the volume that lies inside the deformation mesh, after the deformation.
/// Tight: tetrahedra that the surface of the volume cuts are clipped to it, since a tetrahedron's
/// map is affine.
///
/// lattice: the volume's voxels and their output indices at rest. restPoints: the nodes at rest in
/// continuous indices of the volume. displacements: of the nodes, three floats each, in output
/// voxels.
IndexBounds ComputeDeformedBounds(const Lattice& lattice, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements);

/// What the bounds of a deformed mesh depend on, found once for a mesh at rest. Of a tetrahedron
/// inside the volume the nodes tell the bounds; only the others have to be clipped.
struct MeshBoundsPlan
{
  std::vector<std::int32_t> Nodes;
  std::vector<std::int32_t> ClippedTetrahedra;
};
MeshBoundsPlan MakeMeshBoundsPlan(const Lattice& lattice, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra);

/// The same as the function above, with its plan.
IndexBounds ComputeDeformedBounds(const Lattice& lattice, const std::vector<glm::dvec3>& restPoints,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements,
  const MeshBoundsPlan& plan);

/// Bounds of all linked voxels after the deformation: for links that extrapolate.
IndexBounds ComputeDeformedBounds(const Lattice& lattice, const std::vector<VertexLink>& links,
  const std::vector<Tetrahedron>& tetrahedra, const float* displacements);

/// Bounds of the part of the volume that a displacement field covers (all of it where the field
/// extrapolates), after the deformation. Exact where the field's points are the voxels, otherwise
/// no smaller than the truth, and exact for a constant field.
IndexBounds ComputeDeformedBounds(const Lattice& lattice, const DisplacementField& field);

} // namespace deformvolume

#endif
