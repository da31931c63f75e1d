// SPDX-License-Identifier: BSD-3-Clause
// Deforms volumes on several ranks: each rank makes its piece of the output, and all pieces equal
// the output of one process to the last bit, whichever rank has the deformation mesh. Errors are
// reported on all ranks. With the argument "cold", tests the start with an empty kernel cache.
#include "../Reported.h"
#include "DivisionCases.h"
#include "RankTesting.h"
#include "TenNodeCells.h"

#include "vtkDeformGeometryFilter.h"

#include <vtkIdList.h>
#include <vtkIdTypeArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTrivialProducer.h>

#include <algorithm>
#include <array>
#include <limits>
#include <thread>

using namespace divisionCases;

namespace
{

/// Returns the output of one process, on all ranks.
vtkSmartPointer<vtkImageData> MakeWhole(const Case& from)
{
  Deformed whole(from.Volume, from.Deformation);
  from.Set(whole.Filter);
  return MakeOnFirstRank([&] { return whole.Update(); });
}

/// Compares the piece of this rank with the whole output.
void Check(Deformed& deformed, vtkImageData* whole, const std::string& name, int ghosts = 0)
{
  deformed.Filter->UpdatePiece(GetRank(), GetRanks(), ghosts);
  EXPECT_EQ(deformed.TakeErrors(), 0) << deformed.LastError;
  vtkImageData* output = deformed.Filter->GetOutput();
  // Counts are sums over all ranks.
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  vtkIdType mine = 0;
  for (vtkIdType id = 0; mask && id < mask->GetNumberOfTuples(); ++id)
  {
    mine += mask->GetComponent(id, 0) != 0.0 ? 1 : 0;
  }
  vtkIdType all = 0;
  Controller->AllReduce(&mine, &all, 1, vtkCommunicator::SUM_OP);
  EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), all);
  const Extent piece = GetPiece(GetExtent(whole), ghosts);
  if (piece[1] < piece[0])
  {
    EXPECT_EQ(output->GetNumberOfPoints(), 0);
    return;
  }
  EXPECT_EQ(GetExtent(output), piece);
  EXPECT_TRUE(IsPartOf(output, whole)) << name << ", rank " << GetRank() << " of " << GetRanks();
}

enum class Spread
{
  Everywhere, // each rank has the whole mesh
  OnOne,      // the last rank has the whole mesh
  Pieces,     // each rank has some cells, and the points of these
  WithGhosts  // as Pieces, and neighboring cells as ghost cells
};

/// Returns the part of a mesh that this rank has.
vtkSmartPointer<vtkUnstructuredGrid> Distribute(vtkUnstructuredGrid* mesh, Spread spread)
{
  auto mine = vtkSmartPointer<vtkUnstructuredGrid>::New();
  const vtkIdType cells = mesh->GetNumberOfCells();
  vtkIdType begin = cells * GetRank() / GetRanks();
  vtkIdType end = cells * (GetRank() + 1) / GetRanks();
  if (spread == Spread::Everywhere || (spread == Spread::OnOne && GetRank() + 1 == GetRanks()))
  {
    mine->ShallowCopy(mesh);
    return mine;
  }
  if (spread == Spread::OnOne)
  {
    return mine;
  }
  const vtkIdType ghosts = spread == Spread::WithGhosts ? 40 : 0;
  vtkNew<vtkUnsignedCharArray> types;
  types->SetName(vtkDataSetAttributes::GhostArrayName());
  vtkNew<vtkPoints> points;
  points->SetDataType(mesh->GetPoints()->GetDataType());
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  const auto mineVectors = vtkSmartPointer<vtkDataArray>::Take(vectors->NewInstance());
  mineVectors->SetName(vectors->GetName());
  mineVectors->SetNumberOfComponents(3);
  std::vector<vtkIdType> known(mesh->GetNumberOfPoints(), -1);
  mine->Allocate();
  for (vtkIdType cell = std::max<vtkIdType>(0, begin - ghosts);
       cell < std::min(cells, end + ghosts); ++cell)
  {
    vtkNew<vtkIdList> ids;
    mesh->GetCellPoints(cell, ids);
    for (vtkIdType k = 0; k < ids->GetNumberOfIds(); ++k)
    {
      vtkIdType& id = known[ids->GetId(k)];
      if (id < 0)
      {
        id = points->InsertNextPoint(mesh->GetPoint(ids->GetId(k)));
        mineVectors->InsertNextTuple(ids->GetId(k), vectors);
      }
      ids->SetId(k, id);
    }
    mine->InsertNextCell(mesh->GetCellType(cell), ids);
    types->InsertNextValue(cell < begin || cell >= end ? vtkDataSetAttributes::DUPLICATECELL : 0);
  }
  mine->SetPoints(points);
  mine->GetPointData()->SetVectors(mineVectors);
  if (spread == Spread::WithGhosts)
  {
    mine->GetCellData()->AddArray(types);
  }
  return mine;
}

