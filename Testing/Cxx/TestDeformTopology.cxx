// SPDX-License-Identifier: BSD-3-Clause
// A mesh whose tetrahedra get other nodes while the filter lives: 200 random edits (nodes that are
// split, splits that are undone, moves, masks), each compared bit by bit with a fresh filter. The
// static mapping is built once, as long as no node moves at rest.
#include "FilterTesting.h"
#include "TimeAllowance.h"
#include "UpdateChecks.h"

#include <vtkArrayChanges.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkIdList.h>
#include <vtkUnsignedCharArray.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <string>
#include <vector>

using namespace filterTesting;

namespace
{

// How the deformation is given.
enum class Form
{
  Displacements,
  TwoConfigurations
};

class Topology
{
public:
  // logged: whether logs tell what is written (vtkArrayChanges), in place of comparisons.
  Topology(Form form, bool openSplits, bool logged)
    : Given(form)
    , Logged(logged)
    , Volume(MakeImage({ { -3, 61, 0, 44, 2, 40 } }, glm::dvec3(1.0, 1.0, 1.25)))
    , Mesh(MakeMesh(Volume, 12, 1.0))
    , Tested(Volume, Mesh)
  {
    AddScalars<short>(this->Volume, "value",
      [](const glm::dvec3& p) { return 100.0 * std::sin(0.7 * p.x) + 35.0 * p.z + p.y; });
    SetDisplacements(this->Mesh, Shift(0.25, 0.0, 0.0));
    this->Tested.Filter->SetResamplerToExact();
    this->Tested.Filter->SetOpenSplits(openSplits);
    this->Snapshots.push_back(this->Copy());
  }

  void Run(int edits)
  {
    this->Compare("no edit");
    const vtkIdType builds = this->Tested.Filter->GetNumberOfMappingBuilds();
    for (int edit = 0; edit < edits; ++edit)
    {
      const std::string what = this->Apply();
      if (!this->Compare("edit " + std::to_string(edit) + ", " + what))
      {
        return;
      }
    }
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds);
    VERIFY(this->Mesh->GetNumberOfPoints() > 0);
    std::cout << this->Parts << " of " << edits << " edits were made in part, of " << this->Splits
              << " splits\n";
    VERIFY(this->Splits > edits / 8);
    VERIFY(this->Parts > edits / 8);
    this->ChangeShapes(builds);
  }

private:
  std::size_t Pick(std::size_t count) { return static_cast<std::size_t>(this->Random()) % count; }

  vtkDataArray* GetVectors() { return this->Mesh->GetPointData()->GetVectors(); }

  std::array<vtkIdType, 4> GetNodes(vtkIdType cell)
  {
    vtkNew<vtkIdList> ids;
    this->Mesh->GetCellPoints(cell, ids);
    return { { ids->GetId(0), ids->GetId(1), ids->GetId(2), ids->GetId(3) } };
  }

  void SetNodes(vtkIdType cell, const std::array<vtkIdType, 4>& nodes)
  {
    this->Mesh->GetCells()->ReplaceCellAtId(cell, 4, nodes.data());
    this->Log(this->Mesh->GetCells()->GetConnectivityArray(), 4 * cell, 4 * cell + 3);
  }

  // Some tuples of an array have been written.
  void Log(vtkDataArray* array, vtkIdType first, vtkIdType last)
  {
    if (!this->Logged)
    {
      return;
    }
    if (!vtkArrayChanges::FindLog(array))
    {
      vtkNew<vtkArrayChanges> log;
      log->SetArray(array);
    }
    vtkArrayChanges::FindLog(array)->AddTuples(first, last);
  }

  void Tell()
  {
    this->Mesh->GetCells()->Modified();
    this->Mesh->GetPoints()->Modified();
    if (!this->Logged)
    {
      this->GetVectors()->Modified();
    }
    this->Mesh->Modified();
  }

  vtkSmartPointer<vtkUnstructuredGrid> Copy()
  {
    auto copy = vtkSmartPointer<vtkUnstructuredGrid>::New();
    copy->DeepCopy(this->Mesh);
    return copy;
  }

