// SPDX-License-Identifier: BSD-3-Clause
// A mesh that is refined and coarsened while the filter lives: tetrahedra that become four, edges
// that are split, tetrahedra that are removed or added, all of which may be undone, along with
// nodes that are split or move, and masks. Each time the output is compared bit by bit with that of
// a fresh filter. The static mapping is built once, as long as nodes stay where they lie at rest.
#include "FilterTesting.h"
#include "TimeAllowance.h"
#include "UpdateChecks.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <string>
#include <vector>

using namespace filterTesting;

namespace
{

using Nodes = std::array<vtkIdType, 4>;

struct MeshState
{
  std::vector<glm::dvec3> Points;
  std::vector<glm::dvec3> Displacements;
  std::vector<Nodes> Tetrahedra;
  bool IsTorn = false; // tetrahedra are missing, or there is one too many

  vtkIdType AddNode(const std::vector<vtkIdType>& between, const glm::dvec3& move)
  {
    glm::dvec3 point(0.0);
    glm::dvec3 moved = move;
    for (const vtkIdType node : between)
    {
      point += this->Points[node] / static_cast<double>(between.size());
      moved += this->Displacements[node] / static_cast<double>(between.size());
    }
    this->Points.push_back(point);
    this->Displacements.push_back(moved);
    return static_cast<vtkIdType>(this->Points.size()) - 1;
  }
};

MeshState ReadState(vtkUnstructuredGrid* mesh)
{
  MeshState state;
  for (vtkIdType node = 0; node < mesh->GetNumberOfPoints(); ++node)
  {
    state.Points.push_back(GetPoint(mesh, node));
    state.Displacements.emplace_back(0.25, 0.0, 0.0);
  }
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    vtkIdType size;
    const vtkIdType* points;
    mesh->GetCells()->GetCellAtId(cell, size, points);
    state.Tetrahedra.push_back({ { points[0], points[1], points[2], points[3] } });
  }
  return state;
}

vtkSmartPointer<vtkUnstructuredGrid> MakeGrid(const MeshState& state)
{
  auto grid = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkFloatArray> vectors;
  vectors->SetName("displacement");
  vectors->SetNumberOfComponents(3);
  for (std::size_t node = 0; node < state.Points.size(); ++node)
  {
    points->InsertNextPoint(&state.Points[node].x);
    vectors->InsertNextTuple(&state.Displacements[node].x);
  }
  grid->SetPoints(points);
  grid->GetPointData()->SetVectors(vectors);
  vtkNew<vtkCellArray> cells;
  for (const Nodes& nodes : state.Tetrahedra)
  {
    cells->InsertNextCell(4, nodes.data());
  }
  grid->SetCells(VTK_TETRA, cells);
  return grid;
}

enum class Configurations
{
  One,
  Two
};

class Refinement
{
public:
  Refinement(const glm::dvec3& spacing, bool isOblique, int nodes, Configurations given,
    bool openSplits, unsigned int seed)
    : Random(seed)
    , Given(given)
    , Volume(MakeImage({ { -3, 61, 0, 52, 2, 50 } }, spacing, glm::dvec3(-4.0, 7.0, 30.0)))
  {
    if (isOblique)
    {
      SetObliqueDirection(this->Volume);
    }
    AddScalars<short>(this->Volume, "value",
      [](const glm::dvec3& p) { return 100.0 * std::sin(0.7 * p.x) + 35.0 * p.z + p.y; });
    this->State = ReadState(MakeMesh(this->Volume, nodes, 1.0));
    this->Snapshots.push_back(this->State);
    this->Tested.Filter->SetResamplerToExact();
    this->Tested.Filter->SetOpenSplits(openSplits);
  }

  void Run(int edits)
  {
    this->Compare("no edit");
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), 1);
    for (int edit = 0; edit < edits; ++edit)
    {
      const bool wasTorn = this->State.IsTorn;
      const std::string what = this->Apply();
      this->Torn += wasTorn || this->State.IsTorn ? 1 : 0;
      if (!this->Compare("edit " + std::to_string(edit) + ", " + what))
      {
        return;
      }
    }
    // An undo may bring back much at once, of more than half of the tiles. The boundary of a mesh
    // with holes is found for the whole mesh.
    const vtkIdType builds = this->Tested.Filter->GetNumberOfMappingBuilds();
    std::cout << builds << " mappings were built in " << edits << " edits, and " << this->Parts
              << " outputs made in part\n";
    VERIFY(builds < 2 + edits / 12 + this->Torn);
    VERIFY(this->Parts > edits / 4);
    this->State = this->Snapshots.front();
    this->ChangeAll(builds);
  }

