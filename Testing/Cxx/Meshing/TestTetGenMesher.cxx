// SPDX-License-Identifier: BSD-3-Clause
// Meshes of volumes and of closed surfaces: size, position and quality of meshes of known bodies.
#include "vtkTetGenMesher.h"

#include "MeshChecks.h"

#include <vtkCubeSource.h>
#include <vtkCylinderSource.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkSphereSource.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>

#include <string>

using namespace meshChecks;

namespace
{

using Body = std::function<double(const glm::dvec3&)>;

const double Pi = 3.14159265358979323846;

void VerifySound(const Summary& summary)
{
  EXPECT_EQ(summary.OverusedFaces, 0);
  EXPECT_EQ(summary.OpenBoundaryEdges, 0);
  EXPECT_GT(summary.SmallestVolume, 0.0);
}

// A volume with a rotated direction matrix, uneven spacing and an extent that starts below 0.
vtkSmartPointer<vtkImageData> MakeVolume(const Body& value)
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetExtent(-20, 30, 5, 75, -30, 10);
  volume->SetSpacing(1.0, 0.75, 1.25);
  volume->SetOrigin(100.0, -50.0, 25.0);
  const double rotation[9] = { 2.0 / 3, -1.0 / 3, 2.0 / 3, 2.0 / 3, 2.0 / 3, -1.0 / 3, -1.0 / 3,
    2.0 / 3, 2.0 / 3 };
  volume->SetDirectionMatrix(rotation);
  vtkNew<vtkDoubleArray> values;
  values->SetName("values");
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    double point[3];
    volume->GetPoint(i, point);
    values->InsertNextValue(value(glm::dvec3(point[0], point[1], point[2])));
  }
  volume->GetPointData()->SetScalars(values);
  return volume;
}

glm::dvec3 CenterOfVolume()
{
  vtkSmartPointer<vtkImageData> volume = MakeVolume([](const glm::dvec3&) { return 0.0; });
  const double middle[3] = { 5.0, 40.0, -10.0 };
  double center[3];
  volume->TransformContinuousIndexToPhysicalPoint(middle, center);
  return glm::dvec3(center[0], center[1], center[2]);
}

TEST(TetGenMesher, Ball)
{
  const glm::dvec3 center = CenterOfVolume();
  const double radius = 20.0;
  const double ball = 4.0 / 3 * Pi * radius * radius * radius;
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  mesher->SetInputData(
    MakeVolume([&](const glm::dvec3& point) { return -glm::distance(point, center); }));
  mesher->AutomaticIsovalueOff();
  mesher->SetIsovalue(-radius);
  mesher->SetTargetEdgeLength(radius / 4);
  mesher->SetMargin(0.0);
  check.Succeeds();
  const Summary summary = Summarize(mesher->GetOutput());
  VerifySound(summary);
  EXPECT_NEAR(summary.Volume / ball, 1.0, 0.03);
  EXPECT_NEAR(glm::distance(summary.Centroid, center), 0.0, 0.05 * radius);
  EXPECT_NEAR(summary.MeanEdge, radius / 4, radius / 8);
  EXPECT_NEAR(summary.PoorShare, 0.0, 0.02);
  EXPECT_EQ(mesher->GetUsedIsovalue(), -radius);
  EXPECT_EQ(mesher->GetUsedTargetEdgeLength(), radius / 4);
  std::cout << "Ball: " << mesher->GetOutput()->GetNumberOfCells() << " tetrahedra, volume "
            << summary.Volume / ball << " of that of the ball, mean edge "
            << summary.MeanEdge / (radius / 4) << " of TargetEdgeLength, poor " << summary.PoorShare
            << '\n';

  // Another execution makes the same mesh. An empty name means the active scalars.
  mesher->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "");
  vtkNew<vtkUnstructuredGrid> first;
  first->DeepCopy(mesher->GetOutput());
  check.Succeeds();
  EXPECT_EQ(first->GetNumberOfPoints(), mesher->GetOutput()->GetNumberOfPoints());
  for (vtkIdType i = 0; i < first->GetNumberOfPoints() && !HasFailure(); ++i)
  {
    double a[3];
    double b[3];
    first->GetPoint(i, a);
    mesher->GetOutput()->GetPoint(i, b);
    EXPECT_TRUE(a[0] == b[0] && a[1] == b[1] && a[2] == b[2]);
  }

  for (double margin : { 0.5, 1.0 })
  {
    mesher->SetMargin(margin);
    check.Succeeds();
    const Summary wide = Summarize(mesher->GetOutput());
    VerifySound(wide);
    EXPECT_NEAR(
      std::cbrt(wide.Volume / (4.0 / 3 * Pi)), radius + margin * radius / 4, 0.03 * radius);
  }
}