  // Gives the tetrahedra near a node on one side of a plane through it nodes of their own.
  std::string Split()
  {
    const glm::dvec3 center =
      GetPoint(this->Mesh, static_cast<vtkIdType>(this->Pick(this->Mesh->GetNumberOfPoints())));
    const double reach = 3.0 + static_cast<double>(this->Pick(20));
    std::uniform_real_distribution<double> direction(-1.0, 1.0);
    const glm::dvec3 normal(
      direction(this->Random), direction(this->Random), direction(this->Random));
    std::map<vtkIdType, vtkIdType> twins;
    for (vtkIdType cell = 0; cell < this->Mesh->GetNumberOfCells(); ++cell)
    {
      std::array<vtkIdType, 4> nodes = this->GetNodes(cell);
      glm::dvec3 middle(0.0);
      for (const vtkIdType node : nodes)
      {
        middle += 0.25 * GetPoint(this->Mesh, node);
      }
      if (glm::dot(middle - center, normal) <= 0.0)
      {
        continue;
      }
      bool changed = false;
      for (vtkIdType& node : nodes)
      {
        if (glm::distance(GetPoint(this->Mesh, node), center) <= reach)
        {
          node = this->GetTwin(node, twins);
          changed = true;
        }
      }
      if (changed)
      {
        this->SetNodes(cell, nodes);
      }
    }
    this->Splits += twins.empty() ? 0 : 1;
    this->Tell();
    return "a split of " + std::to_string(twins.size()) + " nodes";
  }

  vtkIdType GetTwin(vtkIdType node, std::map<vtkIdType, vtkIdType>& twins)
  {
    const auto inserted = twins.emplace(node, 0);
    if (inserted.second)
    {
      std::uniform_real_distribution<double> move(-0.3, 0.3);
      double point[3];
      this->Mesh->GetPoints()->GetPoint(node, point);
      inserted.first->second = this->Mesh->GetPoints()->InsertNextPoint(point);
      double vector[3];
      this->GetVectors()->GetTuple(node, vector);
      for (double& component : vector)
      {
        component += move(this->Random);
      }
      this->GetVectors()->InsertNextTuple(vector);
    }
    return inserted.first->second;
  }

  // The mesh of an earlier time, in the same grid.
  std::string Undo()
  {
    const std::size_t to = this->Pick(this->Snapshots.size());
    this->Snapshots.resize(to + 1);
    this->Mesh->DeepCopy(this->Snapshots.back());
    return "the mesh that was";
  }

  std::string Move()
  {
    const glm::dvec3 center =
      GetPoint(this->Mesh, static_cast<vtkIdType>(this->Pick(this->Mesh->GetNumberOfPoints())));
    const double reach = static_cast<double>(this->Pick(14));
    std::uniform_real_distribution<double> move(-0.6, 0.6);
    for (vtkIdType node = 0; node < this->Mesh->GetNumberOfPoints(); ++node)
    {
      if (glm::distance(GetPoint(this->Mesh, node), center) <= reach)
      {
        this->GetVectors()->SetTuple3(
          node, move(this->Random), move(this->Random), move(this->Random));
        this->Log(this->GetVectors(), node, node);
      }
    }
    if (!this->Logged)
    {
      this->GetVectors()->Modified();
    }
    return "nodes that move";
  }

  // A node takes the place of another in some tetrahedra, as where a split is closed again.
  std::string Join()
  {
    std::map<std::array<double, 3>, vtkIdType> first;
    std::vector<vtkIdType> to(static_cast<std::size_t>(this->Mesh->GetNumberOfPoints()));
    for (vtkIdType node = 0; node < this->Mesh->GetNumberOfPoints(); ++node)
    {
      std::array<double, 3> point;
      this->Mesh->GetPoint(node, point.data());
      to[node] = first.emplace(point, node).first->second;
    }
    for (vtkIdType cell = 0; cell < this->Mesh->GetNumberOfCells(); ++cell)
    {
      std::array<vtkIdType, 4> nodes = this->GetNodes(cell);
      const std::array<vtkIdType, 4> before = nodes;
      std::transform(
        nodes.begin(), nodes.end(), nodes.begin(), [&](vtkIdType node) { return to[node]; });
      if (nodes != before && this->Pick(2) == 0)
      {
        this->SetNodes(cell, nodes);
      }
    }
    this->Tell();
    return "nodes that are joined";
  }