struct Parallel : Deformed
{
  explicit Parallel(const Case& from, bool parts = true)
  {
    this->Source->SetVolume(from.Volume);
    this->Source->CanMakeParts = parts;
    this->Filter->SetInputConnection(this->Source->GetOutputPort());
    this->Filter->SetDeformationData(from.Deformation);
    from.Set(this->Filter);
  }
  vtkNew<PartSource> Source;
};

/// Returns a mesh with deformed points, rounded to the type of the points.
vtkSmartPointer<vtkUnstructuredGrid> Move(vtkUnstructuredGrid* mesh)
{
  auto moved = vtkSmartPointer<vtkUnstructuredGrid>::New();
  moved->DeepCopy(mesh);
  for (vtkIdType id = 0; id < moved->GetNumberOfPoints(); ++id)
  {
    double vector[3];
    mesh->GetPointData()->GetVectors()->GetTuple(id, vector);
    const glm::dvec3 point = GetPoint(mesh, id) + glm::dvec3(vector[0], vector[1], vector[2]);
    moved->GetPoints()->SetPoint(id, &point.x);
  }
  return moved;
}

void TestSpread(const Case& from, vtkImageData* whole)
{
  auto* mesh = vtkUnstructuredGrid::SafeDownCast(from.Deformation);
  // With a mesh at rest instead of displacements.
  const auto moved = Move(mesh);
  Case two = from;
  two.Name += ", two meshes";
  two.Deformation = moved;
  two.Set = [&](vtkDeformVolumeFilter* filter)
  {
    from.Set(filter);
    filter->SetRestData(mesh);
  };
  const auto wholeOfTwo = MakeWhole(two);
  for (const Spread spread :
    { Spread::Everywhere, Spread::OnOne, Spread::Pieces, Spread::WithGhosts })
  {
    const std::string how = ", spread " + std::to_string(static_cast<int>(spread));
    Parallel parallel(from);
    parallel.Filter->SetDeformationData(Distribute(mesh, spread));
    Check(parallel, whole, from.Name + how);
    Parallel parallelTwo(two);
    parallelTwo.Filter->SetDeformationData(Distribute(moved, spread));
    parallelTwo.Filter->SetRestData(Distribute(mesh, spread));
    Check(parallelTwo, wholeOfTwo, two.Name + how);
  }
}

/// Returns a mesh that is split across x, below the middle of y. amount: how far the split opens.
vtkSmartPointer<vtkUnstructuredGrid> Split(const Case& from, double amount)
{
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->DeepCopy(from.Deformation);
  const glm::dvec3 middle = GetCenter(from.Volume);
  vtkPoints* points = mesh->GetPoints();
  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  const vtkIdType count = points->GetNumberOfPoints();
  std::vector<std::vector<vtkIdType>> nodes; // of each cell
  std::vector<unsigned char> isRight;        // whether a cell is beyond the split
  std::vector<unsigned char> isLeftNode(count, 0);
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> ids;
    mesh->GetCellPoints(cell, ids);
    nodes.emplace_back(ids->begin(), ids->end());
    double x = 0.0;
    for (const vtkIdType node : nodes.back())
    {
      x += GetPoint(mesh, node).x / static_cast<double>(nodes.back().size());
    }
    isRight.push_back(x > middle.x ? 1 : 0);
    for (const vtkIdType node : nodes.back())
    {
      isLeftNode[node] |= isRight.back() == 0 ? 1 : 0;
    }
  }
  std::vector<vtkIdType> twins(count, -1); // of nodes on the right
  for (std::size_t cell = 0; cell < nodes.size(); ++cell)
  {
    for (vtkIdType& node : nodes[cell])
    {
      const glm::dvec3 point = GetPoint(mesh, node);
      if (isRight[cell] == 0 || point.y >= middle.y)
      {
        continue;
      }
      if (twins[node] < 0)
      {
        glm::dvec3 vector;
        vectors->GetTuple(node, &vector.x);
        vector.x += amount * (middle.y - point.y);
        twins[node] = isLeftNode[node] == 0 ? node : points->InsertNextPoint(&point.x);
        vectors->InsertTuple(twins[node], &vector.x);
      }
      node = twins[node];
    }
    mesh->GetCells()->ReplaceCellAtId(
      static_cast<vtkIdType>(cell), static_cast<vtkIdType>(nodes[cell].size()), nodes[cell].data());
  }
  EXPECT_GT(points->GetNumberOfPoints(), count);
  return mesh;
}

