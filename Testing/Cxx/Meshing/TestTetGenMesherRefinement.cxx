// SPDX-License-Identifier: BSD-3-Clause
// Edges in refinement spheres have at most the requested length. Edges far away are as long as
// without spheres.
#include "vtkTetGenMesher.h"

#include "MeshChecks.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkSphereSource.h>

#include <algorithm>
#include <sstream>

using namespace meshChecks;

namespace
{

struct Sphere
{
  glm::dvec3 Center;
  double Radius;
  double EdgeLength;
};

struct Edges
{
  double Inside = 0.0;  // length of the longest edge with an end in the sphere
  double Through = 0.0; // length of the longest edge that intersects the sphere
  double Far = 0.0;     // length of the longest edge outside a sphere of twice the radius
  int Number = 0;       // edges with an end in the sphere, counted in each tetrahedron
};

Edges Measure(vtkUnstructuredGrid* mesh, const Sphere& sphere)
{
  Edges edges;
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    vtkIdType size;
    const vtkIdType* ids;
    mesh->GetCellPoints(cell, size, ids);
    for (int i = 0; i < 4; ++i)
    {
      for (int j = 0; j < i; ++j)
      {
        double ends[2][3];
        mesh->GetPoint(ids[i], ends[0]);
        mesh->GetPoint(ids[j], ends[1]);
        const glm::dvec3 a(ends[0][0], ends[0][1], ends[0][2]);
        const glm::dvec3 b(ends[1][0], ends[1][1], ends[1][2]);
        const double length = glm::distance(a, b);
        const double least =
          std::min(glm::distance(a, sphere.Center), glm::distance(b, sphere.Center));
        if (least < sphere.Radius)
        {
          edges.Inside = std::max(edges.Inside, length);
          ++edges.Number;
        }
        for (double t = 0.0; t <= 1.0; t += 0.01)
        {
          if (glm::distance(a + t * (b - a), sphere.Center) < sphere.Radius)
          {
            edges.Through = std::max(edges.Through, length);
          }
        }
        if (least > 2.0 * sphere.Radius)
        {
          edges.Far = std::max(edges.Far, length);
        }
      }
    }
  }
  return edges;
}

void VerifyEdges(vtkTetGenMesher* mesher, const std::vector<Sphere>& spheres)
{
  const Summary summary = Summarize(mesher->GetOutput());
  EXPECT_TRUE(summary.OverusedFaces == 0 && summary.OpenBoundaryEdges == 0);
  EXPECT_GT(summary.SmallestVolume, 0.0);
  // Tetrahedra with long edges near the spheres have a lower quality than the others.
  EXPECT_NEAR(summary.PoorShare, 0.0, 0.05);
  for (const Sphere& sphere : spheres)
  {
    const Edges edges = Measure(mesher->GetOutput(), sphere);
    // The tolerance is for the rounding of positions.
    EXPECT_LE(edges.Inside, sphere.EdgeLength * (1.0 + 1e-9));
    EXPECT_LE(edges.Through, sphere.EdgeLength * (1.0 + 1e-9));
    // The edges are not much shorter than requested.
    EXPECT_GT(edges.Inside, 0.7 * sphere.EdgeLength);
    EXPECT_GT(edges.Number, 100);
    std::cout << "edges up to " << edges.Inside << " of " << sphere.EdgeLength << ", " << edges.Far
              << " far away, " << mesher->GetOutput()->GetNumberOfCells() << " tetrahedra\n";
  }
}

void Add(vtkTetGenMesher* mesher, const std::vector<Sphere>& spheres)
{
  for (const Sphere& sphere : spheres)
  {
    mesher->AddRefinementSphere(
      sphere.Center.x, sphere.Center.y, sphere.Center.z, sphere.Radius, sphere.EdgeLength);
  }
}

