// SPDX-License-Identifier: BSD-3-Clause
#include "vtkElasticDeformation.h"

#include "BodyReading.h"
#include "ElasticSession.h"
#include "ElasticSimulation.h"
#include "Error.h"
#include "InputUpdate.h"
#include "MaterialPresets.h"
#include "PieceRequest.h"
#include "PipelineExecution.h"
#include "ProgressReport.h"
#include "SheetReading.h"
#include "VTKThreads.h"

#include "vtkCellData.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationDoubleKey.h"
#include "vtkInformationDoubleVectorKey.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <tuple>
#include <vector>

using Pipeline = vtkStreamingDemandDrivenPipeline;
using deformvolume::BodyMesh;
using deformvolume::ElasticSimulation;

namespace
{

// Whether an input announces times.
bool HasTimes(vtkInformation* info)
{
  return info && (info->Has(Pipeline::TIME_STEPS()) || info->Has(Pipeline::TIME_RANGE()));
}

void AddElementResults(
  vtkUnstructuredGrid* output, const BodyMesh& mesh, ElasticSimulation& simulation)
{
  const auto addTo =
    [](vtkDataSetAttributes* data, const char* name, int components, vtkIdType tuples)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(tuples);
    array->Fill(0.0);
    data->AddArray(array);
    return array->GetPointer(0);
  };
  const std::vector<glm::dvec3> reactions = simulation.GetReactions();
  if (!reactions.empty())
  {
    double* reaction =
      addTo(output->GetPointData(), "ReactionForce", 3, output->GetNumberOfPoints());
    std::copy_n(&reactions.front().x, 3 * reactions.size(), reaction);
  }
  const auto add = [&](const char* name, int components)
  { return addTo(output->GetCellData(), name, components, output->GetNumberOfCells()); };
  const std::vector<deformvolume::ElementResults> results = simulation.GetElementResults();
  constexpr int numberOfStresses = 6;
  double* stress = add("Stress", numberOfStresses);
  double* energy = add("StrainEnergyDensity", 1);
  double* determinant = add("DeformationGradientDeterminant", 1);
  for (std::size_t t = 0; t < results.size(); ++t)
  {
    const vtkIdType cell = mesh.Cells[t];
    std::copy(results[t].Stress.begin(), results[t].Stress.end(), stress + numberOfStresses * cell);
    energy[cell] = results[t].StrainEnergyDensity;
    determinant[cell] = results[t].Determinant;
  }
}

} // namespace

class vtkElasticDeformation::vtkInternals
{
public:
  deformvolume::ElasticSession Session;
  bool IsToReset = false;
  std::size_t CutsToUndo = 0;
  double CheckedSize = -1.0; // argument of the last CheckSize()
  // What the body was advanced from last: the properties, the inputs, and the time if one was
  // requested.
  using FrameKey = std::tuple<vtkMTimeType, deformvolume::Stamp, std::optional<double>>;
  FrameKey KeyOfFrame;
  deformvolume::PipelineExecution Execution;
};

vtkElasticDeformation::vtkElasticDeformation()
  : Internals(new vtkInternals)
{
  deformvolume::UseVTKThreads();
  this->SetNumberOfInputPorts(3);
}

vtkElasticDeformation::~vtkElasticDeformation() = default;

void vtkElasticDeformation::UndoCut()
{
  std::size_t& cuts = this->Internals->CutsToUndo;
  cuts = std::max(cuts, cuts + 1); // keeps the maximum that ClearCuts() sets
  this->Modified();
}

void vtkElasticDeformation::ClearCuts()
{
  this->Internals->CutsToUndo = std::numeric_limits<std::size_t>::max();
  this->Modified();
}

vtkIdType vtkElasticDeformation::GetNumberOfCuts()
{
  return static_cast<vtkIdType>(this->Internals->Session.GetNumberOfCuts());
}

vtkIdType vtkElasticDeformation::GetNumberOfSplitFaces()
{
  return static_cast<vtkIdType>(this->Internals->Session.GetNumberOfSplitFaces());
}

void vtkElasticDeformation::Reset()
{
  this->Internals->IsToReset = true;
  this->Modified();
}

