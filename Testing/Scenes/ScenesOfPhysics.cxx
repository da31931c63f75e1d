// SPDX-License-Identifier: BSD-3-Clause
// Scenes of volumes that ChainMail and finite elements deform.
#include "ElasticTesting.h"
#include "SceneTesting.h"

#include "vtkTetGenMesher.h"

#include <vtkActor.h>
#include <vtkDataSetSurfaceFilter.h>
#include <vtkLookupTable.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkSphereSource.h>
#include <vtkWarpVector.h>

#include <glm/geometric.hpp>

using namespace sceneTesting;

namespace
{

void AddPolyData(
  vtkRenderer* renderer, vtkAlgorithmOutput* polyData, const glm::dvec3& color, bool isWireframe)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(polyData);
  mapper->ScalarVisibilityOff();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color.x, color.y, color.z);
  actor->GetProperty()->SetRepresentation(isWireframe ? VTK_WIREFRAME : VTK_SURFACE);
  actor->GetProperty()->SetLighting(!isWireframe);
  renderer->AddViewProp(actor);
}

} // namespace

namespace sceneTesting
{

// Soft tissue with a stiff ball in it, pinned at its lower border and dragged by a handle. SPOILED:
// the ball is as soft as the tissue around it.
void DrawChainMail(vtkRenderWindow* window, Version version)
{
  auto volume = MakeImage({ { -20, 20, -16, 16, -2, 2 } });
  const auto isBall = [](const glm::dvec3& p) { return std::hypot(p.x, p.y - 2.0) < 8.0; };
  AddValues<unsigned char>(volume, "material",
    [&](const glm::dvec3& p) { return version != Version::SPOILED && isBall(p) ? 4.0 : 1.0; });
  AddValues<unsigned char>(
    volume, "Pinned", [](const glm::dvec3& p) { return p.y < -15.5 ? 1.0 : 0.0; });
  AddValues<float>(volume, "value",
    [&](const glm::dvec3& p)
    {
      const double line =
        std::min(std::abs(std::remainder(p.x, 4.0)), std::abs(std::remainder(p.y, 4.0)));
      return (isBall(p) ? 50.0 : 0.0) + (line < 0.5 ? 10.0 : 40.0);
    });
  const std::vector<chainMailTesting::Handle> handles = {
    { { 0.0, 2.0, 0.0 }, { 8.0, 9.0, 0.0 } },
  };
  vtkNew<vtkChainMailDeformation> tissue;
  tissue->SetInputData(volume);
  tissue->SetMaterialArrayName("material");
  tissue->SetHandlesData(chainMailTesting::MakeHandles(handles));
  for (int step = 0; step < 10; ++step)
  {
    tissue->Modified();
    tissue->Update();
  }
  vtkNew<vtkDeformVolumeFilter> filter;
  filter->SetInputData(volume);
  filter->SetDeformationData(Shifted(tissue->GetOutput(), version));
  SetSampling(filter, 0.125, -1.0);
  filter->Update();
  vtkRenderer* renderer =
    AddRenderer(window, glm::dvec3(0.5, 2.5, 0.0), glm::dvec3(0, 0, 90), 46.0);
  AddSlice(renderer, filter->GetOutput(), "value",
    MakeColors(0.0, 100.0,
      { { 0.5, 0.25, 0.2 }, { 0.95, 0.75, 0.6 }, { 0.35, 0.4, 0.5 }, { 0.85, 0.9, 0.95 } }));
  for (const chainMailTesting::Handle& handle : handles)
  {
    vtkNew<vtkSphereSource> sphere;
    sphere->SetRadius(1.0);
    sphere->SetCenter(handle.Now.x, handle.Now.y, 5.0);
    AddPolyData(renderer, sphere->GetOutputPort(), glm::dvec3(1.0, 0.1, 0.1), false);
  }
}

// An arch that stands on its feet and is pushed sideways, with the surface of its mesh. SPOILED:
// the tissue is stiffer.
void DrawFiniteElements(vtkRenderWindow* window, Version version)
{
  auto volume = MakeImage({ { -20, 20, -7, 7, 0, 20 } });
  AddValues<short>(volume, "value",
    [](const glm::dvec3& p)
    { return 50.0 + 20.0 * (4.5 - std::hypot(std::hypot(p.x, p.z) - 13.0, p.y)); });
  vtkNew<vtkTetGenMesher> mesher;
  mesher->SetInputData(volume);
  mesher->AutomaticIsovalueOff();
  mesher->SetIsovalue(50.0);
  mesher->SetTargetEdgeLength(4.0);
  mesher->Update();
  vtkNew<vtkUnstructuredGrid> mesh;
  mesh->ShallowCopy(mesher->GetOutput());
  elasticTesting::FixPoints(mesh, [](const glm::dvec3& p) { return p.z < 1.0; });
  vtkNew<vtkFiniteElementDeformation> elastic;
  elastic->SetInputData(mesh);
  elastic->SetGravity(60.0, 0.0, -10.0);
  elastic->SetYoungModulus(version == Version::SPOILED ? 12000.0 : 10000.0);
  elastic->Update();
  const auto deformation = Shifted(elastic->GetOutput(), version);
  vtkNew<vtkDeformVolumeFilter> filter;
  filter->SetInputData(volume);
  filter->SetDeformationData(deformation);
  SetSampling(filter, 0.5, -50.0);
  vtkRenderer* renderer =
    AddRenderer(window, glm::dvec3(1.5, 0.0, 8.0), glm::dvec3(20.0, -80.0, 25.0), 42.0);
  AddSurface(renderer, filter->GetOutputPort());
  vtkNew<vtkWarpVector> warp;
  warp->SetInputData(deformation);
  vtkNew<vtkDataSetSurfaceFilter> surface;
  surface->SetInputConnection(warp->GetOutputPort());
  surface->SetNonlinearSubdivisionLevel(0); // straight edges between corners
  AddPolyData(renderer, surface->GetOutputPort(), glm::dvec3(0.6, 0.85, 1.0), true);
}

} // namespace sceneTesting