private:
  std::size_t Pick(std::size_t count) { return static_cast<std::size_t>(this->Random()) % count; }

  glm::dvec3 PickMove(double most)
  {
    std::uniform_real_distribution<double> move(-most, most);
    return glm::dvec3(move(this->Random), move(this->Random), move(this->Random));
  }

  std::size_t PickTetrahedron() { return this->Pick(this->State.Tetrahedra.size()); }

  std::string Refine()
  {
    std::vector<Nodes>& all = this->State.Tetrahedra;
    const std::size_t parent = this->PickTetrahedron();
    const Nodes nodes = all[parent];
    const vtkIdType center =
      this->State.AddNode({ nodes.begin(), nodes.end() }, this->PickMove(0.2));
    const bool isInserted = this->Pick(2) == 0;
    for (int k = 0; k < 4; ++k)
    {
      Nodes child = nodes;
      child[k] = center;
      if (k == 0)
      {
        all[parent] = child;
      }
      else
      {
        all.insert(
          isInserted ? all.begin() + static_cast<std::ptrdiff_t>(parent) : all.end(), child);
      }
    }
    return isInserted ? "four in the place of one" : "one that became four";
  }

  std::string SplitEdge()
  {
    std::vector<Nodes>& all = this->State.Tetrahedra;
    const Nodes one = all[this->PickTetrahedron()];
    const vtkIdType a = one[this->Pick(2)];
    const vtkIdType b = one[2 + this->Pick(2)];
    const vtkIdType middle = this->State.AddNode({ a, b }, this->PickMove(0.2));
    const std::size_t count = all.size();
    for (std::size_t t = 0; t < count; ++t)
    {
      const Nodes nodes = all[t];
      if (std::count(nodes.begin(), nodes.end(), a) && std::count(nodes.begin(), nodes.end(), b))
      {
        std::replace(all[t].begin(), all[t].end(), a, middle);
        all.push_back(nodes);
        std::replace(all.back().begin(), all.back().end(), b, middle);
      }
    }
    return "an edge that is split";
  }

  std::string Remove()
  {
    this->State.IsTorn = true;
    std::vector<Nodes>& all = this->State.Tetrahedra;
    const auto first = static_cast<std::ptrdiff_t>(this->Pick(all.size() - 5));
    const auto count = static_cast<std::ptrdiff_t>(1 + this->Pick(4));
    if (this->Pick(3) == 0)
    {
      all[first] = all.back();
      all.pop_back();
      return "the last in the place of one that is removed";
    }
    all.erase(all.begin() + first, all.begin() + first + count);
    return "some that are removed";
  }

  std::string Add()
  {
    this->State.IsTorn = true;
    std::vector<Nodes>& all = this->State.Tetrahedra;
    Nodes nodes = all[this->PickTetrahedron()];
    if (this->Pick(2))
    {
      nodes[this->Pick(4)] = this->State.AddNode({ nodes[0], nodes[1] }, this->PickMove(0.2));
    }
    all.insert(this->Pick(2) ? all.end()
                             : all.begin() + static_cast<std::ptrdiff_t>(this->PickTetrahedron()),
      nodes);
    return "one that is added";
  }

  // Some tetrahedra near one another get nodes of their own.
  std::string SplitNodes()
  {
    const std::size_t first = this->PickTetrahedron();
    const std::size_t end = std::min(first + 6, this->State.Tetrahedra.size());
    std::map<vtkIdType, vtkIdType> twins;
    for (std::size_t t = first; t < end; ++t)
    {
      for (vtkIdType& node : this->State.Tetrahedra[t])
      {
        if (!twins.count(node))
        {
          twins[node] = this->State.AddNode({ node }, this->PickMove(0.2));
        }
        node = twins[node];
      }
    }
    return "nodes that are split";
  }

  std::string Undo()
  {
    this->Snapshots.resize(1 + this->Pick(this->Snapshots.size()));
    this->State = this->Snapshots.back();
    return "the mesh that was";
  }

  std::string Move()
  {
    this->State.Displacements[this->Pick(this->State.Displacements.size())] = this->PickMove(0.6);
    return "a node that moves";
  }

  std::string SetMask()
  {
    auto* mask =
      vtkUnsignedCharArray::SafeDownCast(this->Volume->GetCellData()->GetArray("ActiveTetrahedra"));
    if (!mask)
    {
      vtkNew<vtkUnsignedCharArray> made;
      made->SetName("ActiveTetrahedra");
      made->SetNumberOfTuples(this->Volume->GetNumberOfCells());
      made->Fill(31);
      this->Volume->GetCellData()->AddArray(made);
      mask = made;
    }
    mask->SetValue(static_cast<vtkIdType>(this->Pick(mask->GetNumberOfValues())),
      static_cast<unsigned char>(this->Pick(32)));
    mask->Modified();
    return "a mask";
  }

  std::string Apply()
  {
    switch (this->Pick(14))
    {
      case 0:
      case 1:
      case 2:
        return this->Refine();
      case 3:
        this->Snapshots.push_back(this->State);
        return this->Refine();
      case 4:
      case 5:
        return this->SplitEdge();
      case 6:
      case 7:
        return this->Remove();
      case 8:
        return this->Add();
      case 9:
        return this->Undo();
      case 10:
        return this->SplitNodes();
      case 11:
        return this->Move();
      case 12:
        return this->SetMask();
      default:
      {
        std::string what = this->Refine();
        what += ", " + this->Move();
        what += ", " + this->SetMask();
        return what + ", " + this->SplitNodes();
      }
    }
  }

  void Connect(vtkDeformVolumeFilter* filter, vtkUnstructuredGrid* mesh)
  {
    filter->SetInputData(this->Volume);
    if (this->Given == Configurations::One)
    {
      filter->SetInputDataObject(1, mesh);
      return;
    }
    MeshState moved = this->State;
    for (std::size_t node = 0; node < moved.Points.size(); ++node)
    {
      moved.Points[node] += moved.Displacements[node];
    }
    filter->SetInputDataObject(1, MakeGrid(moved));
    filter->SetInputDataObject(2, mesh);
  }

  bool Compare(const std::string& what)
  {
    const auto mesh = MakeGrid(this->State);
    Deformed fresh;
    fresh.Filter->SetResamplerToExact();
    fresh.Filter->SetOpenSplits(this->Tested.Filter->GetOpenSplits());
    this->Connect(fresh.Filter, mesh);
    this->Connect(this->Tested.Filter, mesh);
    return CompareWithFresh(this->Tested, fresh, what, this->Parts);
  }

  // What is more than a replacement: all is made anew. Errors leave nothing behind.
  void ChangeAll(vtkIdType builds)
  {
    this->State.Points[40].y += 0.5;
    this->Compare("a node elsewhere at rest");
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds + 1);
    std::reverse(this->State.Tetrahedra.begin(), this->State.Tetrahedra.end());
    this->Compare("another order");
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds + 2);
    this->Refine();
    const Nodes good = this->State.Tetrahedra.back();
    this->State.Tetrahedra.back()[1] = static_cast<vtkIdType>(this->State.Points.size());
    this->Connect(this->Tested.Filter, MakeGrid(this->State));
    this->Tested.Filter->Update();
    VERIFY_EQUAL(this->Tested.TakeErrors(), 1);
    this->State.Tetrahedra.back() = good;
    this->Compare("an error that is mended");
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds + 2);
    // The device has lost what it had.
    this->Tested.Filter->ReleaseDeviceMemory();
    this->Refine();
    this->Compare("memory that is released");
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds + 3);
    this->Refine();
    this->Compare("one more");
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds + 3);
    // Extrapolation needs to see all voxels.
    this->Tested.Filter->SetOutsideModeToExtrapolate();
    this->Tested.Update();
    this->Refine();
    this->Connect(this->Tested.Filter, MakeGrid(this->State));
    this->Tested.Update();
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds + 5);
  }

  std::mt19937 Random;
  Configurations Given;
  vtkSmartPointer<vtkImageData> Volume;
  MeshState State;
  std::vector<MeshState> Snapshots;
  Deformed Tested;
  int Parts = 0;
  int Torn = 0; // edits before or after which the mesh is torn
};

} // namespace

int TestDeformRefinement(int, char*[])
{
  const glm::dvec3 uneven(1.0, 0.9, 1.25);
  // Runs, in cells of some voxels, and links, in smaller ones.
  Refinement(uneven, false, 9, Configurations::One, false, 1).Run(GetNumberOfCases(100));
  Refinement(uneven, true, 25, Configurations::One, false, 2).Run(GetNumberOfCases(60));
  Refinement(uneven, true, 9, Configurations::Two, false, 3).Run(GetNumberOfCases(40));
  Refinement(glm::dvec3(1.0), false, 9, Configurations::One, true, 4).Run(GetNumberOfCases(60));
  return GetExitCode();
}