/// Tests that the volume opens at the splits of a mesh, and not at the borders of its pieces, also
/// if the mesh moves, and if the sides of the split have met.
void TestSplits(const Case& from)
{
  Case open = from;
  open.Set = [&](vtkDeformVolumeFilter* filter)
  {
    from.Set(filter);
    filter->OpenSplitsOn();
  };
  open.Name = "No split";
  TestSpread(open, MakeWhole(open));
  open.Name = "Split";
  Parallel moving(open);
  for (const double amount : { 0.5, 0.2, 0.0, 0.5 })
  {
    const auto mesh = Split(from, amount);
    open.Deformation = mesh;
    moving.Filter->SetDeformationData(Distribute(mesh, Spread::Pieces));
    if (amount == 0.0)
    {
      // Nodes that have not moved apart are joined at the borders of pieces.
      moving.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
      EXPECT_EQ(moving.TakeErrors(), 0) << moving.LastError;
      continue;
    }
    const auto whole = MakeWhole(open);
    Check(moving, whole, "Split that moves");
    TestSpread(open, whole);
  }
  EXPECT_LE(GetReported(moving.Filter, "Static mappings made"), 2);
}

/// Tests that an error which one rank causes is reported on all ranks with the same text, and that
/// the filter works when the cause is removed. isOfRank: whether the error is that of this rank,
/// rather than a difference between ranks.
void TestError(const Case& from, vtkImageData* whole, const std::string& words,
  const std::function<void(Parallel&)>& spoil, const std::function<void(Parallel&)>& restore,
  bool isOfRank = true)
{
  Parallel parallel(from);
  if (GetRank() == GetRanks() - 1)
  {
    spoil(parallel);
  }
  parallel.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
  EXPECT_EQ(parallel.TakeErrors(), 1);
  EXPECT_TRUE(HasPart(parallel.LastError, words));
  // An error that belongs to one rank names it.
  const std::string last = "(On rank " + std::to_string(GetRanks() - 1) + ".)";
  EXPECT_EQ(parallel.LastError.find(last) != std::string::npos, GetRanks() > 1 && isOfRank);
  EXPECT_EQ(parallel.Filter->GetOutput()->GetNumberOfPoints(), 0);
  restore(parallel);
  Check(parallel, whole, words);
}

/// Tests that an error of the reference image on the last rank is one error on all ranks.
void TestReferenceErrors(const Case& from, vtkImageData* whole)
{
  const auto good = MakeReference(from.Volume, true);
  const auto restore = [&](Parallel& parallel)
  {
    parallel.Filter->SetReferenceData(good);
    parallel.Filter->Modified(); // on all ranks
  };
  TestError(
    from, whole, "spacing of the reference image on axis y",
    [&](Parallel& parallel)
    {
      vtkNew<vtkImageData> flat;
      flat->CopyStructure(good);
      flat->SetSpacing(1.0, 0.0, 1.0);
      parallel.Filter->SetReferenceData(flat);
    },
    restore);
  if (GetRanks() == 1)
  {
    return;
  }
  TestError(
    from, whole, "is connected on some ranks only",
    [](Parallel& parallel) { parallel.Filter->SetReferenceData(nullptr); }, restore, false);
  TestError(
    from, whole, "different grids on different ranks",
    [&](Parallel& parallel)
    {
      vtkNew<vtkImageData> shifted;
      shifted->CopyStructure(good);
      shifted->SetOrigin(0.0, 1e-9, 0.0);
      parallel.Filter->SetReferenceData(shifted);
    },
    restore, false);
}

