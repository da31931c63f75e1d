// SPDX-License-Identifier: BSD-3-Clause
// 200 random edits with Incremental on, each compared bit by bit with a filter with Incremental
// off: nodes that move, masks, extents, spacings, arrays, backgrounds, aborts, outputs that others
// hold. What GetChangedExtent() leaves out is compared with the output before. Before that, what is
// read of displacements against filters that have read nothing before.
#include "FilterTesting.h"

#include <vtkCallbackCommand.h>
#include <vtkCellData.h>
#include <vtkImageShiftScale.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <random>
#include <vector>

using namespace filterTesting;

namespace
{

void AbortAtOnce(vtkObject* caller, unsigned long, void*, void*)
{
  static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1);
}

const Extent Nothing{ { 0, -1, 0, -1, 0, -1 } };

Extent GetChangedExtent(const Deformed& deformed)
{
  Extent extent;
  deformed.Filter->GetChangedExtent(extent.data());
  VERIFY(std::equal(extent.begin(), extent.end(), deformed.Filter->GetChangedExtent()));
  return extent;
}

class Edits
{
public:
  Edits()
    : Volume(MakeImage({ { -3, 90, 0, 60, 2, 50 } }, glm::dvec3(1.0, 1.0, 1.25)))
    , Mesh(MakeMesh(Volume, 14, 0.0))
    , Tested(Volume, Mesh)
    , Whole(Volume, Mesh)
  {
    AddScalars<short>(this->Volume, "labels",
      [](const glm::dvec3& p) { return std::floor(p.x / 7.0) + 3.0 * std::floor(p.y / 9.0); });
    AddScalars<float>(this->Volume, "value",
      [](const glm::dvec3& p) { return 100.0 * std::sin(0.7 * p.x) + 35.0 * p.z + p.y; });
    SetDisplacements(this->Mesh, Shift(0.25, 0.0, 0.0));
    for (vtkDeformVolumeFilter* filter : { this->Tested.Filter.Get(), this->Whole.Filter.Get() })
    {
      filter->SetResamplerToExact();
      filter->AddCategoricalArray("labels");
      filter->SetOutputBoundsModeToVolumeBounds();
    }
    VERIFY(this->Tested.Filter->GetIncremental());
    this->Whole.Filter->IncrementalOff();
  }

  void Run(int edits)
  {
    for (int edit = 0; edit < edits; ++edit)
    {
      const int failures = GetNumberOfFailures();
      const int kind = this->Random() % 3 ? static_cast<int>(this->Random() % 3)
                                          : static_cast<int>(this->Random() % 14);
      this->Apply(kind);
      this->Compare();
      if (GetNumberOfFailures() > failures)
      {
        std::cerr << "after edit " << edit << " of kind " << kind << '\n';
        return;
      }
    }
    std::cout << this->Parts << " of " << edits << " edits were made in part\n";
    VERIFY(this->Parts > edits / 5);
    VERIFY(this->SmallChanges > edits / 10);
  }

private:
  void ForBoth(const std::function<void(vtkDeformVolumeFilter*)>& change)
  {
    change(this->Tested.Filter);
    change(this->Whole.Filter);
  }

  // Moves nodes within a distance from a random one.
  void Move(double distance, double amount)
  {
    vtkDataArray* vectors = this->Mesh->GetPointData()->GetVectors();
    std::uniform_real_distribution<double> move(-amount, amount);
    const glm::dvec3 center =
      GetPoint(this->Mesh, static_cast<vtkIdType>(this->Random() % vectors->GetNumberOfTuples()));
    for (vtkIdType node = 0; node < vectors->GetNumberOfTuples(); ++node)
    {
      const glm::dvec3 offset = GetPoint(this->Mesh, node) - center;
      if (offset.x * offset.x + offset.y * offset.y + offset.z * offset.z <= distance * distance)
      {
        vectors->SetTuple3(node, move(this->Random), move(this->Random), move(this->Random));
      }
    }
    vectors->Modified();
  }

  void SetMask(vtkDataSetAttributes* attributes, const char* name, vtkIdType size,
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
    const auto place = static_cast<vtkIdType>(this->Random() % size);
    mask->SetValue(place, mask->GetValue(place) == usual ? other : usual);
    mask->Modified();
  }

