// SPDX-License-Identifier: BSD-3-Clause
#include "vtkDeformGeometryFilter.h"

#include "DeformationChoice.h"
#include "Error.h"
#include "FieldPointMap.h"
#include "InputUpdate.h"
#include "MaskArray.h"
#include "MeshGathering.h"
#include "MeshGrids.h"
#include "MeshPointMap.h"
#include "NewWarnings.h"
#include "ParallelFor.h"
#include "PipelineExecution.h"
#include "ProgressReport.h"
#include "RankSettings.h"
#include "Ranks.h"
#include "TransformedArrays.h"
#include "VTKThreads.h"
#include "VectorArray.h"
#include "WorldDeformation.h"

#include "vtkCellData.h"
#include "vtkCharArray.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <glm/common.hpp>

#include <algorithm>
#include <atomic>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

using deformvolume::PointMap;
using deformvolume::TransformedArray;

vtkStandardNewMacro(vtkDeformGeometryFilter);

namespace
{

constexpr std::size_t PointsPerPart = 512;
constexpr std::size_t PointsPerReport =
  64 * PointsPerPart; // points between two reports of progress

} // namespace

//------------------------------------------------------------------------------
/// State that vtkDeformGeometryFilter keeps from one execution to the next.
class vtkDeformGeometryFilter::vtkInternals
{
public:
  explicit vtkInternals(vtkDeformGeometryFilter* self)
    : Self(self)
  {
  }

  /// Throws an Error on all ranks if these have different settings or connections. Collective.
  void CheckSettings(const deformvolume::Ranks& ranks) const;
  /// Updates the map from the data of ports 1 and 2. Collective.
  void ReadDeformation(const deformvolume::Ranks& ranks, vtkDataObject* shape, vtkDataObject* rest);
  /// Moves a point set, or all point sets of a composite dataset.
  void MoveAll(vtkDataObject* input, vtkDataObject* output);

  deformvolume::PipelineExecution Execution;

private:
  void MakeMap(const deformvolume::OutsideVoxels& outside);
  vtkSmartPointer<vtkPointSet> Move(vtkPointSet* input);
  void WarnOfIgnored(const std::vector<vtkPointSet*>& inputs);
  void WarnOfOutside();
  /// Calls body(begin, end) for parts of a range, in parallel. Throws Aborted.
  template <typename Body>
  void RunInParts(std::size_t size, Body&& body);

  vtkDeformGeometryFilter* Self;
  deformvolume::DeformationGrids Grids;
  deformvolume::MeshGathering Gathering;
  deformvolume::WorldDeformation Deformation;

  // The map, and what it was made from.
  using Key = std::tuple<std::uint64_t, deformvolume::OutsideVoxels::Modes, double, bool>;
  std::unique_ptr<PointMap> Map; // null: points do not move
  bool MapIsOfMesh = false;
  std::uint64_t ConnectivityOfMap = 0;
  Key KeyOfMap;
  bool IsInverted = false; // whether points are moved by the inverse of the map

  // Numbers of points of all blocks, and of points that have been moved.
  vtkIdType NumberOfPoints = 0;
  vtkIdType NumberDone = 0;
  double LongestFading = 0.0; // see PointMap::Image
  vtkIdType NumberOfOutsidePoints = 0;

  std::string IgnoredBlocks; // a warning, or ""
  std::set<std::string> WarnedOf;
};

//------------------------------------------------------------------------------
void vtkDeformGeometryFilter::vtkInternals::CheckSettings(const deformvolume::Ranks& ranks) const
{
  deformvolume::RankSettings settings;
  settings.AddConnection(this->Self, 1, "deformation");
  settings.AddConnection(this->Self, 2, "mesh at rest");
  settings.Add("Inverse", this->Self->Inverse);
  settings.Add("DisplacementScale", this->Self->DisplacementScale);
  settings.Add("PointsAreDeformed", this->Self->PointsAreDeformed);
  settings.Add("FieldIsInverse", this->Self->FieldIsInverse);
  settings.Add("OutsideMode", this->Self->OutsideMode);
  settings.Add("FadeDistance", this->Self->FadeDistance);
  settings.Add("TransformAllInputVectors", this->Self->TransformAllInputVectors);
  settings.Check(ranks);
}