/// Tests that a setting or a connection of the last rank that differs is an error on all ranks.
void TestSettings(const Case& from, vtkImageData* whole)
{
  using Filter = vtkDeformVolumeFilter;
  const auto test = [&](const std::string& words, const std::function<void(Filter*)>& spoil,
                      const std::function<void(Filter*)>& restore)
  {
    TestError(
      from, whole, words, [&](Parallel& parallel) { spoil(parallel.Filter); },
      [&](Parallel& parallel)
      {
        restore(parallel.Filter);
        parallel.Filter->Modified(); // on all ranks
      },
      false);
  };
  test(
    "deformation on input port 1 is connected on some ranks only",
    [](Filter* filter) { filter->SetDeformationData(nullptr); },
    [&](Filter* filter) { filter->SetDeformationData(from.Deformation); });
  test(
    "mesh at rest on input port 2 is connected on some ranks only",
    [&](Filter* filter) { filter->SetRestData(from.Deformation); },
    [](Filter* filter) { filter->SetRestData(nullptr); });
  test(
    "OutputBoundsMode is not the same on all ranks",
    [](Filter* filter) { filter->SetOutputBoundsModeToVolumeBounds(); },
    [](Filter* filter) { filter->SetOutputBoundsModeToDeformedBounds(); });
  test(
    "CustomBounds is not the same on all ranks",
    [](Filter* filter) { filter->SetCustomBounds(-1.0, 1.0, -1.0, 1.0, -1.0, 1.0 + 1e-15); },
    [](Filter* filter) { filter->SetCustomBounds(-1.0, 1.0, -1.0, 1.0, -1.0, 1.0); });
  test(
    "GenerateJacobian is not the same on all ranks",
    [](Filter* filter) { filter->GenerateJacobianOn(); },
    [](Filter* filter) { filter->GenerateJacobianOff(); });
  test(
    "list of density arrays is not the same on all ranks",
    [](Filter* filter) { filter->AddDensityArray("float"); },
    [](Filter* filter) { filter->ClearDensityArrays(); });
}

/// Tests that a source which announces another volume on the last rank is an error on all ranks:
/// each rank would make a piece of another output.
void TestVolumeErrors(const Case& from, vtkImageData* whole)
{
  const auto test = [&](const std::function<void(vtkImageData*)>& change)
  {
    TestError(
      from, whole, "volume on input port 0 has different grids on different ranks",
      [&](Parallel& parallel)
      {
        vtkNew<vtkImageData> other;
        other->ShallowCopy(from.Volume);
        change(other);
        parallel.Source->SetVolume(other);
      },
      [&](Parallel& parallel) { parallel.Source->SetVolume(from.Volume); }, false);
  };
  test(
    [](vtkImageData* other)
    {
      const Extent slab{ { -9, 62, 3, 29, -15, 2 } };
      other->Crop(slab.data());
    });
  test([](vtkImageData* other) { other->SetOrigin(3.0, -2.0, 1.0 + 1e-9); });
  test([](vtkImageData* other) { other->SetSpacing(1.0, 1.0, 1.5); });
  test(
    [](vtkImageData* other)
    {
      const double direction[9] = { 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0 };
      other->SetDirectionMatrix(direction);
    });
}

