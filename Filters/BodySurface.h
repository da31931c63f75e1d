// SPDX-License-Identifier: BSD-3-Clause
// The surface of the body in a volume, as a closed triangle mesh.
#ifndef DeformVolumeBodySurface_h
#define DeformVolumeBodySurface_h

#include "Error.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <functional>
#include <vector>

class vtkDataArray;
class vtkImageData;
class vtkPolyData;

namespace deformvolume
{

struct BodyParameters
{
  bool ByLabels = false;
  std::vector<vtkTypeInt64> Labels; // empty: all but 0
  bool AutomaticIsovalue = true;
  double Isovalue = 0.0; // set when it is found automatically
  bool LargestRegionOnly = true;
  double Resolution = 0.0; // world units
  double Margin = 0.0;     // world units
  int SmoothingIterations = 20;
};

/// The closed surface of the body in world coordinates, double precision. `check` is called between
/// the steps and throws to give up. Throws Error.
vtkSmartPointer<vtkPolyData> ExtractBodySurface(vtkImageData* volume, vtkDataArray* array,
  BodyParameters& parameters, const std::function<void()>& check);

} // namespace deformvolume

#endif
