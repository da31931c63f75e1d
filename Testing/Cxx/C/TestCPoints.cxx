// SPDX-License-Identifier: BSD-3-Clause
// dv_deform_points() moves points exactly as vtkDeformGeometryFilter does.
#include "CTesting.h"
#include "FilterTesting.h"

#include "vtkDeformGeometryFilter.h"
#include "vtkTestErrorObserver.h"

#include <vtkCellType.h>
#include <vtkCellTypeSource.h>
#include <vtkDoubleArray.h>
#include <vtkPolyData.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

using namespace filterTesting;

namespace
{

/// Random points in the cube from low to high on each axis.
std::vector<double> MakePoints(double low, double high)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> between(low, high);
  std::vector<double> points(3 * 40000);
  for (double& coordinate : points)
  {
    coordinate = between(random);
  }
  return points;
}

/// Compares both directions and all outside modes. Returns the number of points outside with
/// DISCARD.
std::int64_t Compare(
  InC& inC, vtkDataSet* deformation, bool fieldIsInverse, double low, double high)
{
  const std::vector<double> points = MakePoints(low, high);
  const auto count = static_cast<vtkIdType>(points.size() / 3);
  vtkNew<vtkDoubleArray> coordinates;
  coordinates->SetNumberOfComponents(3);
  coordinates->SetNumberOfTuples(count);
  std::copy(points.begin(), points.end(), coordinates->GetPointer(0));
  vtkNew<vtkPoints> given;
  given->SetData(coordinates);
  vtkNew<vtkPolyData> cloud;
  cloud->SetPoints(given);
  vtkNew<vtkDeformGeometryFilter> filter;
  filter->SetInputData(cloud);
  filter->SetDeformationData(deformation);
  filter->SetFieldIsInverse(fieldIsInverse);
  filter->SetFadeDistance(3.0);
  std::int64_t outside = 0;
  for (int mode = vtkDeformGeometryFilter::DISCARD; mode <= vtkDeformGeometryFilter::KEEP; ++mode)
  {
    filter->SetOutsideMode(mode);
    Check(dv_set_outside(inC.Deformer, mode, 3.0));
    for (const bool isInverse : { false, true })
    {
      SCOPED_TRACE(testing::Message() << "mode " << mode << ", inverse " << isInverse);
      filter->SetInverse(isInverse);
      vtkNew<vtkTest::ErrorObserver> observer;
      filter->AddObserver(vtkCommand::WarningEvent, observer);
      filter->Update();
      filter->RemoveObserver(observer);
      vtkPointSet* wanted = filter->GetOutput();
      std::vector<double> moved(points.size());
      std::vector<std::int8_t> valid(static_cast<std::size_t>(count));
      dv_points_request request = {};
      request.struct_size = sizeof(request);
      request.number_of_points = count;
      request.points = points.data();
      request.inverse = isInverse ? 1 : 0;
      request.moved = moved.data();
      request.valid = valid.data();
      dv_points_report report = {};
      report.struct_size = sizeof(report);
      Check(dv_deform_points(inC.Deformer, &request, &report));
      EXPECT_EQ(std::memcmp(moved.data(), wanted->GetPoints()->GetVoidPointer(0),
                  moved.size() * sizeof(double)),
        0);
      EXPECT_EQ(
        std::memcmp(valid.data(),
          wanted->GetPointData()->GetArray("vtkValidPointMask")->GetVoidPointer(0), valid.size()),
        0);
      EXPECT_EQ(report.number_of_outside_points, filter->GetNumberOfOutsidePoints());
      EXPECT_EQ(HasPart(report.warnings, "lie outside"), report.number_of_outside_points > 0);
      EXPECT_EQ(HasPart(report.warnings, "fades"), HasPart(observer->GetWarningMessage(), "fades"));
      if (mode == vtkDeformGeometryFilter::DISCARD && !isInverse)
      {
        outside = report.number_of_outside_points;
      }
    }
  }
  return outside;
}

// Quadratic hexahedra, some of which have additional nodes.
TEST(CPoints, Mesh)
{
  vtkNew<vtkCellTypeSource> source;
  source->SetCellType(VTK_QUADRATIC_HEXAHEDRON);
  source->SetBlocksDimensions(3, 3, 3);
  source->SetOutputPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  source->Update();
  vtkUnstructuredGrid* mesh = source->GetOutput();
  SetDisplacements(
    mesh, [](const glm::dvec3& p) { return p + 0.3 * glm::dvec3(p.y * p.y, std::sin(p.z), p.x); });
  InC inC;
  inC.SetMesh(mesh);
  const std::int64_t outside = Compare(inC, mesh, false, -0.5, 3.5);
  EXPECT_GT(outside, 10000);
  EXPECT_LT(outside, 30000);
}

TEST(CPoints, Field)
{
  auto field =
    MakeImage({ { 2, 9, -3, 6, 0, 7 } }, glm::dvec3(3.1, 2.9, 3.3), glm::dvec3(-20.0, -4.0, -12.0));
  SetObliqueDirection(field);
  SetDisplacements(
    field, [](const glm::dvec3& p) { return p + glm::dvec3(std::sin(0.3 * p.y), 1.0, 0.1 * p.x); });
  for (const bool isInverse : { false, true })
  {
    InC inC;
    inC.SetField(field, isInverse);
    const std::int64_t outside = Compare(inC, field, isInverse, -20.0, 20.0);
    EXPECT_GT(outside, 1000);
    EXPECT_LT(outside, 39000);
    // A point without a displacement.
    field->AllocatePointGhostArray();
    field->GetPointGhostArray()->SetValue(200, vtkDataSetAttributes::HIDDENPOINT);
    inC.SetField(field, isInverse);
    EXPECT_GT(Compare(inC, field, isInverse, -20.0, 20.0), outside);
    field->GetPointData()->RemoveArray("vtkGhostType");
  }
}

} // namespace
