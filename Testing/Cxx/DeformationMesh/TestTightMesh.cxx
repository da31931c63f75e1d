// SPDX-License-Identifier: BSD-3-Clause
// Meshes that fit bodies, one of them a mesh of a head by TetGen. The deformed volume must cover
// the points that vtkProbeFilter finds in the moved mesh, and have the values that a mesh over the
// whole volume gives.
#include "FilterTesting.h"
#include "vtkTetGenMesher.h"

#include <vtkCellLocator.h>
#include <vtkDataSetSurfaceFilter.h>
#include <vtkDoubleArray.h>
#include <vtkExtractVOI.h>
#include <vtkNIFTIImageReader.h>
#include <vtkPolyData.h>
#include <vtkProbeFilter.h>
#include <vtksys/SystemTools.hxx>

#include <glm/geometric.hpp>

#include <algorithm>
#include <random>

using namespace filterTesting;

namespace
{

const Extent VolumeExtent{ { -2, 37, 4, 41, 0, 38 } };
const glm::dvec3 Spacing(0.8, 1.0, 1.25);
const glm::dvec3 Center(14.3, 22.7, 24.1);

// Rounding moves nodes by up to 1/512 voxel on each axis. This bound, in millimeters, is four times
// as large.
constexpr double Margin = 1.25 / 128.0;
// A bound of the differences of two volumes of noise between 0 and 1. Derivatives by an index are
// at most 1. Rounding moves a rest coordinate by sqrt(3) / 512 on each of three axes. Spacings
// differ by up to 1.25 / 0.8.
const double NoiseBound = 2.0 * 3.0 * std::sqrt(3.0) / 512.0 * 1.6;

vtkSmartPointer<vtkImageData> MakeNoise()
{
  auto volume = MakeImage(VolumeExtent, Spacing, glm::dvec3(1.0, -2.0, 0.5));
  std::mt19937 random(5);
  std::uniform_real_distribution<float> number(0.0F, 1.0F);
  AddScalars<float>(volume, "noise", [&](const glm::dvec3&) { return number(random); });
  return volume;
}

/// A lattice over a cube from -1 to 1 whose nodes are moved by a map. Points have double precision.
vtkSmartPointer<vtkUnstructuredGrid> MakeBody(const std::array<int, 3>& nodes, const WorldMap& map)
{
  auto body = MakeTetrahedra({ { -1.0, 1.0, -1.0, 1.0, -1.0, 1.0 } }, nodes);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType id = 0; id < body->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = map(GetPoint(body, id));
    points->InsertNextPoint(&point.x);
  }
  body->SetPoints(points);
  return body;
}

glm::dvec3 ToBall(const glm::dvec3& p)
{
  const double largest = std::max({ std::abs(p.x), std::abs(p.y), std::abs(p.z) });
  return largest > 0.0 ? p * (largest / glm::length(p)) : p;
}

glm::dvec3 Turn(const glm::dvec3& p, double angle)
{
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const glm::dvec3 q(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
  return glm::dvec3(q.x, c * q.y - s * q.z, s * q.y + c * q.z);
}

/// A mesh that fits the head in a scan, as large as the volume allows; null without the scan.
vtkSmartPointer<vtkUnstructuredGrid> MakeHead()
{
  const char* const file = "/usr/share/mricron/templates/ch2.nii.gz";
  if (!vtksys::SystemTools::FileExists(file))
  {
    std::cout << "skipped: " << file << " is missing, install the package mricron-data\n";
    return nullptr;
  }
  vtkNew<vtkNIFTIImageReader> reader;
  reader->SetFileName(file);
  vtkNew<vtkExtractVOI> coarse;
  coarse->SetInputConnection(reader->GetOutputPort());
  coarse->SetSampleRate(4, 4, 4);
  vtkNew<vtkTetGenMesher> mesher;
  mesher->SetInputConnection(coarse->GetOutputPort());
  mesher->Update();
  vtkSmartPointer<vtkUnstructuredGrid> head = mesher->GetOutput();
  EXPECT_GT(head->GetNumberOfCells(), 1000);
  double bounds[6];
  head->GetBounds(bounds);
  const glm::dvec3 low(bounds[0], bounds[2], bounds[4]);
  const glm::dvec3 high(bounds[1], bounds[3], bounds[5]);
  MovePoints(head,
    [&](const glm::dvec3& p)
    { return Center + 22.0 / (high.y - low.y) * (p - 0.5 * (low + high)); });
  return head;
}

struct Body
{
  std::string Name;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
};

std::vector<Body> MakeBodies()
{
  std::vector<Body> bodies;
  for (const int nodes : { 4, 9, 17 })
  {
    bodies.push_back({ "ball of " + std::to_string(nodes),
      MakeBody({ { nodes, nodes, nodes } },
        [](const glm::dvec3& p) { return Center + 11.3 * ToBall(p); }) });
  }
  bodies.push_back({ "rod",
    MakeBody({ { 12, 5, 5 } },
      [](const glm::dvec3& p)
      {
        const glm::dvec3 disc = ToBall(glm::dvec3(0.0, p.y, p.z));
        return Center + Turn(glm::dvec3(12.0 * p.x, 3.1 * disc.y, 3.1 * disc.z), 0.5);
      }) });
  bodies.push_back({ "box",
    MakeBody({ { 3, 4, 3 } },
      [](const glm::dvec3& p) { return Center + Turn(p * glm::dvec3(9.0, 7.0, 8.0), 0.35); }) });
  bodies.push_back({ "wall",
    MakeBody({ { 8, 8, 2 } },
      [](const glm::dvec3& p) { return Center + Turn(p * glm::dvec3(9.0, 9.0, 0.6), 0.3); }) });
  // The two ends of the lattice meet: some faces nearly coincide.
  bodies.push_back({ "torus",
    MakeBody({ { 25, 5, 5 } },
      [](const glm::dvec3& p)
      {
        const double angle = 3.14159265358979 * p.x;
        const glm::dvec3 disc = 3.3 * ToBall(glm::dvec3(0.0, p.y, p.z));
        return Center +
          glm::dvec3((8.0 + disc.y) * std::cos(angle), (8.0 + disc.y) * std::sin(angle), disc.z);
      }) });
  bodies.push_back({ "bowl",
    MakeBody({ { 13, 13, 3 } },
      [](const glm::dvec3& p)
      {
        const glm::dvec3 out = glm::normalize(glm::dvec3(p.x, p.y, 0.7));
        return Center + (10.5 + 0.9 * p.z) * out;
      }) });
  if (const auto head = MakeHead())
  {
    bodies.push_back({ "head", head });
  }
  return bodies;
}

/// The mesh moved by its displacements, with the positions at rest as point data.
vtkSmartPointer<vtkUnstructuredGrid> MoveMesh(vtkUnstructuredGrid* mesh)
{
  auto moved = vtkSmartPointer<vtkUnstructuredGrid>::New();
  moved->CopyStructure(mesh);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> rest;
  rest->SetName("rest");
  rest->SetNumberOfComponents(3);
  vtkDataArray* displacements = mesh->GetPointData()->GetVectors();
  for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = GetPoint(mesh, id);
    glm::dvec3 displacement;
    displacements->GetTuple(id, &displacement.x);
    rest->InsertNextTuple(&point.x);
    const glm::dvec3 deformed = point + displacement;
    points->InsertNextPoint(&deformed.x);
  }
  moved->SetPoints(points);
  moved->GetPointData()->AddArray(rest);
  return moved;
}