//------------------------------------------------------------------------------
void vtkDeformGeometryFilter::vtkInternals::ReadDeformation(
  const deformvolume::Ranks& ranks, vtkDataObject* shape, vtkDataObject* rest)
{
  if (this->Self->GetNumberOfInputConnections(1) == 0)
  {
    if (this->Self->GetNumberOfInputConnections(2) > 0)
    {
      deformvolume::ThrowRestWithoutDeformation(2, 1);
    }
    this->Map = nullptr;
    return;
  }
  deformvolume::DeformationSource source;
  ranks.Attempt(
    [&]
    {
      source = deformvolume::ChooseDeformation(shape, rest, this->Self->GetInputArrayInformation(0),
        [this](vtkDataSet* dataSet, int& association)
        { return this->Self->GetInputArrayToProcess(0, dataSet, association); },
        { this->Self->DisplacementScale, this->Self->PointsAreDeformed,
          this->Self->FieldIsInverse });
      source.ShapeIsMade = !deformvolume::IsInMemory(this->Self, 1);
      source.RestIsMade = !deformvolume::IsInMemory(this->Self, 2);
      this->Grids.Find(source);
      this->IgnoredBlocks = deformvolume::DescribeIgnored(source.ShapeParts);
    });
  source = this->Gathering.Gather(ranks, source, false);
  ranks.Attempt(
    [&]
    {
      this->Deformation.Read(source);
      this->MakeMap(
        deformvolume::MakeOutsideVoxels(this->Self->OutsideMode, this->Self->FadeDistance));
    });
}

//------------------------------------------------------------------------------
void vtkDeformGeometryFilter::vtkInternals::MakeMap(const deformvolume::OutsideVoxels& outside)
{
  const bool isField = this->Deformation.IsField();
  this->IsInverted = this->Self->Inverse != (isField && this->Self->FieldIsInverse);
  const Key key(
    this->Deformation.GetVersion(), outside.Mode, outside.FadeDistance, this->IsInverted);
  if (this->Map && key == this->KeyOfMap)
  {
    return;
  }
  this->KeyOfMap = Key(); // belongs to no map until this one is complete
  if (isField)
  {
    this->Map = nullptr;
    this->MapIsOfMesh = false;
    this->Map = std::make_unique<deformvolume::FieldPointMap>(
      this->Deformation.GetField(), outside, this->IsInverted);
  }
  else
  {
    const deformvolume::RestMesh& mesh = this->Deformation.GetRestMesh();
    if (!this->Map || !this->MapIsOfMesh ||
      this->ConnectivityOfMap != mesh.GetConnectivityVersion())
    {
      this->Map = nullptr;
      this->Map =
        std::make_unique<deformvolume::MeshPointMap>(mesh.GetPoints(), mesh.GetTetrahedra());
      this->MapIsOfMesh = true;
      this->ConnectivityOfMap = mesh.GetConnectivityVersion();
    }
    static_cast<deformvolume::MeshPointMap*>(this->Map.get())
      ->Set(this->Deformation.GetDisplacements(), outside, this->IsInverted);
  }
  this->KeyOfMap = key;
}

