// SPDX-License-Identifier: BSD-3-Clause
// Meshes and a filter for the tests of vtkElasticDeformation and its subclasses.
#ifndef ElasticTesting_h
#define ElasticTesting_h

#include "ChainMailTesting.h"

#include "vtkFiniteElementDeformation.h"
#include "vtkLatticeTetrahedraSource.h"
#include "vtkMassSpringDeformation.h"

#include <vtkCellArray.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <type_traits>

namespace elasticTesting
{

using namespace chainMailTesting;
using namespace filterTesting;

// Adds the point array Fixed to a mesh.
template <typename IsFixed>
void FixPoints(vtkUnstructuredGrid* mesh, IsFixed&& isFixed)
{
  vtkNew<vtkUnsignedCharArray> fixed;
  fixed->SetName("Fixed");
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    fixed->InsertNextValue(isFixed(GetPoint(mesh, i)) ? 1 : 0);
  }
  mesh->GetPointData()->AddArray(fixed);
}

// Adds a point array of vectors to a mesh.
template <typename GetVector>
vtkDoubleArray* AddPointVectors(vtkUnstructuredGrid* mesh, const char* name, GetVector&& getVector)
{
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetName(name);
  vectors->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    const glm::dvec3 vector = getVector(GetPoint(mesh, i));
    vectors->InsertNextTuple(&vector.x);
  }
  mesh->GetPointData()->AddArray(vectors);
  return vectors;
}

// A bar of 4 x 4 x 12 cells and 1 x 1 x 3 cm, fixed at z = 0. unit: the length unit, in meters.
inline vtkSmartPointer<vtkUnstructuredGrid> MakeBar(double unit)
{
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetNumberOfNodes(5, 5, 13);
  const double width = 0.01 / unit;
  lattice->SetBounds(0.0, width, 0.0, width, 0.0, 3.0 * width);
  lattice->Update();
  auto bar = vtkSmartPointer<vtkUnstructuredGrid>::New();
  bar->DeepCopy(lattice->GetOutput());
  FixPoints(bar, [](const glm::dvec3& p) { return p.z == 0.0; });
  return bar;
}

// Finite elements have mid-side nodes.
template <typename Filter>
constexpr bool HasMidSides = std::is_same_v<Filter, vtkFiniteElementDeformation>;

// Makes a triangle that crosses a body in meters, in a plane of constant z.
inline vtkSmartPointer<vtkPolyData> MakeHorizontalSheet(double z)
{
  auto sheet = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(-1.0, -1.0, z);
  points->InsertNextPoint(1.0, -1.0, z);
  points->InsertNextPoint(0.0, 2.0, z);
  vtkNew<vtkCellArray> triangles;
  triangles->InsertNextCell({ 0, 1, 2 });
  sheet->SetPoints(points);
  sheet->SetPolys(triangles);
  return sheet;
}

// The number of nodes of MakeBar(). With mid-side nodes these are the points of a lattice twice as
// fine, except the centers of the cells.
template <typename Filter>
constexpr vtkIdType NodesOfBar = HasMidSides<Filter> ? 9 * 9 * 25 - 4 * 4 * 12 : 5 * 5 * 13;

template <typename FilterT>
struct Simulated : Observed<FilterT>
{
  explicit Simulated(vtkDataObject* mesh)
  {
    this->Filter->SetLengthUnitToMetre();
    this->Filter->SetInputDataObject(mesh);
  }

  // The displacements at a time.
  vtkSmartPointer<vtkFloatArray> At(double time)
  {
    this->Filter->UpdateTimeStep(time);
    return this->Copy();
  }

  vtkSmartPointer<vtkFloatArray> Copy()
  {
    auto copy = vtkSmartPointer<vtkFloatArray>::New();
    copy->DeepCopy(this->Filter->GetOutput()->GetPointData()->GetArray("Displacement"));
    return copy;
  }
};

} // namespace elasticTesting

#endif