/// Tests an output that is background only: each rank that has a piece warns once.
void TestNothingCovered(const Case& from)
{
  Parallel parallel(from);
  const auto far = MakeReference(from.Volume, true);
  far->SetOrigin(500.0, 0.0, 0.0);
  parallel.Filter->SetReferenceData(far);
  parallel.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
  const std::string warnings = parallel.Observer->GetWarningMessage();
  EXPECT_EQ(parallel.TakeErrors(), 0);
  const std::size_t at = warnings.find("covers no voxel of the output");
  const bool hasPiece = parallel.Filter->GetOutput()->GetNumberOfPoints() > 0;
  EXPECT_EQ(at != std::string::npos, hasPiece);
  EXPECT_EQ(warnings.rfind("Warning: "), warnings.find("Warning: "));
  // A rank whose piece is background only does not warn if another rank covers voxels.
  far->SetOrigin(MakeReference(from.Volume, true)->GetOrigin());
  far->SetExtent(4, 200, -11, 29, -8, 33);
  far->Modified();
  parallel.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
  EXPECT_EQ(parallel.TakeErrors(), 0);
  EXPECT_GT(parallel.Filter->GetNumberOfCoveredVoxels(), 0);
  EXPECT_EQ(parallel.TakeWarning(), "");
}

/// Tests a cell that is ignored on the last rank: all ranks warn, because programs such as ParaView
/// show the warnings of the first rank only.
void TestIgnoredCell(const Case& from)
{
  const auto piece =
    Distribute(vtkUnstructuredGrid::SafeDownCast(from.Deformation), Spread::Pieces);
  piece->GetCellData()->Initialize();
  if (GetRank() + 1 == GetRanks())
  {
    const vtkIdType triangle[3] = { 0, 1, 2 };
    piece->InsertNextCell(VTK_TRIANGLE, 3, triangle);
  }
  Parallel parallel(from);
  parallel.Filter->SetDeformationData(piece);
  parallel.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
  EXPECT_TRUE(HasPart(parallel.Observer->GetWarningMessage(), "1 triangle"));
  EXPECT_EQ(parallel.TakeErrors(), 0);
}

void TestErrors(const Case& from, vtkImageData* whole)
{
  const auto mesh = vtkUnstructuredGrid::SafeDownCast(from.Deformation);
  const auto pieces = Distribute(mesh, Spread::Pieces);
  const auto useMesh = [&](Parallel& parallel)
  { parallel.Filter->SetDeformationData(Distribute(mesh, Spread::Pieces)); };

  TestError(
    from, whole, "has no ",
    [&](Parallel& parallel)
    {
      auto bare = vtkSmartPointer<vtkUnstructuredGrid>::New();
      bare->CopyStructure(pieces);
      parallel.Filter->SetDeformationData(bare);
    },
    useMesh);
  TestError(
    from, whole, "not finite",
    [&](Parallel& parallel)
    {
      auto broken = vtkSmartPointer<vtkUnstructuredGrid>::New();
      broken->DeepCopy(pieces);
      broken->GetPoints()->SetPoint(0, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0);
      parallel.Filter->SetDeformationData(broken);
    },
    useMesh);
  TestError(
    from, whole, "no such device",
    [](Parallel& parallel) { parallel.Filter->SetDevice("no such device"); },
    [](Parallel& parallel)
    {
      parallel.Filter->SetDevice("");
      parallel.Filter->Modified(); // on all ranks
    });
  if (GetRanks() > 1) // a single process uses what its source announces
  {
    TestError(
      from, whole, "was asked for",
      [](Parallel& parallel) { parallel.Source->GivesOtherParts = true; },
      [](Parallel& parallel)
      {
        parallel.Source->GivesOtherParts = false;
        parallel.Source->Modified();
      });
  }
  {
    // No rank has a part of the mesh.
    Parallel parallel(from);
    parallel.Filter->SetDeformationData(vtkSmartPointer<vtkUnstructuredGrid>::New());
    parallel.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
    EXPECT_EQ(parallel.TakeErrors(), 1);
    EXPECT_TRUE(HasPart(parallel.LastError, "has no points"));
  }
}