//------------------------------------------------------------------------------
template <typename Body>
void vtkDeformGeometryFilter::vtkInternals::RunInParts(std::size_t size, Body&& body)
{
  deformvolume::ProgressReport progress(this->Self);
  for (std::size_t begin = 0; begin < size; begin += PointsPerReport)
  {
    const std::size_t some = std::min(PointsPerReport, size - begin);
    if (!progress.Report(
          static_cast<double>(this->NumberDone) / static_cast<double>(this->NumberOfPoints)))
    {
      throw deformvolume::Aborted();
    }
    deformvolume::ParallelForParts(some, PointsPerPart,
      [&](std::size_t from, std::size_t to) { body(begin + from, begin + to); });
    this->NumberDone += static_cast<vtkIdType>(some);
  }
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPointSet> vtkDeformGeometryFilter::vtkInternals::Move(vtkPointSet* input)
{
  const auto output = vtkSmartPointer<vtkPointSet>::Take(input->NewInstance());
  output->ShallowCopy(input);
  const vtkIdType count = input->GetNumberOfPoints();
  vtkNew<vtkCharArray> mask;
  mask->SetName(deformvolume::ValidPointMaskName);
  mask->SetNumberOfTuples(count);
  output->GetPointData()->AddArray(mask);
  if (count == 0)
  {
    return output;
  }
  std::vector<glm::dvec3> positions(static_cast<std::size_t>(count));
  vtkDataArray* inputPoints = input->GetPoints()->GetData();
  deformvolume::ReadVectors(
    inputPoints,
    [&](vtkIdType first, const glm::dvec3* points, vtkIdType number)
    { std::copy_n(points, number, positions.begin() + first); },
    "Point", "point set on input port 0");
  if (this->Map && this->MapIsOfMesh)
  {
    static_cast<deformvolume::MeshPointMap*>(this->Map.get())
      ->SetPointsAreFloats(inputPoints->GetDataType() == VTK_FLOAT);
  }
  const vtkSmartPointer<vtkDataArray> moved = deformvolume::MakeVectors(inputPoints, count);
  const std::vector<TransformedArray> arrays =
    deformvolume::FindTransformed(input, this->Self->TransformAllInputVectors);
  std::atomic<vtkIdType> outside{ 0 };
  std::atomic<bool> isTooFar{ false };
  std::atomic<double> leastFading{ 0.0 }; // the negated largest displacement
  const double farthest = moved->GetDataTypeMax();
  this->RunInParts(positions.size(),
    [&](std::size_t begin, std::size_t end)
    {
      vtkIdType outsideHere = 0;
      double fadingHere = 0.0;
      std::vector<PointMap::Image> images(end - begin);
      for (std::size_t i = begin; i < end; ++i)
      {
        PointMap::Image& image = images[i - begin];
        const auto point = static_cast<vtkIdType>(i);
        const bool isValid =
          deformvolume::MovePoint(this->Map.get(), this->IsInverted, positions[i], image);
        outsideHere += isValid ? 0 : 1;
        fadingHere = std::max(fadingHere, image.FadingDisplacement);
        const glm::dvec3 size = glm::abs(image.Point);
        if (!(size.x <= farthest && size.y <= farthest && size.z <= farthest)) // also for NaN
        {
          isTooFar = true;
          image.Point = glm::dvec3(0.0);
        }
        mask->SetValue(point, isValid ? 1 : 0);
        moved->SetTuple(point, &image.Point.x);
      }
      for (const TransformedArray& array : arrays)
      {
        array.Transform(static_cast<vtkIdType>(begin), images);
      }
      outside += outsideHere;
      deformvolume::Lower(leastFading, -fadingHere);
    });
  if (isTooFar)
  {
    throw deformvolume::Error(
      "The deformation moves points so far that their coordinates overflow the type " +
      std::string(moved->GetDataTypeAsString()) +
      ". Check the displacements and DisplacementScale.");
  }
  vtkNew<vtkPoints> points;
  points->SetData(moved);
  output->SetPoints(points);
  vtkPointData* pointData = output->GetPointData();
  for (const TransformedArray& array : arrays)
  {
    // An array with a name replaces the last one, and keeps all its roles.
    if (array.Attribute < 0 || array.Output->GetName())
    {
      pointData->AddArray(array.Output);
    }
    else
    {
      pointData->SetAttribute(array.Output, array.Attribute);
    }
  }
  this->NumberOfOutsidePoints += outside;
  this->LongestFading = std::max(this->LongestFading, -leastFading.load());
  return output;
}

//------------------------------------------------------------------------------
void vtkDeformGeometryFilter::vtkInternals::MoveAll(vtkDataObject* input, vtkDataObject* output)
{
  std::vector<vtkPointSet*> inputs;
  auto* blocks = vtkCompositeDataSet::SafeDownCast(input);
  vtkSmartPointer<vtkCompositeDataIterator> iterator;
  if (blocks)
  {
    iterator.TakeReference(blocks->NewIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      vtkDataObject* block = iterator->GetCurrentDataObject();
      inputs.push_back(vtkPointSet::SafeDownCast(block));
      if (!inputs.back())
      {
        throw deformvolume::Error("Block " + std::to_string(iterator->GetCurrentFlatIndex()) +
          " of the composite dataset on input port 0 is a " + block->GetClassName() +
          ", which has no points that can be moved. Extract the blocks that are point sets.");
      }
    }
  }
  else
  {
    inputs.push_back(vtkPointSet::SafeDownCast(input));
  }
  this->WarnOfIgnored(inputs);
  this->NumberDone = this->NumberOfPoints = 0;
  this->LongestFading = 0.0;
  this->NumberOfOutsidePoints = 0;
  for (vtkPointSet* points : inputs)
  {
    this->NumberOfPoints += points->GetNumberOfPoints();
  }
  // Move all points before the output is filled: it must be complete or empty.
  std::vector<vtkSmartPointer<vtkPointSet>> moved;
  for (vtkPointSet* points : inputs)
  {
    moved.push_back(this->Move(points));
  }
  if (!blocks)
  {
    output->ShallowCopy(moved.front());
  }
  else
  {
    auto* movedBlocks = vtkCompositeDataSet::SafeDownCast(output);
    movedBlocks->CopyStructure(blocks);
    movedBlocks->GetFieldData()->PassData(blocks->GetFieldData());
    auto next = moved.begin();
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      movedBlocks->SetDataSet(iterator, *next++);
    }
  }
  this->Self->NumberOfOutsidePoints = this->NumberOfOutsidePoints;
  this->WarnOfOutside();
}