void CheckBody(vtkImageData* volume, const Body& body, const WorldMap& map, bool isAffine)
{
  const auto mesh = body.Mesh;
  SetDisplacements(mesh, map);
  Deformed tight(volume, mesh);
  vtkImageData* output = tight.Update();

  const auto moved = MoveMesh(mesh);
  vtkNew<vtkImageData> grid;
  grid->CopyStructure(output);
  vtkNew<vtkProbeFilter> probe;
  probe->SetInputData(grid);
  probe->SetSourceData(moved);
  probe->ComputeToleranceOff();
  probe->SetTolerance(1e-9);
  probe->Update();
  vtkDataArray* inMesh = probe->GetOutput()->GetPointData()->GetArray("vtkValidPointMask");
  vtkNew<vtkDataSetSurfaceFilter> surface;
  surface->SetInputData(moved);
  surface->Update();
  vtkNew<vtkCellLocator> locator;
  locator->SetDataSet(surface->GetOutput());
  locator->BuildLocator();
  vtkIdType missing = 0;
  vtkIdType added = 0;
  vtkIdType covered = 0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    const bool isCovered = tight.IsCovered(id);
    const bool isInMesh = inMesh->GetComponent(id, 0) != 0.0;
    covered += isCovered ? 1 : 0;
    if (isCovered == isInMesh)
    {
      continue;
    }
    glm::dvec3 point = GetPoint(output, id);
    glm::dvec3 closest;
    vtkIdType cell = 0;
    int part = 0;
    double squared = 0.0;
    locator->FindClosestPoint(&point.x, &closest.x, cell, part, squared);
    if (std::sqrt(squared) > Margin)
    {
      missing += isInMesh ? 1 : 0;
      added += isCovered ? 1 : 0;
    }
  }
  EXPECT_EQ(missing, 0);
  EXPECT_EQ(added, 0);
  EXPECT_EQ(tight.Filter->GetNumberOfCoveredVoxels(), covered);
  EXPECT_GT(covered, 200);
  if (!isAffine)
  {
    return;
  }

  const auto wide = MakeMesh(volume, 2, 1.0);
  SetDisplacements(wide, map);
  Deformed whole(volume, wide);
  whole.Filter->SetOutputBoundsMode(vtkDeformVolumeFilter::CUSTOM_BOUNDS);
  double bounds[6];
  output->GetBounds(bounds);
  whole.Filter->SetCustomBounds(bounds);
  vtkImageData* all = whole.Update();
  double largest = 0.0;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    glm::dvec3 point = GetPoint(output, id);
    const vtkIdType there = all->FindPoint(&point.x);
    if (tight.IsCovered(id) && there >= 0 && whole.IsCovered(there))
    {
      largest = std::max(largest,
        std::abs(
          tight.GetValues()->GetComponent(id, 0) - whole.GetValues()->GetComponent(there, 0)));
    }
  }
  EXPECT_LE(largest, NoiseBound);
}

} // namespace

TEST(TightMesh, Bodies)
{
  const auto volume = MakeNoise();
  for (const Body& body : MakeBodies())
  {
    SCOPED_TRACE(body.Name);
    CheckBody(volume, body, Shift(0.0, 0.0, 0.0), true);
    CheckBody(volume, body, Shift(0.4, 0.5, -0.6), true);
    CheckBody(
      volume, body, [](const glm::dvec3& p) { return Center + Turn(p - Center, 0.8); }, true);
    CheckBody(
      volume, body,
      [](const glm::dvec3& p)
      {
        const glm::dvec3 q = 0.15 * (p - Center);
        return p + glm::dvec3(std::sin(q.y), 0.8 * std::cos(q.z), 1.1 * std::sin(q.x));
      },
      false);
  }
}
