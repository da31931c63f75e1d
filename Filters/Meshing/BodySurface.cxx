// SPDX-License-Identifier: BSD-3-Clause
#include "BodySurface.h"

#include "ClosedSurface.h"
#include "SincWindow.h"

#include "vtkFloatArray.h"
#include "vtkFlyingEdges3D.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkWindowedSincPolyDataFilter.h"

namespace deformvolume
{

vtkSmartPointer<vtkPolyData> ExtractSurface(const BodyLevelSet& grid)
{
  vtkNew<vtkFloatArray> values;
  // The filter reads them only.
  values->SetArray(const_cast<float*>(grid.Values.data()), grid.Count(), 1);
  const glm::dvec3 spacing = grid.Spacing();
  const glm::dvec3 origin = grid.FirstPosition();
  vtkNew<vtkImageData> image;
  image->SetDimensions(
    static_cast<int>(grid.Size[0]), static_cast<int>(grid.Size[1]), static_cast<int>(grid.Size[2]));
  image->SetSpacing(spacing.x, spacing.y, spacing.z);
  image->SetOrigin(origin.x, origin.y, origin.z);
  image->GetPointData()->SetScalars(values);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(image);
  contour->SetValue(0, 0.0);
  contour->ComputeNormalsOff();
  contour->ComputeGradientsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  return CleanTriangles(contour->GetOutput());
}

vtkSmartPointer<vtkPolyData> Smooth(vtkPolyData* surface, int iterations)
{
  if (iterations == 0)
  {
    return surface;
  }
  vtkNew<vtkWindowedSincPolyDataFilter> smoother;
  smoother->SetInputData(surface);
  smoother->SetNumberOfIterations(iterations);
  smoother->SetPassBand(0.05);
  UseHammingWindow(smoother);
  smoother->BoundarySmoothingOff();
  smoother->FeatureEdgeSmoothingOff();
  smoother->NonManifoldSmoothingOn();
  smoother->NormalizeCoordinatesOn();
  smoother->Update();
  return CleanTriangles(smoother->GetOutput());
}

} // namespace deformvolume
