// SPDX-License-Identifier: BSD-3-Clause
// Scenes of volumes that are cut, carved and split.
#include "ElasticTesting.h"
#include "SceneTesting.h"

#include "vtkCarveVolume.h"
#include "vtkCutVolume.h"

#include <vtkCellArray.h>
#include <vtkLookupTable.h>
#include <vtkPolyData.h>
#include <vtkSphere.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <functional>

using namespace sceneTesting;

namespace
{

// Returns a rounded block with layers, whose surface is two voxels within the volume. Values fall
// off at the surface, so that only the faces of cuts and carvings have steps of voxels.
vtkSmartPointer<vtkImageData> MakeBlock(const Extent& extent)
{
  auto volume = MakeImage(extent);
  AddValues<float>(volume, "layer", [](const glm::dvec3& p) { return std::cos(0.8 * p.z); });
  AddValues<float>(volume, "value",
    [&extent](const glm::dvec3& p)
    {
      glm::dvec3 outside;
      for (int axis = 0; axis < 3; ++axis)
      {
        const double depth = std::min(p[axis] - extent[2 * axis], extent[2 * axis + 1] - p[axis]);
        outside[axis] = std::max(4.0 - depth, 0.0);
      }
      return 25.0 * (4.0 - glm::length(outside));
    });
  return volume;
}

// Draws a deformed block. The background is half of the value of the isosurface.
void AddBlock(vtkRenderer* renderer, vtkDeformVolumeFilter* filter, double spacing)
{
  SetSampling(filter, spacing);
  AddSurface(renderer, filter->GetOutputPort(), "layer",
    MakeColors(-1.0, 1.0, { { 0.75, 0.45, 0.35 }, { 0.95, 0.85, 0.7 } }));
}

// Draws an edited block that a field with a vector at each voxel deforms.
void AddEditedBlock(vtkRenderer* renderer, vtkImageData* block, vtkAlgorithmOutput* edited,
  const WorldMap& map, Version version, double spacing)
{
  vtkNew<vtkImageData> field;
  field->CopyStructure(block);
  SetDisplacements(field, map);
  vtkNew<vtkDeformVolumeFilter> filter;
  filter->SetInputConnection(edited);
  filter->SetDeformationData(Shifted(field, version));
  AddBlock(renderer, filter, spacing);
}

// Returns a polyline. place: returns the points for parameters from 0 to 1.
vtkSmartPointer<vtkPolyData> MakeLine(int number, const std::function<glm::dvec3(double)>& place)
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  lines->InsertNextCell(number);
  for (int i = 0; i < number; ++i)
  {
    const glm::dvec3 point = place(i / (number - 1.0));
    lines->InsertCellPoint(points->InsertNextPoint(&point.x));
  }
  auto line = vtkSmartPointer<vtkPolyData>::New();
  line->SetPoints(points);
  line->SetLines(lines);
  return line;
}

} // namespace