/// Tests more ranks than voxels on an axis, and a mesh that moves.
void TestSmallAndMoving(const Case& from)
{
  Case small = from;
  small.Set = [](vtkDeformVolumeFilter* filter)
  {
    filter->SetOutputBoundsModeToCustomBounds();
    filter->SetCustomBounds(10.0, 12.0, 8.0, 8.0, 3.0, 4.0);
  };
  Parallel parallel(small);
  parallel.Filter->SetDeformationData(
    Distribute(vtkUnstructuredGrid::SafeDownCast(from.Deformation), Spread::Pieces));
  Check(parallel, MakeWhole(small), "Small output");

  Parallel moving(from);
  for (const double amount : { 0.4, 1.2, 0.4, 1.2, 0.7 })
  {
    Case step = from;
    auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
    mesh->ShallowCopy(from.Deformation);
    SetDisplacements(mesh, Bend(from.Volume, amount));
    step.Deformation = mesh;
    moving.Filter->SetDeformationData(Distribute(mesh, Spread::Pieces));
    Check(moving, MakeWhole(step), "Moving mesh");
  }
  // The part of the volume that was needed before is kept.
  EXPECT_LE(moving.Source->Made.size(), 2);
  EXPECT_LE(GetReported(moving.Filter, "Static mappings made"), 2);
  EXPECT_LE(GetReported(moving.Filter, "Volumes sent"), 2);
}

/// Tests that all ranks keep the same extent (BoundsGranularity).
void TestKeptExtent(const Case& from)
{
  Case kept = from;
  kept.Set = [&](vtkDeformVolumeFilter* filter)
  {
    from.Set(filter);
    filter->SetBoundsGranularity(8);
  };
  Parallel moving(kept);
  Deformed whole(kept.Volume, kept.Deformation);
  kept.Set(whole.Filter);
  for (const double amount : { 0.4, 1.2, 0.4, 0.7 })
  {
    auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
    mesh->ShallowCopy(from.Deformation);
    SetDisplacements(mesh, Bend(from.Volume, amount));
    moving.Filter->SetDeformationData(Distribute(mesh, Spread::Pieces));
    const auto image = MakeOnFirstRank(
      [&]
      {
        whole.Filter->SetDeformationData(mesh);
        return whole.Update();
      });
    Check(moving, image, "Kept extent");
  }
}

/// Tests that a setting or a connection of vtkDeformGeometryFilter on the last rank that differs is
/// an error on all ranks.
void TestGeometrySettings(vtkUnstructuredGrid* mesh)
{
  const bool isLast = GetRank() + 1 == GetRanks();
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(mesh->GetCenter());
  vtkNew<vtkPolyData> input;
  input->SetPoints(points);
  vtkNew<vtkDeformGeometryFilter> filter;
  vtkNew<vtkTest::ErrorObserver> observer;
  filter->AddObserver(vtkCommand::ErrorEvent, observer);
  filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
  filter->SetInputData(input);
  const auto update = [&]
  {
    observer->Clear();
    filter->Modified(); // on all ranks
    filter->UpdatePiece(GetRank(), GetRanks(), 0);
    return observer->GetErrorMessage();
  };
  filter->SetDeformationData(isLast ? nullptr : mesh);
  EXPECT_TRUE(HasPart(update(), "deformation on input port 1 is connected on some ranks only"));
  filter->SetDeformationData(mesh);
  filter->SetInverse(isLast);
  EXPECT_TRUE(HasPart(update(), "Inverse is not the same on all ranks"));
  filter->SetInverse(false);
  EXPECT_EQ(update(), "");
}