  void Apply(int kind)
  {
    switch (kind)
    {
      case 0: // one node, or few
        this->Move(0.0, 1.2);
        break;
      case 1:
        this->Move(9.0, 1.0);
        break;
      case 2:
        this->SetMask(this->Volume->GetPointData(), vtkDataSetAttributes::GhostArrayName(),
          this->Volume->GetNumberOfPoints(), 0, vtkDataSetAttributes::HIDDENPOINT);
        this->SetMask(this->Volume->GetCellData(), "ActiveTetrahedra",
          this->Volume->GetNumberOfCells(), 31, this->Random() % 31);
        break;
      case 3: // many, all, none
        this->Move(40.0, 1.0);
        break;
      case 4:
        this->Move(1000.0, 1.0);
        break;
      case 5:
        this->Mesh->GetPointData()->GetVectors()->Modified();
        this->Mesh->Modified();
        break;
      case 6: // a fold, and back
        this->Move(0.0, 20.0);
        break;
      case 7:
        SetDisplacements(this->Mesh, Shift(0.5, -0.25, 0.0));
        break;
      case 8:
        this->ForBoth([](vtkDeformVolumeFilter* filter)
          { filter->SetPadding((filter->GetPadding() + 1) % 3); });
        break;
      case 9:
        this->ForBoth(
          [](vtkDeformVolumeFilter* filter)
          {
            filter->SetCustomSpacing(1.5, 1.0, 1.25);
            filter->SetOutputSpacingMode(1 - filter->GetOutputSpacingMode());
          });
        break;
      case 10:
        this->ForBoth([](vtkDeformVolumeFilter* filter)
          { filter->SetBackgroundValue(filter->GetBackgroundValue() + 1.0); });
        break;
      case 11:
      {
        vtkDataArray* values = this->Volume->GetPointData()->GetScalars();
        values->SetComponent(
          static_cast<vtkIdType>(this->Random() % values->GetNumberOfTuples()), 0, 77.0);
        values->Modified();
        break;
      }
      case 12:
        this->Abort();
        break;
      default:
        this->ForBoth([](vtkDeformVolumeFilter* filter)
          { filter->SetOutputBoundsMode(1 - filter->GetOutputBoundsMode()); });
    }
  }

  void Abort()
  {
    this->Move(9.0, 1.0);
    vtkNew<vtkCallbackCommand> callback;
    callback->SetCallback(AbortAtOnce);
    const unsigned long observer =
      this->Tested.Filter->AddObserver(vtkCommand::ProgressEvent, callback);
    this->Tested.Filter->Update();
    this->Tested.Filter->RemoveObserver(observer);
    this->Tested.Filter->SetAbortExecute(0);
    VERIFY_EQUAL(this->Tested.Filter->GetOutput()->GetNumberOfPoints(), 0);
    VERIFY_EQUAL(GetChangedExtent(this->Tested), Nothing);
    this->Shown = nullptr;
  }

  void Compare()
  {
    // Someone may hold the last output, or a part of it, or write to it.
    vtkNew<vtkImageData> held;
    vtkNew<vtkImageData> before;
    vtkSmartPointer<vtkDataArray> heldArray;
    switch (this->Random() % 6)
    {
      case 0:
        held->ShallowCopy(this->Tested.Filter->GetOutput());
        before->DeepCopy(held);
        break;
      case 1:
        heldArray = this->Tested.GetValues();
        break;
      case 2:
        if (vtkDataArray* values = this->Tested.GetValues())
        {
          values->Fill(-1.0);
          values->Modified();
        }
        break;
      default:
        break;
    }
    vtkImageData* output = this->Tested.Update();
    VERIFY(AreEqual(output, this->Whole.Update()));
    this->CheckChangedExtent(output);
    if (before->GetNumberOfPoints() > 0)
    {
      VERIFY(AreEqual(held, before));
    }
    const auto same = [this](vtkIdType (vtkDeformVolumeFilter::*get)())
    { VERIFY_EQUAL((this->Tested.Filter->*get)(), (this->Whole.Filter->*get)()); };
    same(&vtkDeformVolumeFilter::GetNumberOfCoveredVoxels);
    same(&vtkDeformVolumeFilter::GetNumberOfInvertedTetrahedra);
    same(&vtkDeformVolumeFilter::GetNumberOfBricks);
    VERIFY_EQUAL(
      this->Whole.Filter->GetNumberOfResampledBricks(), this->Whole.Filter->GetNumberOfBricks());
    this->Parts +=
      this->Tested.Filter->GetNumberOfResampledBricks() < this->Tested.Filter->GetNumberOfBricks()
      ? 1
      : 0;
  }