namespace sceneTesting
{

// A wedge: the sheet ends within the block, and the two parts above its end are rotated apart.
// SPOILED: the block is not cut, so that it is stretched over the gap.
void DrawHardCut(vtkRenderWindow* window, Version version)
{
  const auto block = MakeBlock({ { -14, 14, -10, 10, -2, 24 } });
  vtkNew<vtkCutVolume> cut;
  cut->SetInputData(block);
  cut->SetSweepVector(0.0, 20.0, 0.0);
  if (version != Version::SPOILED)
  {
    cut->SetSheetData(MakeLine(2, [](double t) { return glm::dvec3(0.3, -10.0, 7.0 + 18.0 * t); }));
  }
  const auto open = [](const glm::dvec3& p)
  { return p + glm::dvec3((p.x < 0.3 ? -0.35 : 0.35) * std::max(p.z - 7.0, 0.0), 0.0, 0.0); };
  vtkRenderer* renderer =
    AddRenderer(window, glm::dvec3(0.0, 0.0, 10.0), glm::dvec3(30.0, -80.0, 45.0), 42.0);
  AddEditedBlock(renderer, block, cut->GetOutputPort(), open, version, 0.25);
}

// A curved cut that is pulled open: tetrahedra are left out (left) or divided (right). SPOILED:
// they are left out in both.
void DrawSmoothCut(vtkRenderWindow* window, Version version)
{
  const auto block = MakeBlock({ { -9, 9, -20, 20, -2, 8 } });
  const auto sheet = [](double y) { return 2.5 * std::sin(0.25 * y); };
  const auto open = [&](const glm::dvec3& p)
  { return p + glm::dvec3(p.x < sheet(p.y) ? -2.0 : 2.0, 0.0, 0.0); };
  for (const bool isSmooth : { false, true })
  {
    vtkNew<vtkCutVolume> cut;
    cut->SetInputData(block);
    cut->SetSheetData(MakeLine(101,
      [&](double t)
      {
        const double y = 50.0 * t - 25.0;
        return glm::dvec3(sheet(y), y, -5.0);
      }));
    cut->SetSweepVector(0.0, 0.0, 20.0);
    cut->SetSmoothCut(isSmooth && version != Version::SPOILED);
    vtkRenderer* renderer = AddRenderer(
      window, glm::dvec3(0.0, 0.0, 3.0), glm::dvec3(0.0, -50.0, 70.0), 40.0, isSmooth ? 1 : 0, 2);
    AddEditedBlock(renderer, block, cut->GetOutputPort(), open, version, 0.125);
  }
}

// A bowl that is carved out as whole tetrahedra (left) and with a smooth boundary (right). SPOILED:
// both are carved out as whole tetrahedra.
void DrawSmoothBoundary(vtkRenderWindow* window, Version version)
{
  const auto block = MakeBlock({ { -10, 10, -16, 16, -4, 12 } });
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(0.0, 0.0, 11.0);
  sphere->SetRadius(6.5);
  for (const bool isSmooth : { false, true })
  {
    vtkNew<vtkCarveVolume> carve;
    carve->SetInputData(block);
    carve->SetImplicitFunction(sphere);
    carve->SetSmoothBoundary(isSmooth && version != Version::SPOILED);
    vtkRenderer* renderer = AddRenderer(
      window, glm::dvec3(0.0, 0.0, 5.0), glm::dvec3(0.0, -60.0, 60.0), 34.0, isSmooth ? 1 : 0, 2);
    AddEditedBlock(renderer, block, carve->GetOutputPort(), Shift(0, 0, 0), version, 0.125);
  }
}

// A beam that is held at both ends and cut from below: its mesh is split along the sheet, and
// the cut opens. SPOILED: the volume is stretched over the gap.
void DrawSplit(vtkRenderWindow* window, Version version)
{
  const auto beam = MakeBlock({ { -22, 22, -7, 7, -2, 17 } });
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputData(beam);
  lattice->SetNumberOfNodes(13, 13, 13);
  lattice->SetMargin(0.5);
  lattice->Update();
  vtkNew<vtkUnstructuredGrid> mesh;
  mesh->ShallowCopy(lattice->GetOutput());
  elasticTesting::FixPoints(mesh, [](const glm::dvec3& p) { return std::abs(p.x) > 20.0; });
  vtkNew<vtkFiniteElementDeformation> elastic;
  elastic->SetInputData(mesh);
  elastic->SetSheetData(
    MakeLine(2, [](double t) { return glm::dvec3(0.0, -10.0, 21.0 * t - 10.0); }));
  elastic->SetSweepVector(0.0, 20.0, 0.0);
  elastic->SetGravity(0.0, 0.0, -80.0);
  elastic->Update();
  vtkNew<vtkDeformVolumeFilter> filter;
  filter->SetInputData(beam);
  filter->SetDeformationData(Shifted(elastic->GetOutput(), version));
  filter->SetOpenSplits(version != Version::SPOILED);
  AddBlock(AddRenderer(window, glm::dvec3(0.0, 0.0, 2.0), glm::dvec3(30.0, -90.0, 25.0), 46.0),
    filter, 0.25);
}

} // namespace sceneTesting