/// Tests vtkDeformGeometryFilter: each rank moves its own points as one process does, whichever
/// rank has the mesh.
void TestGeometryFilter(vtkUnstructuredGrid* mesh)
{
  vtkNew<vtkMultiBlockDataSet> blocks;
  for (int block = 0; block <= GetRank(); ++block) // different numbers
  {
    vtkNew<vtkPoints> points;
    for (int i = 0; i < 100; ++i)
    {
      points->InsertNextPoint(0.1 * i, 0.07 * i + block, 0.06 * i + 0.5 * GetRank());
    }
    vtkNew<vtkPolyData> some;
    some->SetPoints(points);
    blocks->SetBlock(block, some);
  }
  vtkNew<vtkTest::ErrorObserver> observer; // keeps warnings about points outside
  const auto move = [&](vtkDeformGeometryFilter* filter, bool inverse)
  {
    filter->AddObserver(vtkCommand::ErrorEvent, observer);
    filter->AddObserver(vtkCommand::WarningEvent, observer);
    filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
    filter->SetInputData(blocks);
    filter->SetInverse(inverse);
  };
  const auto getBlock = [](vtkDeformGeometryFilter* filter, int block)
  {
    auto* output = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
    return vtkPointSet::SafeDownCast(output->GetBlock(block));
  };
  for (const bool inverse : { false, true })
  {
    vtkMultiProcessController::SetGlobalController(nullptr);
    vtkNew<vtkDeformGeometryFilter> alone;
    move(alone, inverse);
    alone->SetDeformationData(mesh);
    alone->Update();
    vtkMultiProcessController::SetGlobalController(Controller);
    EXPECT_LT(alone->GetNumberOfOutsidePoints(), 60 * (GetRank() + 1));
    for (const Spread spread :
      { Spread::Everywhere, Spread::OnOne, Spread::Pieces, Spread::WithGhosts })
    {
      vtkNew<vtkDeformGeometryFilter> filter;
      move(filter, inverse);
      filter->SetDeformationData(Distribute(mesh, spread));
      filter->UpdatePiece(GetRank(), GetRanks(), 0);
      EXPECT_EQ(filter->GetNumberOfOutsidePoints(), alone->GetNumberOfOutsidePoints());
      for (int block = 0; block <= GetRank(); ++block)
      {
        vtkPointSet* output = getBlock(filter, block);
        EXPECT_NE(output, nullptr);
        for (vtkIdType id = 0; output && id < output->GetNumberOfPoints(); ++id)
        {
          // In a mesh that is divided into pieces, tetrahedra have other ids. So points on a face
          // may follow the tetrahedron on its other side.
          const glm::dvec3 miss = GetPoint(output, id) - GetPoint(getBlock(alone, block), id);
          EXPECT_LT(std::abs(miss.x) + std::abs(miss.y) + std::abs(miss.z), 1e-5);
        }
      }
      // Invalid points of one rank, or of its piece of the mesh, are an error on all ranks.
      observer->Clear();
      const double nan = std::numeric_limits<double>::quiet_NaN();
      auto* first = vtkPointSet::SafeDownCast(blocks->GetBlock(0));
      const glm::dvec3 before = GetPoint(first, 5);
      if (GetRank() + 1 == GetRanks())
      {
        first->GetPoints()->SetPoint(5, nan, 0.0, 0.0);
        first->GetPoints()->Modified();
      }
      filter->Modified();
      filter->UpdatePiece(GetRank(), GetRanks(), 0);
      EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "Point 5"));
      observer->Clear();
      first->GetPoints()->SetPoint(5, &before.x);
      first->GetPoints()->Modified();
      filter->UpdatePiece(GetRank(), GetRanks(), 0);
      EXPECT_FALSE(observer->GetError());
      EXPECT_EQ(filter->GetNumberOfOutsidePoints(), alone->GetNumberOfOutsidePoints());
    }
  }
}

/// Returns the part of rank `rank` of a curved lattice of hexahedra over the bounds of a volume.
/// Each part has all points, in an order of its own.
vtkSmartPointer<vtkUnstructuredGrid> MakeHexahedra(vtkImageData* volume, int rank)
{
  constexpr vtkIdType n = 6; // nodes on each axis
  constexpr vtkIdType count = n * n * n;
  constexpr vtkIdType factors[] = { 5, 7, 11, 13 }; // without common divisors with count
  const auto number = [&](vtkIdType id) { return factors[rank % 4] * id % count; };
  double bounds[6];
  volume->GetBounds(bounds);
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(count);
  mesh->SetPoints(points);
  std::vector<vtkIdType> cells; // the first node of each cell
  for (vtkIdType id = 0; id < count; ++id)
  {
    const glm::dvec3 at(id % n, id / n % n, id / (n * n));
    const double wave = 0.25 * std::sin(2.5 * at.x) * std::cos(1.9 * at.y);
    const glm::dvec3 part = (at + glm::dvec3(0.0, 0.0, wave)) / (n - 1.0);
    points->SetPoint(number(id), bounds[0] + part.x * (bounds[1] - bounds[0]),
      bounds[2] + part.y * (bounds[3] - bounds[2]), bounds[4] + part.z * (bounds[5] - bounds[4]));
    if (id % n + 1 < n && id / n % n + 1 < n && id / (n * n) + 1 < n)
    {
      cells.push_back(id);
    }
  }
  const std::size_t end = cells.size() * (rank + 1) / GetRanks();
  for (std::size_t cell = cells.size() * rank / GetRanks(); cell < end; ++cell)
  {
    vtkIdType ids[8];
    for (int i = 0; i < 8; ++i)
    {
      const int x = i % 4 == 1 || i % 4 == 2 ? 1 : 0;
      ids[i] = number(cells[cell] + x + (i % 4 / 2) * n + (i / 4) * n * n);
    }
    mesh->InsertNextCell(VTK_HEXAHEDRON, 8, ids);
  }
  SetDisplacements(mesh, Bend(volume));
  return mesh;
}

