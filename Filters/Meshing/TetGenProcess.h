// SPDX-License-Identifier: BSD-3-Clause
// Makes tetrahedra with the program TetGen, which runs as a child process.
#ifndef DeformVolumeTetGenProcess_h
#define DeformVolumeTetGenProcess_h

#include "Error.h"

#include "vtkSmartPointer.h"

#include <glm/vec3.hpp>

#include <functional>
#include <string>
#include <vector>

class vtkPolyData;
class vtkUnstructuredGrid;

namespace deformvolume
{

/// A surface cannot be meshed. Another surface of the same body may be.
class SurfaceRejected : public Error
{
public:
  using Error::Error;
};

struct TetGenParameters
{
  std::string Executable;
  double RadiusEdgeRatio = 1.414;
  double MaximumVolume = 0.0;     // 0: no limits on the volume and the ratio, which is fast
  double TimeLimit = 60.0;        // seconds
  bool Diagnose = true;           // after a failure, look for self-intersections to name them
  std::vector<glm::dvec3> Points; // additional nodes; those outside the surface are ignored
};

/// Fills a closed triangle surface with tetrahedra. `wait` is called many times a second with the
/// part of the time limit that has passed. If it returns true, TetGen is ended and Aborted is
/// thrown. All failures throw Error.
vtkSmartPointer<vtkUnstructuredGrid> RunTetGen(vtkPolyData* surface,
  const TetGenParameters& parameters, const std::function<bool(double)>& wait);

} // namespace deformvolume

#endif