  std::string SetMasks()
  {
    const auto change = [&](vtkDataSetAttributes* attributes, const char* name, vtkIdType size,
                          unsigned char usual, unsigned char other)
    {
      vtkSmartPointer<vtkUnsignedCharArray> mask =
        vtkUnsignedCharArray::SafeDownCast(attributes->GetArray(name));
      if (!mask)
      {
        mask = vtkSmartPointer<vtkUnsignedCharArray>::New();
        mask->SetName(name);
        mask->SetNumberOfTuples(size);
        mask->Fill(usual);
        attributes->AddArray(mask);
      }
      const auto begin = static_cast<vtkIdType>(this->Pick(size));
      const vtkIdType end = std::min<vtkIdType>(begin + this->Pick(100), size);
      for (vtkIdType i = begin; i < end; ++i)
      {
        mask->SetValue(i, mask->GetValue(i) == usual ? other : usual);
      }
      if (!this->Logged)
      {
        mask->Modified();
      }
      this->Log(mask, begin, end - 1);
    };
    change(this->Volume->GetCellData(), "ActiveTetrahedra", this->Volume->GetNumberOfCells(), 31,
      static_cast<unsigned char>(this->Pick(31)));
    if (this->Pick(2) == 0)
    {
      change(this->Volume->GetPointData(), vtkDataSetAttributes::GhostArrayName(),
        this->Volume->GetNumberOfPoints(), 0, vtkDataSetAttributes::HIDDENPOINT);
    }
    return "masks";
  }

  std::string Apply()
  {
    switch (this->Pick(12))
    {
      case 0:
      case 1:
      case 2:
      case 3:
        return this->Split();
      case 4:
        return this->Undo();
      case 5:
        this->Snapshots.push_back(this->Copy());
        return this->Split();
      case 6:
        return this->Join();
      case 7:
      case 8:
        return this->SetMasks();
      case 9:
        // Another grid, with the same cells.
        this->Mesh = this->Copy();
        return "an equal copy";
      case 10:
      {
        const bool deformed =
          this->Tested.Filter->GetOutputBoundsMode() == vtkDeformVolumeFilter::DEFORMED_BOUNDS;
        this->Tested.Filter->SetOutputBoundsMode(
          deformed ? vtkDeformVolumeFilter::VOLUME_BOUNDS : vtkDeformVolumeFilter::DEFORMED_BOUNDS);
        return "other bounds";
      }
      default:
        return this->Move();
    }
  }

  void Connect(vtkDeformVolumeFilter* filter)
  {
    filter->SetInputData(this->Volume);
    if (this->Given == Form::Displacements)
    {
      filter->SetInputDataObject(1, this->Mesh);
      return;
    }
    const auto moved = this->Copy();
    for (vtkIdType node = 0; node < moved->GetNumberOfPoints(); ++node)
    {
      const double* vector = this->GetVectors()->GetTuple3(node);
      const glm::dvec3 point =
        GetPoint(this->Mesh, node) + glm::dvec3(vector[0], vector[1], vector[2]);
      moved->GetPoints()->SetPoint(node, point.x, point.y, point.z);
    }
    filter->SetInputDataObject(1, moved);
    filter->SetInputDataObject(2, this->Mesh);
  }

  bool Compare(const std::string& what)
  {
    Deformed fresh(this->Volume, this->Mesh);
    fresh.Filter->SetOutputBoundsMode(this->Tested.Filter->GetOutputBoundsMode());
    fresh.Filter->SetResamplerToExact();
    fresh.Filter->SetOpenSplits(this->Tested.Filter->GetOpenSplits());
    this->Connect(fresh.Filter);
    this->Connect(this->Tested.Filter);
    return CompareWithFresh(this->Tested, fresh, what, this->Parts);
  }