double vtkElasticDeformation::GetTime()
{
  return this->Internals->IsToReset ? 0.0 : this->Internals->Session.Time;
}

const char* vtkElasticDeformation::GetMaterialPresetName(int preset)
{
  const auto* found = deformvolume::FindMaterialPreset(preset);
  return found ? found->Name : (preset == CUSTOM ? "Custom" : nullptr);
}

const char* vtkElasticDeformation::GetMaterialPresetSource(int preset)
{
  const auto* found = deformvolume::FindMaterialPreset(preset);
  return found ? found->Source : nullptr;
}

bool vtkElasticDeformation::GetMaterialPresetValues(int preset, double values[3])
{
  const auto* found = deformvolume::FindMaterialPreset(preset);
  if (!found || !values)
  {
    return false;
  }
  values[0] = found->Material.YoungModulus;
  values[1] = found->Material.PoissonRatio;
  values[2] = found->Material.Density;
  return true;
}

int vtkElasticDeformation::FillInputPortInformation(int port, vtkInformation* info)
{
  constexpr const char* types[3] = { "vtkUnstructuredGrid", "vtkPointSet", "vtkPolyData" };
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), types[port]);
  deformvolume::AcceptBlocks(info);
  if (port > 0)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

int vtkElasticDeformation::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkInformation* output = outputVector->GetInformationObject(0);
  output->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  deformvolume::MergeTimes(this, 3, output);
  if (!HasTimes(output) && this->EndTime > 0.0)
  {
    const double range[2] = { 0.0, this->EndTime };
    output->Set(Pipeline::TIME_RANGE(), range, 2);
  }
  return 1;
}

int vtkElasticDeformation::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  deformvolume::AskForAll(input, 0, 3);
  return 1;
}

int vtkElasticDeformation::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  this->Internals->Execution.Renew(this);
  *mtime = this->GetMTime();
  return 1;
}

int vtkElasticDeformation::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkUnstructuredGrid::GetData(output)->Initialize();
  if (this->Internals->Execution.Run(this,
        "There is not enough memory for the simulation. Use a coarser mesh, or free "
        "memory.",
        [&] { this->Execute(input, output); }))
  {
    return 1;
  }
  vtkUnstructuredGrid::GetData(output)->Initialize();
  this->NumberOfHeldNodes = 0;
  this->ClearReport();
  return deformvolume::GetResultOfError(output);
}