//------------------------------------------------------------------------------
void vtkDeformGeometryFilter::vtkInternals::WarnOfOutside()
{
  const std::string folds = deformvolume::GetFoldWarning(
    "border of the deformation moves", this->LongestFading, this->Self->FadeDistance);
  if (!folds.empty())
  {
    vtkWarningWithObjectMacro(this->Self, << folds);
  }
  const vtkIdType outside = this->Self->NumberOfOutsidePoints;
  if (outside == 0)
  {
    return;
  }
  const bool isField = this->Deformation.IsField();
  const std::string where = this->IsInverted
    ? (isField ? "are at positions to which the displacement field moves no point"
               : "lie outside the deformed mesh")
    : (isField ? "lie outside the displacement field" : "lie outside the deformation mesh");
  vtkWarningWithObjectMacro(this->Self,
    << outside << " of " << this->NumberOfPoints << " points " << where
    << ". They do not move, and " << deformvolume::ValidPointMaskName << " is 0 for them."
    << (this->Self->OutsideMode == DISCARD
           ? " Set OutsideMode to EXTRAPOLATE or KEEP for points outside."
           : ""));
}

//------------------------------------------------------------------------------
void vtkDeformGeometryFilter::vtkInternals::WarnOfIgnored(const std::vector<vtkPointSet*>& inputs)
{
  std::set<std::string> warnings;
  vtkIdType points = 0;
  for (vtkPointSet* input : inputs)
  {
    points += input->GetNumberOfPoints();
    for (const auto& [array, kind] : { std::pair(input->GetCellData()->GetNormals(), "normals"),
           std::pair(input->GetCellData()->GetVectors(), "vectors") })
    {
      if (array && this->Map)
      {
        warnings.insert(std::string("The active ") + kind + " \"" +
          (array->GetName() ? array->GetName() : "") +
          "\" of the cells on input port 0 are not transformed. Compute them from the output, or "
          "convert them to point arrays before this filter.");
      }
    }
  }
  // With several ranks, a rank may have no points.
  if (points == 0 && !deformvolume::Ranks().AreMany())
  {
    warnings.insert("The input on port 0 has no points, so the output has no points.");
  }
  if (this->Map && !this->Deformation.IsField())
  {
    if (!this->IgnoredBlocks.empty())
    {
      warnings.insert(this->IgnoredBlocks);
    }
    deformvolume::AddCellWarnings(this->Deformation.GetRestMesh(), this->Gathering, warnings);
  }
  const std::string news = deformvolume::ReplaceWarnings(this->WarnedOf, std::move(warnings));
  if (!news.empty())
  {
    vtkWarningWithObjectMacro(this->Self, << news);
  }
}

//------------------------------------------------------------------------------
vtkDeformGeometryFilter::vtkDeformGeometryFilter()
  : Internals(new vtkInternals(this))
{
  deformvolume::UseVTKThreads();
  this->SetNumberOfInputPorts(3);
  this->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::VECTORS);
}

