// SPDX-License-Identifier: BSD-3-Clause
// Surfaces around a body of voxels, one after the other until TetGen accepts one.
#ifndef DeformVolumeEnclosingSurfaces_h
#define DeformVolumeEnclosingSurfaces_h

#include "BodyVoxels.h"

#include "vtkSmartPointer.h"

#include <glm/vec3.hpp>

#include <functional>
#include <vector>

class vtkPolyData;

namespace deformvolume
{

struct SurfaceParameters
{
  double EdgeLength = 0.0; // world units
  double Margin = 0.0;     // world units
  int SmoothingIterations = 20;
  bool Decimation = true;
  bool Hull = false;
};

/// Decimation, smoothing and growth can make a surface intersect itself, an isosurface never does.
/// So the surfaces are ever closer to an isosurface; those without decimation start from a coarser
/// grid instead. All are closed manifolds that enclose the body, but for 5 voxels of a million; the
/// last ones do so by construction.
class EnclosingSurfaces
{
public:
  /// spacing: of the voxels, positive. `check` is called between the steps and throws to give up.
  EnclosingSurfaces(const BodyVoxels& body, const glm::dvec3& spacing,
    const SurfaceParameters& parameters, std::function<void()> check);

  /// The next surface, in offsets from the first voxel along the axes of the volume, in world
  /// units; null if there are no more.
  vtkSmartPointer<vtkPolyData> Next();

  /// Whether there is none after the one that Next() gave.
  bool IsLast() const { return this->NextAttempt == this->Attempts.size(); }

private:
  struct Attempt
  {
    double Resolution;
    int SmoothingIterations;
    bool Decimation;
    bool WholeCells;
  };

  vtkSmartPointer<vtkPolyData> Try(const Attempt& attempt);
  double FineResolution() const;

  const BodyVoxels& Body;
  BodyVoxels Target;
  vtkIdType Allowed = 0;
  glm::dvec3 Spacing;
  SurfaceParameters Parameters;
  std::function<void()> Check;
  std::vector<Attempt> Attempts;
  std::size_t NextAttempt = 0;
};

} // namespace deformvolume

#endif
