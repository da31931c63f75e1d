// SPDX-License-Identifier: BSD-3-Clause
// A block that is cut along a curved sheet and pulled apart: whole tetrahedra left out, and beside
// it divided.
#include "SmoothPictures.h"

#include "vtkCutVolume.h"

#include <vtkCellArray.h>
#include <vtkPolyData.h>

#include <cmath>

using namespace filterTesting;

namespace
{

void Show(vtkRenderWindow* window, int column, bool smooth)
{
  auto volume = MakeImage({ { 0, 30, 0, 24, 0, 12 } });
  AddScalars<float>(volume, "value", [](const glm::dvec3&) { return 100.0; });
  const auto sheet = [](double y) { return 15.2 + 3.0 * std::sin(0.25 * y); };
  vtkNew<vtkPolyData> line;
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell(61);
  for (vtkIdType i = 0; i < 61; ++i)
  {
    const double y = -3.0 + 0.5 * static_cast<double>(i);
    points->InsertNextPoint(sheet(y), y, -5.0);
    lines->InsertCellPoint(i);
  }
  line->SetPoints(points);
  line->SetLines(lines);
  vtkNew<vtkCutVolume> cut;
  cut->SetInputData(volume);
  cut->SetSheetData(line);
  cut->SetSweepVector(0.0, 0.0, 30.0);
  cut->SetSmoothCut(smooth);
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(volume);
  SetDisplacements(field,
    [&](const glm::dvec3& p) { return p + glm::dvec3(p.x < sheet(p.y) ? -2.0 : 2.0, 0.0, 0.0); });
  smoothPictures::ShowSurface(window, column, cut->GetOutputPort(), field, 1.0);
}

} // namespace

int TestSmoothCutPicture(int argc, char* argv[])
{
  return smoothPictures::ComparePicture(argc, argv, Show);
}