void vtkElasticDeformation::Execute(
  vtkInformationVector** input, vtkInformationVector* outputVector)
{
  deformvolume::RefuseBlocks(3, input);
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::GetData(input[0]);
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputVector);
  vtkInformation* info = outputVector->GetInformationObject(0);
  vtkInternals& internals = *this->Internals;
  deformvolume::ElasticSession& session = internals.Session;
  deformvolume::BodySettings settings;
  const auto* preset = deformvolume::FindMaterialPreset(this->MaterialPreset);
  settings.Material = preset
    ? preset->Material
    : deformvolume::ElasticMaterial{ this->YoungModulus, this->PoissonRatio, this->Density };
  settings.UnitLength = this->LengthUnit == MILLIMETRE ? 1e-3 : 1.0;
  ElasticSimulation& simulation = this->PrepareSimulation();
  settings.IsQuadratic = simulation.IsQuadratic();
  deformvolume::ProgressReport progress(this);
  // All ranks simulate, so that each has the same body if it requests the first piece or the whole
  // later. Only one of them displays warnings and has an output.
  const bool isFirst = deformvolume::IsFirstPiece(outputVector);
  if (session.Update(simulation, grid, deformvolume::GetWrittenStamp(this, 0), settings,
        [&] { return progress.Report(0.0); }) &&
    isFirst)
  {
    vtkWarningMacro(
      "The simulation starts again from rest, because the points, the cells or the unit of length "
      "of the mesh at rest have changed, or because a failed update lost the state of the body.");
  }
  if (isFirst)
  {
    this->CheckSize(session.GetMesh().Size);
  }
  const bool wasToReset = internals.IsToReset;
  bool isToReset = this->StartsAgain(info);
  std::size_t cuts = session.GetNumberOfCuts();
  const double time = isToReset ? 0.0 : session.Time;
  try
  {
    cuts = this->UpdateCuts(vtkPolyData::GetData(input[2]), isToReset);
    // If only another piece is requested, the body has been advanced already.
    vtkInternals::FrameKey key(this->GetMTime(), {}, {});
    for (int port = 0; port < 3; ++port)
    {
      std::get<1>(key).push_back(deformvolume::GetInputStamp(this, port));
    }
    if (info->Has(Pipeline::UPDATE_TIME_STEP()))
    {
      std::get<2>(key) = info->Get(Pipeline::UPDATE_TIME_STEP());
    }
    if (key != internals.KeyOfFrame)
    {
      this->Advance(simulation, vtkPointSet::GetData(input[1]), info, progress, isToReset);
      internals.KeyOfFrame = key;
    }
  }
  catch (const deformvolume::Aborted&)
  {
    throw;
  }
  catch (const deformvolume::Error&)
  {
    // The sheet cuts in the next update that succeeds.
    if (session.Time == time || isToReset)
    {
      this->RevertCuts(simulation, cuts);
      internals.IsToReset = wasToReset;
    }
    throw;
  }
  catch (...)
  {
    session.Lose();
    throw;
  }
  const std::vector<std::string> warnings = simulation.TakeWarnings();
  if (!isFirst)
  {
    return;
  }
  for (const std::string& warning : warnings)
  {
    vtkWarningMacro(<< warning);
  }
  output->ShallowCopy(session.GetGrid(grid));
  vtkDataArray* displacements = simulation.WriteOutput(1.0 / settings.UnitLength);
  displacements->Modified();
  output->GetPointData()->SetVectors(displacements);
  if (this->ElementResults)
  {
    AddElementResults(output, session.GetMesh(), simulation);
  }
  if (info->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), session.Time);
  }
}

bool vtkElasticDeformation::StartsAgain(vtkInformation* info)
{
  const vtkInternals& internals = *this->Internals;
  return internals.IsToReset ||
    (info->Has(Pipeline::UPDATE_TIME_STEP()) &&
      info->Get(Pipeline::UPDATE_TIME_STEP()) < internals.Session.Time - this->GetRoundOff());
}

void vtkElasticDeformation::Advance(ElasticSimulation& simulation, vtkPointSet* handles,
  vtkInformation* info, deformvolume::ProgressReport& progress, bool& isToReset)
{
  vtkInternals& internals = *this->Internals;
  deformvolume::ElasticSession& session = internals.Session;
  ElasticSimulation::Frame frame;
  frame.Held = deformvolume::ReadHandles(
    handles, this->HandleRadius, session.GetMesh(), session.GetSettings());
  frame.Loads.Gravity = { this->Gravity[0], this->Gravity[1], this->Gravity[2] };
  frame.Loads.Forces = session.GetMesh().Forces;
  frame.Loads.FixedDisplacements = session.GetMesh().PrescribedDisplacements;

  if (isToReset)
  {
    session.Reset();
    internals.IsToReset = isToReset = false;
  }
  double end = session.Time;
  const double roundOff = this->GetRoundOff();
  if (info->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    if (simulation.HasFrames() && !HasTimes(info))
    {
      vtkWarningMacro("A time is requested, but the output has no time range, so that VTK does not "
                      "update it for other times. Set EndTime to the end of the simulation.");
    }
    end = info->Get(Pipeline::UPDATE_TIME_STEP());
  }
  else
  {
    end += this->GetFreeDuration();
  }
  const double duration = std::max(0.0, end - session.Time);
  const double longest = simulation.HasFrames() ? this->FrameTime : std::max(duration, 1.0);
  const double frames = std::max(1.0, std::ceil((duration - roundOff) / longest));
  for (double done = 0.0; done < frames; done += 1.0)
  {
    frame.Duration = std::min(longest, std::max(0.0, end - session.Time));
    frame.IsLast = done + 1.0 == frames;
    frame.Progress = [&](double fraction) { return progress.Report((done + fraction) / frames); };
    simulation.Advance(frame);
    session.HasMoved = true;
    session.Time = frame.IsLast ? end : session.Time + frame.Duration;
  }
  this->NumberOfHeldNodes = static_cast<vtkIdType>(frame.Held.size());
}