TEST(TetGenMesher, Bodies)
{
  const glm::dvec3 center = CenterOfVolume();
  const glm::dvec3 aside(13.0, 0.0, 0.0);
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  mesher->SetTargetEdgeLength(3.0);
  mesher->SetMargin(0.0);

  // Two balls of radius 10 and 6, and an automatic isovalue between 40 and 90.
  const double large = 4.0 / 3 * Pi * 1000.0;
  const double small = 4.0 / 3 * Pi * 216.0;
  mesher->SetInputData(MakeVolume(
    [&](const glm::dvec3& point)
    {
      return glm::distance(point, center + aside) < 10.0 ||
          glm::distance(point, center - aside) < 6.0
        ? 90.0
        : 40.0;
    }));
  check.Succeeds();
  EXPECT_TRUE(mesher->GetUsedIsovalue() > 45.0 && mesher->GetUsedIsovalue() < 85.0);
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / (large + small), 1.0, 0.06);
  mesher->SetPieceModeToLargestPiece();
  check.Warns("voxels of the body (18 %) lie outside the mesh. The body has 2 pieces");
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / large, 1.0, 0.06);
  mesher->SetPieceModeToAllPieces();

  // A cavity is filled.
  mesher->SetInputData(MakeVolume(
    [&](const glm::dvec3& point)
    {
      const double distance = glm::distance(point, center);
      return distance < 15.0 && distance > 8.0 ? 90.0 : 40.0;
    }));
  check.Succeeds();
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / (4.0 / 3 * Pi * 3375.0), 1.0, 0.06);

  // A body that fills the volume is closed half a voxel outside the outermost voxels.
  mesher->AutomaticIsovalueOff();
  mesher->SetIsovalue(50.0);
  mesher->SetSmoothingIterations(0);
  mesher->SetInputData(MakeVolume([](const glm::dvec3&) { return 90.0; }));
  check.Succeeds();
  Summary summary = Summarize(mesher->GetOutput());
  VerifySound(summary);
  EXPECT_NEAR(summary.Volume / (51.0 * 71.0 * 0.75 * 41.0 * 1.25), 1.0, 0.06);
  mesher->SetSmoothingIterations(20);

  // Hidden voxels are outside.
  vtkSmartPointer<vtkImageData> hidden =
    MakeVolume([&](const glm::dvec3& point) { return 90.0 - glm::distance(point, center); });
  mesher->SetIsovalue(75.0); // radius 15
  hidden->AllocatePointGhostArray();
  for (vtkIdType i = 0; i < hidden->GetNumberOfPoints(); ++i)
  {
    if (i / (51 * 71) < 20) // below the center
    {
      hidden->GetPointGhostArray()->SetValue(i, vtkDataSetAttributes::HIDDENPOINT);
    }
  }
  mesher->SetInputData(hidden);
  check.Succeeds();
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / (2.0 / 3 * Pi * 3375.0), 1.0, 0.1);
}

