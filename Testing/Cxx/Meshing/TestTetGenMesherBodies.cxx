// SPDX-License-Identifier: BSD-3-Clause
// The tetrahedra contain every voxel of bodies with thin parts. Voxels outside the mesh are
// counted.
#include "vtkTetGenMesher.h"

#include "BodyChecks.h"
#include "MeshChecks.h"

#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkShortArray.h>

#include <algorithm>
#include <cstdlib>
#include <random>

using namespace meshChecks;

namespace
{

constexpr int Size = 80;
using Body = std::function<bool(int, int, int)>;

vtkSmartPointer<vtkImageData> MakeVolume(const Body& body)
{
  auto volume = vtkSmartPointer<vtkImageData>::New();
  volume->SetExtent(3, Size + 2, -5, Size - 6, 0, Size - 1);
  volume->SetSpacing(1.0, 0.8, 1.2);
  volume->SetOrigin(10.0, 20.0, -30.0);
  const double rotation[9] = { 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 };
  volume->SetDirectionMatrix(rotation);
  vtkNew<vtkShortArray> values;
  values->SetName("values");
  values->SetNumberOfValues(volume->GetNumberOfPoints());
  for (vtkIdType i = 0; i < values->GetNumberOfValues(); ++i)
  {
    const int x = static_cast<int>(i % Size);
    const int y = static_cast<int>(i / Size % Size);
    const int z = static_cast<int>(i / Size / Size);
    values->SetValue(i, body(x, y, z) ? 100 : 0);
  }
  volume->GetPointData()->SetScalars(values);
  return volume;
}

double Square(double x)
{
  return x * x;
}

bool IsInBall(int x, int y, int z)
{
  return Square(x - 40) + Square(y - 40) + Square(z - 40) < Square(26);
}

// A ball with a nose, six voxels in diameter, and an ear, two voxels thick.
bool IsInHead(int x, int y, int z)
{
  const bool nose = Square(x - 40) + Square(z - 40) < 9 && y > 40 && y < 76;
  const bool ear = (x == 39 || x == 40) && z > 40 && Square(y - 40) + Square(z - 40) < Square(36);
  return IsInBall(x, y, z) || nose || ear;
}

// Sheets that are two voxels thick. One is at a face of the volume, and one is oblique.
bool IsInSheets(int x, int y, int z)
{
  return z < 2 || y == 30 || y == 31 || std::abs(x + y + 2 * z - 130) < 3;
}

// Vessels that are two voxels in diameter, in many pieces.
Body MakeVessels()
{
  std::vector<bool> vessels(Size * Size * Size, false);
  std::mt19937 generator(7);
  std::uniform_int_distribution<int> start(2, Size - 4);
  std::uniform_int_distribution<int> direction(-1, 1);
  for (int vessel = 0; vessel < 150; ++vessel)
  {
    int p[3] = { start(generator), start(generator), start(generator) };
    for (int step = 0; step < 25; ++step)
    {
      for (int i = 0; i < 8; ++i)
      {
        vessels[((p[2] + (i >> 2)) * Size + p[1] + (i >> 1 & 1)) * Size + p[0] + (i & 1)] = true;
      }
      for (int& position : p)
      {
        position = std::min(std::max(position + direction(generator), 1), Size - 3);
      }
    }
  }
  return [vessels](int x, int y, int z) -> bool { return vessels[(z * Size + y) * Size + x]; };
}

void VerifyHeld(vtkTetGenMesher* mesher, vtkImageData* volume, vtkIdType specks)
{
  const bodyChecks::Count count = bodyChecks::CountVoxels(volume, 50.0, mesher->GetOutput());
  EXPECT_EQ(mesher->GetNumberOfSpeckVoxels(), specks);
  EXPECT_EQ(mesher->GetNumberOfBodyVoxels(), count.Body - specks);
  EXPECT_EQ(mesher->GetNumberOfBodyVoxelsOutside(), 0);
  EXPECT_LE(count.Outside, specks);
  const Summary summary = Summarize(mesher->GetOutput());
  EXPECT_TRUE(summary.OverusedFaces == 0 && summary.OpenBoundaryEdges == 0);
  EXPECT_GT(summary.SmallestVolume, 0.0);
}

TEST(TetGenMesherBodies, ThinParts)
{
  const std::pair<const char*, Body> bodies[] = { { "head", IsInHead }, { "sheets", IsInSheets },
    { "vessels", MakeVessels() } };
  for (const auto& [name, body] : bodies)
  {
    const vtkSmartPointer<vtkImageData> volume = MakeVolume(body);
    for (const double length : { 0.0, 4.0, 20.0 })
    {
      for (const double margin : { 0.5, 0.0 })
      {
        vtkNew<vtkTetGenMesher> mesher;
        FailureCheck check(mesher);
        mesher->SetInputData(volume);
        mesher->SetTargetEdgeLength(length);
        mesher->SetMargin(margin);
        mesher->SetSpeckSize(0);
        check.Succeeds();
        SCOPED_TRACE(
          testing::Message() << name << ", edges of " << length << ", margin " << margin);
        VerifyHeld(mesher, volume, 0);
      }
    }
  }
}

TEST(TetGenMesherBodies, Specks)
{
  // 200 separate specks of 8 voxels.
  const vtkIdType specks = 200 * 8;
  const vtkSmartPointer<vtkImageData> volume = MakeVolume(
    [](int x, int y, int z)
    {
      const int number = (x / 8) + 10 * (y / 8);
      const bool speck = x % 8 < 2 && y % 8 < 2 && number < 100 && (z / 2 == 1 || z / 2 == 38);
      return IsInBall(x, y, z) || speck;
    });
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  mesher->SetInputData(volume);
  check.Succeeds();
  VerifyHeld(mesher, volume, specks);
  EXPECT_EQ(mesher->GetNumberOfPieces(), 1);
  EXPECT_TRUE(HasPart(mesher->GetSummary(), "Voxels of specks: 1,600"));
  mesher->SetSpeckSize(8);
  check.Succeeds();
  VerifyHeld(mesher, volume, specks);
  mesher->SetSpeckSize(7);
  check.Succeeds();
  VerifyHeld(mesher, volume, 0);
  EXPECT_EQ(mesher->GetNumberOfPieces(), 201);

  // If a body consists of specks only, they are meshed.
  const vtkSmartPointer<vtkImageData> lonely =
    MakeVolume([](int x, int y, int z) { return x == 40 && y == 40 && z == 40; });
  mesher->SetInputData(lonely);
  mesher->SetSpeckSize(26);
  mesher->SetTargetEdgeLength(5.0);
  check.Succeeds();
  VerifyHeld(mesher, lonely, 0);
}

// Smoothing collapses the surface of a few voxels if the edge length is about that of a voxel.
TEST(TetGenMesherBodies, FewVoxels)
{
  const std::pair<const char*, Body> bodies[] = {
    { "one voxel", [](int x, int y, int z) { return x == 40 && y == 40 && z == 40; } },
    { "two voxels", [](int x, int y, int z) { return x / 2 == 20 && y == 40 && z == 40; } },
    { "ball and voxel",
      [](int x, int y, int z)
      {
        return Square(x - 40) + Square(y - 40) + Square(z - 40) < Square(8) ||
          (x == 10 && y == 40 && z == 40);
      } }
  };
  for (const auto& [name, body] : bodies)
  {
    const vtkSmartPointer<vtkImageData> volume = MakeVolume(body);
    volume->SetSpacing(1.0, 1.0, 1.0);
    for (const double length : { 0.9, 1.1, 1.3 })
    {
      SCOPED_TRACE(testing::Message() << name << ", edges of " << length);
      vtkNew<vtkTetGenMesher> mesher;
      FailureCheck check(mesher);
      mesher->SetInputData(volume);
      mesher->SetTargetEdgeLength(length);
      mesher->SetSpeckSize(0);
      check.Succeeds();
      VerifyHeld(mesher, volume, 0);
      double bounds[6];
      mesher->GetOutput()->GetBounds(bounds);
      // A voxel extends half a spacing from its center.
      EXPECT_GE(bounds[5] - bounds[4], 1.0);
    }
  }
}

// Half of a slice is thicker than the margin. The mesh must contain the voxels of the outermost
// slices nevertheless.
TEST(TetGenMesherBodies, ThickSlices)
{
  const vtkSmartPointer<vtkImageData> volume =
    MakeVolume([](int x, int y, int z) { return z < 3 && Square(x - 40) + Square(y - 40) < 900; });
  volume->SetSpacing(0.2, 0.2, 10.0);
  for (const double length : { 2.0, 3.0 })
  {
    vtkNew<vtkTetGenMesher> mesher;
    FailureCheck check(mesher);
    mesher->SetInputData(volume);
    mesher->SetTargetEdgeLength(length);
    mesher->SetMargin(0.5);
    check.Succeeds();
    VerifyHeld(mesher, volume, 0);
  }
}

TEST(TetGenMesherBodies, PieceModes)
{
  // Voxels that share only a corner belong to one piece.
  const vtkSmartPointer<vtkImageData> volume = MakeVolume(
    [](int x, int y, int z)
    {
      const auto isInCube = [&](int a, int b) {
        return std::min({ x, y, z }) >= a && std::max({ x, y, z }) < b;
      };
      return isInCube(5, 15) || isInCube(15, 20) || isInCube(60, 72);
    });
  const vtkIdType first = 1000 + 125;
  const vtkIdType second = 12 * 12 * 12;
  vtkNew<vtkTetGenMesher> mesher;
  FailureCheck check(mesher);
  mesher->SetInputData(volume);
  mesher->SetTargetEdgeLength(4.0);
  check.Succeeds();
  EXPECT_EQ(mesher->GetNumberOfPieces(), 2);
  EXPECT_EQ(mesher->GetNumberOfBodyVoxels(), first + second);
  VerifyHeld(mesher, volume, 0);

  mesher->SetPieceModeToLargestPiece();
  {
    vtkNew<vtkTetGenMesher> other;
    vtkNew<vtkTest::ErrorObserver> errors;
    other->AddObserver(vtkCommand::WarningEvent, errors);
    other->SetPieceModeToLargestPiece();
    other->SetPieceMode(1); // the convex hull of previous versions
    EXPECT_EQ(errors->CheckWarningMessage("convex hull"), 0);
    EXPECT_EQ(other->GetPieceMode(), vtkTetGenMesher::ALL_PIECES);
  }
  check.Warns("1,125 of the 2,853 voxels of the body (39 %) lie outside the mesh. The body has 2 "
              "pieces");
  EXPECT_EQ(mesher->GetNumberOfBodyVoxels(), first + second);
  EXPECT_EQ(mesher->GetNumberOfBodyVoxelsOutside(), first);
  EXPECT_TRUE(HasPart(mesher->GetSummary(), "Body voxels outside the mesh: 1,125"));

  mesher->SetInputData(
    MakeVolume([](int x, int y, int z) { return x % 8 == 0 && y % 8 == 0 && z % 8 == 0; }));
  mesher->SetSpeckSize(0);
  check.Warns("999 of the 1,000 voxels of the body (99.9 %) lie outside the mesh.");
}

} // namespace