void vtkElasticDeformation::CheckSize(double size)
{
  constexpr double least = 1e-3;
  constexpr double most = 10.0;
  if (size != this->Internals->CheckedSize && !(size >= least && size <= most))
  {
    vtkWarningMacro(<< "The diagonal of the body is " << size
                    << " m, if the unit of length of the mesh is the "
                    << (this->LengthUnit == METRE ? "meter" : "millimeter")
                    << ". If this size is wrong, set another unit of length, or convert the mesh.");
  }
  this->Internals->CheckedSize = size;
}

void vtkElasticDeformation::RevertCuts(ElasticSimulation& simulation, std::size_t left)
{
  deformvolume::ElasticSession& session = this->Internals->Session;
  if (!simulation.HasBody())
  {
    session.Lose(); // for example after a device has failed
    return;
  }
  try
  {
    session.RevertNewCuts(left);
  }
  catch (...)
  {
    session.Lose(); // the first error is reported
  }
}

std::size_t vtkElasticDeformation::UpdateCuts(vtkPolyData* sheet, bool isToReset)
{
  deformvolume::ElasticSession& session = this->Internals->Session;
  const deformvolume::WorldSheet read = deformvolume::ReadSheet(
    sheet, glm::dvec3(this->SweepVector[0], this->SweepVector[1], this->SweepVector[2]), "sheet");
  const std::size_t undone = std::min(this->Internals->CutsToUndo, session.GetNumberOfCuts());
  session.RemoveCuts(session.GetNumberOfCuts() - undone);
  this->Internals->CutsToUndo = 0;
  const std::size_t before = session.GetNumberOfCuts();
  session.Cut(read, isToReset);
  return before;
}

std::string vtkElasticDeformation::GetSummary()
{
  const deformvolume::ElasticSession& session = this->Internals->Session;
  if (!session.HasBody() || this->Internals->Execution.HasFailed())
  {
    return std::string();
  }
  std::ostringstream text;
  text << "Nodes: " << session.GetMesh().Body.Points.size() << "\n"
       << "Tetrahedra: " << session.GetMesh().Body.Tetrahedra.size() << "\n"
       << "Nodes that handles hold: " << this->NumberOfHeldNodes << "\n"
       << "Cuts: " << this->GetNumberOfCuts() << "\n"
       << "Time: " << this->GetTime() << " s";
  return text.str();
}

void vtkElasticDeformation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "HandleRadius: " << this->HandleRadius << "\n";
  os << indent << "Gravity: " << this->Gravity[0] << " " << this->Gravity[1] << " "
     << this->Gravity[2] << "\n";
  os << indent << "YoungModulus: " << this->YoungModulus << "\n";
  os << indent << "PoissonRatio: " << this->PoissonRatio << "\n";
  os << indent << "Density: " << this->Density << "\n";
  os << indent << "MaterialPreset: " << GetMaterialPresetName(this->MaterialPreset) << "\n";
  os << indent << "LengthUnit: " << (this->LengthUnit == METRE ? "METRE" : "MILLIMETRE") << "\n";
  os << indent << "SweepVector: " << this->SweepVector[0] << " " << this->SweepVector[1] << " "
     << this->SweepVector[2] << "\n";
  os << indent << "NumberOfCuts: " << this->GetNumberOfCuts() << "\n";
  os << indent << "NumberOfSplitFaces: " << this->GetNumberOfSplitFaces() << "\n";
  os << indent << "FrameTime: " << this->FrameTime << "\n";
  os << indent << "EndTime: " << this->EndTime << "\n";
  os << indent << "ElementResults: " << (this->ElementResults ? "on" : "off") << "\n";
  os << indent << "Time: " << this->GetTime() << "\n";
  os << indent << "NumberOfHeldNodes: " << this->NumberOfHeldNodes << "\n";
}