  // Whoever shows the output brings what changed up to date.
  void CheckChangedExtent(vtkImageData* output)
  {
    const Extent changed = GetChangedExtent(this->Tested);
    if (!this->Shown || GetExtent(this->Shown) != GetExtent(output) || changed == GetExtent(output))
    {
      VERIFY_EQUAL(changed, GetExtent(output));
      this->Shown = vtkSmartPointer<vtkImageData>::New();
      this->Shown->DeepCopy(output);
      return;
    }
    for (int i = 0; i < this->Shown->GetPointData()->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* from = output->GetPointData()->GetArray(i);
      vtkDataArray* to = this->Shown->GetPointData()->GetArray(i);
      for (int z = changed[4]; z <= changed[5]; ++z)
      {
        for (int y = changed[2]; y <= changed[3]; ++y)
        {
          int first[3] = { changed[0], y, z };
          const vtkIdType begin = output->ComputePointId(first);
          to->InsertTuples(begin, changed[1] - changed[0] + 1, begin, from);
        }
      }
    }
    VERIFY(AreEqual(this->Shown, output));
    ++this->SmallChanges;
  }

  std::mt19937 Random{ 5 };
  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Tested;
  Deformed Whole;
  int Parts = 0;
  vtkSmartPointer<vtkImageData> Shown; // what was the output before
  int SmallChanges = 0;
};

// What an array holds is found out again only where it changed: each time as by a filter that has
// read nothing before.
class Readings
{
public:
  Readings()
    : Volume(MakeImage({ { 0, 40, 0, 30, 0, 30 } }))
    , Mesh(MakeMesh(Volume, 14, 0.0))
    , Tested(Volume, Mesh)
  {
    AddScalars<float>(this->Volume, "value",
      [](const glm::dvec3& p) { return 100.0 * std::sin(0.7 * p.x) + 35.0 * p.z + p.y; });
    SetDisplacements(this->Mesh, Shift(0.25, 0.0, 0.0));
  }

  void Run()
  {
    this->Compare("first");
    const vtkIdType last = this->Mesh->GetNumberOfPoints() - 1;
    for (const vtkIdType node : { vtkIdType{ 0 }, vtkIdType{ 511 }, vtkIdType{ 512 }, last })
    {
      for (int component = 0; component < 3; ++component)
      {
        this->SetComponent(node, component, 1.5);
        this->Compare("one number of node " + std::to_string(node));
      }
    }
    this->RunErrors();
    this->Tested.Filter->SetDisplacementScale(-2.0);
    this->Compare("another scale");
    this->SetComponent(600, 1, 0.75);
    this->Tested.Filter->SetDisplacementScale(1.0);
    this->Compare("the scale that was, and a node");
    this->Volume->SetSpacing(1.0, 1.5, 1.0);
    this->Compare("another spacing");
    this->RunTypes();
    this->RunPorts();
  }

private:
  vtkDataArray* GetVectors() { return this->Mesh->GetPointData()->GetVectors(); }

  void SetComponent(vtkIdType node, int component, double value)
  {
    this->GetVectors()->SetComponent(node, component, value);
    this->GetVectors()->Modified();
  }

  void Compare(const std::string& what, vtkDataObject* rest = nullptr)
  {
    Deformed fresh(this->Volume, this->Mesh);
    for (vtkDeformVolumeFilter* filter : { this->Tested.Filter.Get(), fresh.Filter.Get() })
    {
      filter->SetInputDataObject(2, rest);
    }
    fresh.Filter->SetDisplacementScale(this->Tested.Filter->GetDisplacementScale());
    const int failures = GetNumberOfFailures();
    VERIFY(AreEqual(this->Tested.Update(), fresh.Update()));
    VERIFY(fresh.Filter->GetNumberOfCoveredVoxels() > 0);
    if (GetNumberOfFailures() > failures)
    {
      std::cerr << "after " << what << '\n';
    }
  }

  // What an error leaves behind is not taken for what was read before.
  void RunErrors()
  {
    for (const double bad : { std::nan(""), 1e6 })
    {
      const double good = this->GetVectors()->GetComponent(700, 2);
      this->SetComponent(700, 2, bad);
      this->SetComponent(30, 0, 0.5 + this->GetVectors()->GetComponent(30, 0));
      this->Tested.Filter->Update();
      VERIFY_EQUAL(this->Tested.TakeErrors(), 1);
      this->SetComponent(700, 2, good);
      this->Compare("a number that is mended");
    }
  }