// A ball in a volume that is mirrored and rotated.
TEST(TetGenMesherRefinement, Volume)
{
  vtkNew<vtkImageData> volume;
  volume->SetExtent(-30, 29, 0, 59, 10, 69);
  volume->SetSpacing(2.0, 2.0, 2.0);
  volume->SetOrigin(100.0, 0.0, 50.0);
  const double mirrored[9] = { 0.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0 };
  volume->SetDirectionMatrix(mirrored);
  const double middle[3] = { 0.0, 30.0, 40.0 };
  double center[3];
  volume->TransformContinuousIndexToPhysicalPoint(middle, center);
  const glm::dvec3 ball(center[0], center[1], center[2]);
  vtkNew<vtkFloatArray> values;
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    double point[3];
    volume->GetPoint(i, point);
    values->InsertNextValue(
      static_cast<float>(-glm::distance(glm::dvec3(point[0], point[1], point[2]), ball)));
  }
  volume->GetPointData()->SetScalars(values);

  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  mesher->SetInputData(volume);
  mesher->AutomaticIsovalueOff();
  mesher->SetIsovalue(-50.0);
  mesher->SetTargetEdgeLength(20.0);
  check.Succeeds();
  const vtkIdType coarse = mesher->GetOutput()->GetNumberOfCells();

  // A sphere around a point of the surface, one in the middle of the ball, and two that overlap.
  const Sphere skin{ ball + glm::dvec3(0.0, 50.0, 0.0), 50.0, 50.0 / 6.0 };
  EXPECT_GT(Measure(mesher->GetOutput(), skin).Inside, 2.0 * skin.EdgeLength);
  const Sphere inside{ ball, 15.0, 2.5 };
  const Sphere beside{ ball + glm::dvec3(30.0, 30.0, 0.0), 20.0, 20.0 / 6.0 };
  for (const std::vector<Sphere>& spheres : { std::vector<Sphere>{ skin },
         std::vector<Sphere>{ inside }, std::vector<Sphere>{ skin, beside } })
  {
    Add(mesher, spheres);
    check.Succeeds();
    VerifyEdges(mesher, spheres);
    EXPECT_EQ(mesher->GetNumberOfBodyVoxelsOutside(), 0);
    EXPECT_TRUE(Measure(mesher->GetOutput(), spheres[0]).Far > 12.0 || spheres[0].Radius > 40.0);
    mesher->ClearRefinementSpheres();
  }
  // A sphere outside the body does not change the mesh.
  Add(mesher, { { ball + glm::dvec3(500.0, 0.0, 0.0), 50.0, 1.0 } });
  check.Succeeds();
  EXPECT_EQ(mesher->GetOutput()->GetNumberOfCells(), coarse);
}

TEST(TetGenMesherRefinement, Surface)
{
  vtkNew<vtkSphereSource> source;
  source->SetRadius(10.0);
  source->SetThetaResolution(16);
  source->SetPhiResolution(12);
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  mesher->SetInputConnection(source->GetOutputPort());
  mesher->SetTargetEdgeLength(4.0);
  check.Succeeds();
  const double volume = Summarize(mesher->GetOutput()).Volume;
  const std::vector<Sphere> spheres{ { glm::dvec3(10.0, 0.0, 0.0), 6.0, 1.0 } };
  Add(mesher, spheres);
  check.Succeeds();
  VerifyEdges(mesher, spheres);
  // The surface has more triangles, but does not change its shape.
  EXPECT_NEAR(Summarize(mesher->GetOutput()).Volume / volume, 1.0, 1e-9);

  double sphere[5];
  mesher->GetRefinementSphere(0, sphere);
  EXPECT_TRUE(sphere[0] == 10.0 && sphere[3] == 6.0 && sphere[4] == 1.0);
  mesher->GetRefinementSphere(1, sphere);
  EXPECT_EQ(sphere[3], 0.0);
  EXPECT_EQ(mesher->GetNumberOfRefinementSpheres(), 1);
  std::ostringstream text;
  mesher->Print(text);
  EXPECT_TRUE(HasPart(text.str(), "Center: 10 0 0, Radius: 6, EdgeLength: 1"));
}

} // namespace