// CT of a body in air, padded outside of a circle, and with an implant of metal.
TEST(TetGenMesher, Isovalues)
{
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  // getValue(i, x, y): the value of voxel i, at x, y from the axis of the body.
  const auto checkIsovalue = [&](const std::string& name, const auto& getValue)
  {
    vtkNew<vtkImageData> volume;
    volume->SetDimensions(40, 40, 20);
    volume->AllocateScalars(VTK_SHORT, 1);
    for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
    {
      double p[3];
      volume->GetPoint(i, p);
      volume->GetPointData()->GetScalars()->SetComponent(
        i, 0, getValue(i, p[0] - 19.5, p[1] - 19.5));
    }
    mesher->SetInputData(volume);
    check.Succeeds();
    EXPECT_TRUE(mesher->GetUsedIsovalue() > -940.0 && mesher->GetUsedIsovalue() < -10.0)
      << name << ": " << mesher->GetUsedIsovalue();
  };
  for (const double padding : { -1000.0, -2048.0, -3024.0 })
  {
    for (const double metal : { 40.0, 8000.0, 16000.0 })
    {
      checkIsovalue("padding " + std::to_string(padding) + ", metal " + std::to_string(metal),
        [&](vtkIdType i, double x, double y)
        {
          const double distance = std::hypot(x, y);
          const double noise = static_cast<double>(i * 7919 % 101) - 50.0;
          return std::hypot(x, y + 4.5) < 2.2 ? metal
            : distance < 12.0                 ? 40.0 + noise
            : distance < 19.5                 ? -1000.0 + noise
                                              : padding;
        });
    }
  }
  checkIsovalue("a body that is as small a part of the volume as metal can be",
    [](vtkIdType, double x, double y)
    {
      const double distance = std::hypot(x, y);
      return distance < 4.0 ? 40.0 : distance < 19.5 ? -1000.0 : -1024.0;
    });
}

TEST(TetGenMesher, Labels)
{
  // Two boxes whose labels differ by one, but are equal as doubles.
  const vtkTypeInt64 label = vtkTypeInt64(1) << 53;
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(60, 40, 40);
  vtkNew<vtkTypeInt64Array> labels;
  labels->SetName("labels");
  labels->SetNumberOfValues(volume->GetNumberOfPoints());
  for (vtkIdType i = 0; i < labels->GetNumberOfValues(); ++i)
  {
    const vtkIdType x = i % 60;
    const vtkIdType y = i / 60 % 40;
    const vtkIdType z = i / 2400;
    const bool inside = x >= 6 && x < 54 && y >= 8 && y < 32 && z >= 8 && z < 32;
    labels->SetValue(i, inside ? (x < 24 ? label : label + 1) : 0);
  }
  volume->GetPointData()->AddArray(labels);
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  mesher->SetInputData(volume);
  mesher->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "labels");
  mesher->SetBodyModeToLabels();
  mesher->SetTargetEdgeLength(4.0);
  mesher->SetMargin(0.0);
  check.Succeeds();
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / (48 * 24 * 24), 1.0, 0.06);
  mesher->AddLabel(label);
  check.Succeeds();
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / (18 * 24 * 24), 1.0, 0.06);
  EXPECT_LT(mesher->GetOutput()->GetBounds()[1], 25.0);
  mesher->ClearLabels();
  mesher->AddLabel(label + 1);
  EXPECT_TRUE(mesher->GetNumberOfLabels() == 1 && mesher->GetLabel(0) == label + 1);
  check.Succeeds();
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / (30 * 24 * 24), 1.0, 0.06);
  EXPECT_GT(mesher->GetOutput()->GetBounds()[0], 22.0);
}