  // Where a tetrahedron becomes another one the mapping has to follow.
  void ChangeShapes(vtkIdType builds)
  {
    double point[3];
    this->Mesh->GetPoint(40, point);
    point[1] += 0.5;
    this->Mesh->GetPoints()->SetPoint(40, point);
    this->Log(this->Mesh->GetPoints()->GetData(), 40, 40);
    this->Tell();
    this->Compare("another rest position");
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds + 1);
    std::array<vtkIdType, 4> nodes = this->GetNodes(100);
    const std::array<vtkIdType, 4> others = this->GetNodes(300);
    nodes[2] = others[1];
    this->SetNodes(100, nodes);
    this->Tell();
    // That tetrahedron is another one, and leaves a hole.
    this->Compare("a node elsewhere");
    VERIFY_EQUAL(this->Tested.Filter->GetNumberOfMappingBuilds(), builds + 2);
    this->ChangeToErrors();
  }

  // Errors leave nothing behind.
  void ChangeToErrors()
  {
    const std::array<vtkIdType, 4> good = this->GetNodes(77);
    std::array<vtkIdType, 4> bad = good;
    bad[3] = this->Mesh->GetNumberOfPoints();
    this->SetNodes(77, bad);
    this->Tell();
    this->Tested.Filter->SetInputDataObject(1, this->Mesh);
    this->Tested.Filter->SetInputDataObject(2, nullptr);
    this->Tested.Filter->Update();
    VERIFY_EQUAL(this->Tested.TakeErrors(), 1);
    this->SetNodes(77, good);
    const vtkIdType last = this->Mesh->GetNumberOfPoints() - 1;
    double point[3];
    this->Mesh->GetPoint(last, point);
    this->Mesh->GetPoints()->SetPoint(last, std::nan(""), 0.0, 0.0);
    this->Log(this->Mesh->GetPoints()->GetData(), last, last);
    this->Split();
    this->Tested.Filter->Update();
    VERIFY_EQUAL(this->Tested.TakeErrors(), 1);
    this->Mesh->GetPoints()->SetPoint(last, point);
    this->Log(this->Mesh->GetPoints()->GetData(), last, last);
    this->Tell();
    this->Compare("errors that are mended");
    // Fewer points than cells use.
    const auto whole = this->Copy();
    vtkNew<vtkPoints> fewer;
    fewer->SetDataType(this->Mesh->GetPoints()->GetDataType());
    fewer->DeepCopy(this->Mesh->GetPoints());
    fewer->SetNumberOfPoints(this->Mesh->GetNumberOfPoints() - 1);
    this->Mesh->SetPoints(fewer);
    this->GetVectors()->SetNumberOfTuples(fewer->GetNumberOfPoints());
    this->Tell();
    this->Tested.Filter->SetInputDataObject(1, this->Mesh);
    this->Tested.Filter->SetInputDataObject(2, nullptr);
    this->Tested.Filter->Update();
    VERIFY_EQUAL(this->Tested.TakeErrors(), 1);
    this->Mesh = whole;
    this->Compare("points that are there again");
  }

  std::mt19937 Random{ 11 };
  Form Given;
  bool Logged;
  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  std::vector<vtkSmartPointer<vtkUnstructuredGrid>> Snapshots;
  Deformed Tested;
  int Parts = 0;
  int Splits = 0;
};

} // namespace

int TestDeformTopology(int, char*[])
{
  Topology(Form::Displacements, false, false).Run(GetNumberOfCases(200));
  Topology(Form::Displacements, true, false).Run(GetNumberOfCases(100));
  Topology(Form::TwoConfigurations, false, false).Run(GetNumberOfCases(60));
  Topology(Form::Displacements, false, true).Run(GetNumberOfCases(200));
  Topology(Form::TwoConfigurations, true, true).Run(GetNumberOfCases(60));
  return GetExitCode();
}
