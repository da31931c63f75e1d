// SPDX-License-Identifier: BSD-3-Clause
// Arrays with too few tuples as inputs of mesh sources: one error that names the array, and no
// access beyond its end.
#include "ArrayMaking.h"
#include "MeshChecks.h"
#include "vtkLatticeTetrahedraSource.h"
#include "vtkTetGenMesher.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSphereSource.h>
#include <vtkUnsignedCharArray.h>

using namespace meshChecks;

namespace
{

const char* const GHOSTS = "vtkGhostType";

TEST(MesherShortArrays, Meshers)
{
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(13, 13, 13);
  const auto values = MakeArray<vtkDoubleArray>("values", volume->GetNumberOfPoints());
  values->SetValue(volume->GetNumberOfPoints() / 2, 1.0);
  volume->GetPointData()->SetScalars(values);
  const vtkIdType count = volume->GetNumberOfPoints();
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  mesher->SetInputData(volume);
  vtkPointData* data = volume->GetPointData();
  data->AddArray(MakeArray<vtkUnsignedCharArray>(GHOSTS, 10));
  check.Fails("10 tuples");
  data->AddArray(MakeArray<vtkUnsignedCharArray>(GHOSTS, count, 3));
  check.Fails("3 components");
  data->AddArray(MakeArray<vtkIntArray>(GHOSTS, count));
  check.Fails("unsigned char");
  data->RemoveArray(GHOSTS);
  data->GetScalars()->SetNumberOfTuples(count - 1);
  check.Fails("tuples for");

  // vtkLatticeTetrahedraSource reads only the geometry of a volume.
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  FailureCheck latticeCheck(lattice);
  lattice->SetInputData(volume);
  latticeCheck.Succeeds();
  EXPECT_GT(lattice->GetOutput()->GetNumberOfCells(), 0);

  vtkNew<vtkSphereSource> sphere;
  sphere->Update();
  vtkNew<vtkPolyData> surface;
  surface->DeepCopy(sphere->GetOutput());
  mesher->SetInputData(surface);
  surface->GetPoints()->SetNumberOfPoints(20);
  surface->GetPoints()->Modified();
  check.Fails("there are only 20 points");
  surface->SetPoints(nullptr);
  check.Fails("there are only 0 points");
  surface->DeepCopy(sphere->GetOutput());
  surface->GetPolys()->GetConnectivityArray()->SetNumberOfTuples(30);
  surface->GetPolys()->Modified();
  check.Fails("do not fit their connectivity");
}

} // namespace