// Flat faces and straight sides have edges of the target length, too.
TEST(TetGenMesher, FlatBodies)
{
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(70, 50, 16);
  volume->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  const int extent[6] = { 4, 65, 4, 45, 4, 11 };
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    double p[3];
    volume->GetPoint(i, p);
    const bool inside = p[0] >= extent[0] && p[0] <= extent[1] && p[1] >= extent[2] &&
      p[1] <= extent[3] && p[2] >= extent[4] && p[2] <= extent[5];
    volume->GetPointData()->GetScalars()->SetComponent(i, 0, inside ? 1.0 : 0.0);
  }
  mesher->SetInputData(volume);
  mesher->SetBodyModeToLabels();
  mesher->SetTargetEdgeLength(3.0);
  check.Succeeds();
  EXPECT_EQ(mesher->GetNumberOfBodyVoxelsOutside(), 0);
  Summary summary = Summarize(mesher->GetOutput());
  VerifySound(summary);
  EXPECT_NEAR(summary.MeanEdge, 3.0, 0.5);
  EXPECT_LT(summary.LongestEdge, 3.0 * 3.0);

  vtkNew<vtkCylinderSource> cylinder; // each side is one long face
  cylinder->SetResolution(200);
  cylinder->SetRadius(2.0);
  cylinder->SetHeight(40.0);
  mesher->SetInputConnection(cylinder->GetOutputPort());
  mesher->SetTargetEdgeLength(2.0);
  check.Succeeds();
  summary = Summarize(mesher->GetOutput());
  VerifySound(summary);
  EXPECT_NEAR(summary.Volume / (Pi * 4.0 * 40.0), 1.0, 0.06);
  EXPECT_LT(summary.LongestEdge, 3.0 * 2.0);
}

TEST(TetGenMesher, Surfaces)
{
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  vtkNew<vtkCubeSource> cube; // has twelve triangles, which the mesher splits
  cube->SetCenter(1e5, 0.0, 0.0);
  mesher->SetInputConnection(cube->GetOutputPort());
  mesher->SetTargetEdgeLength(0.2);
  check.Succeeds();
  Summary summary = Summarize(mesher->GetOutput());
  VerifySound(summary);
  EXPECT_NEAR(summary.Volume, 1.0, 1e-9);
  EXPECT_NEAR(summary.MeanEdge, 0.2, 0.1);
  double bounds[6];
  mesher->GetOutput()->GetBounds(bounds);
  EXPECT_TRUE(bounds[0] == 1e5 - 0.5 && bounds[3] == 0.5);

  vtkNew<vtkSphereSource> sphere; // is too fine, so that the mesher decimates it
  sphere->SetThetaResolution(100);
  sphere->SetPhiResolution(100);
  sphere->SetRadius(1.0);
  mesher->SetInputConnection(sphere->GetOutputPort());
  mesher->SetTargetEdgeLength(0.25);
  check.Succeeds();
  summary = Summarize(mesher->GetOutput());
  VerifySound(summary);
  EXPECT_NEAR(summary.Volume / (4.0 / 3 * Pi), 1.0, 0.03);
  EXPECT_NEAR(summary.BoundaryFaces / (4.0 * Pi / (std::sqrt(3.0) / 4 * 0.0625)), 1.0, 0.1);
  mesher->DecimationOff();
  check.Succeeds();
  summary = Summarize(mesher->GetOutput());
  EXPECT_EQ(summary.BoundaryFaces, 2 * 100 * 98);
}

// Bodies in nanometers, or in meters, of any size.
TEST(TetGenMesher, Units)
{
  for (const double unit : { 1e-9, 1.0, 1e9 })
  {
    vtkNew<vtkCubeSource> cube;
    cube->SetXLength(unit);
    cube->SetYLength(unit);
    cube->SetZLength(unit);
    vtkNew<vtkTetGenMesher> mesher;
    FailureCheck check(mesher);
    mesher->SetInputConnection(cube->GetOutputPort());
    mesher->SetTargetEdgeLength(0.4 * unit);
    check.Succeeds();
    EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / (unit * unit * unit), 1.0, 1e-6);
  }
}

// Piece 0 is the whole mesh. The other pieces are empty, and need no work.
TEST(TetGenMesher, Pieces)
{
  vtkNew<vtkCubeSource> cube;
  vtkNew<vtkTetGenMesher> mesher;
  mesher->SetInputConnection(cube->GetOutputPort());
  mesher->SetTargetEdgeLength(0.4);
  for (const int piece : { 1, 0, 2 })
  {
    mesher->UpdatePiece(piece, 3, 0);
    EXPECT_EQ(mesher->GetOutput()->GetNumberOfCells() > 0, piece == 0);
    EXPECT_EQ(mesher->GetUsedTargetEdgeLength() > 0.0, piece == 0);
  }
}

} // namespace
