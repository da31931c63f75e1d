// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeFrame_h
#define DeformVolumeVolumeFrame_h

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

class vtkImageData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// The coordinates in which bodies are meshed: offsets from the first voxel of the extent, along
/// the axes of the volume, in world units. There, faces that the volume's border cuts are exactly
/// plane.
class VolumeFrame
{
public:
  explicit VolumeFrame(vtkImageData* volume);

  glm::dvec3 GetSpacing() const { return this->Spacing; }
  glm::dvec3 ToWorld(const glm::dvec3& offset) const;
  glm::dvec3 ToOffset(const glm::dvec3& world) const;

  /// Moves the points of a mesh of tetrahedra to the world; volumes stay positive.
  void MoveToWorld(vtkUnstructuredGrid* mesh) const;

private:
  glm::dvec3 Spacing; // positive
  glm::dvec3 First;   // of the extent, as an offset
  glm::dvec3 Origin;
  glm::dmat3 Axes;
};

} // namespace deformvolume

#endif