/// Hexahedra of several ranks split a common face alike, as those of blocks in one process do.
void TestHexahedra(const Case& from)
{
  Case blocks = from;
  blocks.Name = "Hexahedra";
  vtkNew<vtkMultiBlockDataSet> all;
  for (int rank = 0; rank < GetRanks(); ++rank)
  {
    all->SetBlock(rank, MakeHexahedra(from.Volume, rank));
  }
  blocks.Set = [&](vtkDeformVolumeFilter* filter)
  {
    from.Set(filter);
    filter->SetDeformationData(all.Get());
  };
  const auto whole = MakeWhole(blocks);
  Parallel parallel(blocks);
  parallel.Filter->SetDeformationData(MakeHexahedra(from.Volume, GetRank()));
  Check(parallel, whole, blocks.Name);
}

void TestAll()
{
  for (const Case& from : MakeCases())
  {
    const auto whole = MakeWhole(from);
    Parallel parallel(from);
    Check(parallel, whole, from.Name);
    if (from.Name == "Runs, mirrored reference")
    {
      Parallel ghosts(from);
      Check(ghosts, whole, "Ghost levels, mirrored reference", 2);
      TestSpread(from, whole);
      TestReferenceErrors(from, whole);
      TestNothingCovered(from);
    }
    if (from.Name == "Runs")
    {
      Parallel ghosts(from);
      Check(ghosts, whole, "Ghost levels", 2);
      Parallel noParts(from, false);
      Check(noParts, whole, "Source without parts");
      TestSpread(from, whole);
      TestErrors(from, whole);
      TestIgnoredCell(from);
      if (GetRanks() > 1)
      {
        TestSettings(from, whole);
        TestGeometrySettings(vtkUnstructuredGrid::SafeDownCast(from.Deformation));
        TestVolumeErrors(from, whole);
      }
      TestSmallAndMoving(from);
      TestKeptExtent(from);
      TestGeometryFilter(vtkUnstructuredGrid::SafeDownCast(from.Deformation));
      TestHexahedra(from);
      TestSplits(from);
      // Cells with derived nodes.
      Case quadratic = from;
      const auto mesh = MakeTenNodes(vtkUnstructuredGrid::SafeDownCast(from.Deformation));
      SetDisplacements(mesh, Bend(from.Volume));
      quadratic.Name = "Ten nodes";
      quadratic.Deformation = mesh;
      TestSpread(quadratic, MakeWhole(quadratic));
    }
  }
}

/// Tests the start with an empty kernel cache: all ranks need the same kernels at the same time.
/// Then checks that each rank uses its share of the processors.
void TestColdStart()
{
  const Case from = MakeCases()[2];
  Parallel parallel(from);
  if (GetRank() == 0)
  {
    // Request the devices on the first rank before the other ranks do, as a user interface does.
    vtkSmartPointer<vtkStringArray>::Take(vtkDeformVolumeFilter::GetDeviceNames());
    EXPECT_NE(std::getenv("POCL_MAX_PTHREAD_COUNT"), nullptr);
  }
  parallel.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
  EXPECT_EQ(parallel.TakeErrors(), 0);
  Check(parallel, MakeWhole(from), "Cold start");
  const char* share = std::getenv("POCL_MAX_PTHREAD_COUNT");
  const int processors = static_cast<int>(std::thread::hardware_concurrency());
  EXPECT_TRUE(share && std::atoi(share) == std::max(1, processors / GetRanks()));
}

} // namespace

int main(int argc, char* argv[])
{
  const bool cold = argc == 2 && std::string(argv[1]) == "cold";
  return RunOnRanks(argc, argv, cold ? TestColdStart : TestAll);
}