  void RunTypes()
  {
    const vtkSmartPointer<vtkDataArray> floats = this->GetVectors();
    for (const int type : { VTK_DOUBLE, VTK_INT, VTK_FLOAT })
    {
      const auto copy = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
      copy->DeepCopy(floats);
      copy->SetName("displacement");
      copy->SetComponent(40, 0, type - 3.0);
      this->Mesh->GetPointData()->SetVectors(copy);
      this->Compare("an array of type " + std::to_string(type));
    }
    this->Mesh->GetPointData()->SetVectors(floats);
    this->Compare("the array that was");
  }

  // Displacements, then two configurations, then the same displacements again.
  void RunPorts()
  {
    vtkNew<vtkUnstructuredGrid> rest;
    rest->DeepCopy(this->Mesh);
    double point[3];
    rest->GetPoint(800, point);
    point[0] += 0.25;
    rest->GetPoints()->SetPoint(800, point);
    this->Compare("a rest configuration", rest);
    this->Compare("displacements again");
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Tested;
};

// All of the output, nothing of it, and what lies round a node; nothing after an error.
void TestChangedExtent()
{
  const auto volume = MakeVolume({ { -3, 130, 2, 90, 0, 80 } });
  const auto mesh = MakeMesh(volume, 12, 3.0);
  SetDisplacements(mesh, Shift(0.25, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  VERIFY_EQUAL(GetChangedExtent(deformed), Nothing);
  deformed.Filter->SetOutputBoundsModeToVolumeBounds();
  const auto expect = [&](const Extent& expected)
  {
    deformed.Update();
    VERIFY_EQUAL(GetChangedExtent(deformed), expected);
  };
  expect(GetExtent(volume));
  expect(GetExtent(volume)); // nothing was executed
  deformed.Filter->Modified();
  expect(Nothing);

  vtkDataArray* vectors = mesh->GetPointData()->GetVectors();
  const vtkIdType node = (6 * 12 + 6) * 12 + 6; // the lattice has 12 nodes on each axis
  vectors->SetTuple3(node, 1.0, 0.5, 0.5);
  vectors->Modified();
  deformed.Update();
  const Extent changed = GetChangedExtent(deformed);
  const glm::dvec3 place = GetPoint(mesh, node);
  const double step[3] = { 140.0 / 11.0, 94.0 / 11.0, 86.0 / 11.0 }; // between nodes
  const int subBrick[3] = { 16, 8, 8 };
  for (int axis = 0; axis < 3; ++axis)
  {
    const double middle = (&place.x)[axis];
    // What moves is in it, and of the rest no more than parts of bricks that hold some of it.
    VERIFY(changed[2 * axis] < middle && middle < changed[2 * axis + 1]);
    VERIFY(changed[2 * axis] >= middle - step[axis] - subBrick[axis] - 1.0);
    VERIFY(changed[2 * axis + 1] <= middle + step[axis] + subBrick[axis] + 2.0);
  }

  vectors->SetTuple3(node, std::nan(""), 0.0, 0.0);
  vectors->Modified();
  deformed.Filter->Update();
  VERIFY_EQUAL(deformed.TakeErrors(), 1);
  VERIFY_EQUAL(GetChangedExtent(deformed), Nothing);
  vectors->SetTuple3(node, 0.0, 0.0, 0.0);
  vectors->Modified();
  expect(GetExtent(volume));

  deformed.Filter->SetResamplerToMeshRasterization();
  expect(GetExtent(volume));
  deformed.Filter->SetResamplerToExact();
  deformed.Filter->SetPadding(2);
  expect({ { -5, 132, 0, 92, -2, 82 } });
}

// What only some devices can do must not change what all others give.
void TestProperty()
{
  vtkNew<vtkDeformVolumeFilter> filter;
  VERIFY(filter->GetIncremental());
  VERIFY_EQUAL(filter->GetNumberOfBricks(), 0);
  VERIFY_EQUAL(filter->GetNumberOfResampledBricks(), 0);
  const vtkMTimeType time = filter->GetMTime();
  filter->IncrementalOff();
  VERIFY(filter->GetMTime() > time);
}

} // namespace

int TestDeformIncremental(int, char*[])
{
  TestProperty();
  TestChangedExtent();
  Readings().Run();
  Edits edits;
  edits.Run(200);
  return GetExitCode();
}