//------------------------------------------------------------------------------
vtkDeformGeometryFilter::~vtkDeformGeometryFilter() = default;

//------------------------------------------------------------------------------
int vtkDeformGeometryFilter::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 0)
  {
    info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPointSet");
    // Without this, the executive would iterate over the blocks, of which ranks may have different
    // numbers.
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
    return 1;
  }
  deformvolume::FillDeformationPort(info);
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformGeometryFilter::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject");
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformGeometryFilter::RequestDataObject(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* outputVector)
{
  vtkDataObject* points = vtkDataObject::GetData(input[0]);
  vtkInformation* outInfo = outputVector->GetInformationObject(0);
  vtkDataObject* output = vtkDataObject::GetData(outInfo);
  const bool isKnown =
    vtkPointSet::SafeDownCast(points) || vtkCompositeDataSet::SafeDownCast(points);
  const std::string type = isKnown ? points->GetClassName() : "vtkPolyData";
  if (!output || output->GetClassName() != type)
  {
    vtkDataObject* made = isKnown ? points->NewInstance() : vtkPolyData::New();
    outInfo->Set(vtkDataObject::DATA_OBJECT(), made);
    made->Delete();
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformGeometryFilter::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  this->Internals->Execution.Renew(this);
  *mtime = deformvolume::GetMTimeWithInputs(this);
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformGeometryFilter::ExecuteInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* output)
{
  deformvolume::MergeTimes(this, 3, output->GetInformationObject(0));
  return 1;
}

//------------------------------------------------------------------------------
int vtkDeformGeometryFilter::ComputeInputUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  const deformvolume::Ranks ranks;
  for (int port = 1; port < 3; ++port)
  {
    if (vtkInformation* info = input[port]->GetInformationObject(0))
    {
      deformvolume::RequestInput(info, ranks);
    }
  }
  if (!ranks.AreMany())
  {
    return 1;
  }
  return this->Internals->Execution.Run(this,
    "There is not enough memory for the inputs. Use smaller ones, or free memory.",
    [&]
    {
      this->Internals->CheckSettings(ranks);
      deformvolume::UpdateRequested(this, 3, input, ranks);
    });
}

//------------------------------------------------------------------------------
int vtkDeformGeometryFilter::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* outputVector)
{
  vtkInformation* outInfo = outputVector->GetInformationObject(0);
  vtkDataObject* points = vtkDataObject::GetData(input[0]);
  vtkDataObject* output = vtkDataObject::GetData(outInfo);
  output->Initialize();
  this->NumberOfOutsidePoints = 0;
  if (this->Internals->Execution.HasFailed())
  {
    return 0; // ComputeInputUpdateExtent() has failed, which the executive ignores
  }
  return this->Internals->Execution.Run(this,
    "There is not enough memory for the points. Use a smaller point set, or free memory.",
    [&]
    {
      const deformvolume::Ranks ranks;
      ranks.Attempt([&] { deformvolume::CheckTimes(3, input, outInfo); });
      vtkDataObject* shape = vtkDataObject::GetData(input[1]);
      this->Internals->ReadDeformation(ranks, shape, vtkDataObject::GetData(input[2]));
      ranks.Attempt([&] { this->Internals->MoveAll(points, output); });
      deformvolume::SetTimeStep(output, outInfo, { shape, points });
    });
}

//------------------------------------------------------------------------------
void vtkDeformGeometryFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Inverse: " << (this->Inverse ? "on" : "off") << "\n";
  os << indent << "DisplacementScale: " << this->DisplacementScale << "\n";
  os << indent << "PointsAreDeformed: " << (this->PointsAreDeformed ? "on" : "off") << "\n";
  os << indent << "FieldIsInverse: " << (this->FieldIsInverse ? "on" : "off") << "\n";
  os << indent << "OutsideMode: " << this->OutsideMode << "\n";
  os << indent << "FadeDistance: " << this->FadeDistance << "\n";
  os << indent << "TransformAllInputVectors: " << (this->TransformAllInputVectors ? "on" : "off")
     << "\n";
  os << indent << "NumberOfOutsidePoints: " << this->NumberOfOutsidePoints << "\n";
}
