// SPDX-License-Identifier: BSD-3-Clause
#include "vtkElasticDeformation.h"

#include "AbortCheck.h"
#include "BodyReading.h"
#include "ElasticSimulation.h"
#include "Error.h"
#include "FailureReport.h"
#include "PieceRequest.h"
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
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>
#include <sstream>
#include <vector>

using Pipeline = vtkStreamingDemandDrivenPipeline;
using deformvolume::BodyMesh;
using deformvolume::ElasticSimulation;

namespace
{

bool IsSame(const deformvolume::ElasticMaterial& a, const deformvolume::ElasticMaterial& b)
{
  return a.YoungModulus == b.YoungModulus && a.PoissonRatio == b.PoissonRatio &&
    a.Density == b.Density;
}

bool HasSameMesh(const deformvolume::ElasticBody& a, const deformvolume::ElasticBody& b)
{
  return a.Points == b.Points && a.Tetrahedra == b.Tetrahedra;
}

bool IsSame(const deformvolume::ElasticBody& a, const deformvolume::ElasticBody& b)
{
  return HasSameMesh(a, b) && a.Fixed == b.Fixed &&
    std::equal(a.Materials.begin(), a.Materials.end(), b.Materials.begin(), b.Materials.end(),
      [](const auto& one, const auto& other) { return IsSame(one, other); });
}

// The times that an input has, if any.
bool HasTimes(vtkInformation* info)
{
  return info && (info->Has(Pipeline::TIME_STEPS()) || info->Has(Pipeline::TIME_RANGE()));
}

void AddElementResults(vtkUnstructuredGrid* output, const BodyMesh& mesh,
  const std::vector<deformvolume::ElementResults>& results)
{
  const auto add = [&](const char* name, int components)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(output->GetNumberOfCells());
    array->Fill(0.0);
    output->GetCellData()->AddArray(array);
    return array->GetPointer(0);
  };
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
  /// Brings the body up to date. Returns whether something that was simulated is lost by that.
  bool Update(ElasticSimulation& simulation, vtkUnstructuredGrid* grid,
    const deformvolume::BodySettings& settings)
  {
    const deformvolume::Stamp stamp = deformvolume::GetBodyStamp(grid);
    this->HasBody = this->HasBody && &simulation == this->Simulation && simulation.HasBody();
    const bool isKnown = this->HasBody && stamp == this->BodyStamp &&
      IsSame(settings.Material, this->Settings.Material) &&
      settings.UnitLength == this->Settings.UnitLength;
    if (isKnown)
    {
      return false;
    }
    BodyMesh mesh = deformvolume::ReadBody(grid, settings);
    const bool keepsState =
      this->HasBody && &simulation == this->Simulation && HasSameMesh(mesh.Body, this->Mesh.Body);
    const bool isLost = this->HasBody && !keepsState && this->HasMoved;
    if (!keepsState || !IsSame(mesh.Body, this->Mesh.Body))
    {
      this->HasBody = false;
      simulation.SetBody(mesh.Body, keepsState);
    }
    if (!keepsState)
    {
      this->Time = 0.0;
      this->HasMoved = false;
    }
    this->Mesh = std::move(mesh);
    this->BodyStamp = stamp;
    this->Settings = settings;
    this->Simulation = &simulation;
    this->HasBody = true;
    return isLost;
  }

  void ResetBody()
  {
    if (this->HasBody)
    {
      this->Simulation->Reset();
    }
    this->Time = 0.0;
    this->HasMoved = false;
  }

  bool HasBody = false;
  bool HasMoved = false;
  bool IsToReset = false;
  bool Aborted = false;
  BodyMesh Mesh;
  deformvolume::Stamp BodyStamp;
  deformvolume::BodySettings Settings;
  ElasticSimulation* Simulation = nullptr; // that the body was given to
  double Time = 0.0;
};

vtkElasticDeformation::vtkElasticDeformation()
  : Internals(new vtkInternals)
{
  deformvolume::UseVTKThreads();
  this->SetNumberOfInputPorts(2);
}

vtkElasticDeformation::~vtkElasticDeformation() = default;

void vtkElasticDeformation::SetHandlesConnection(vtkAlgorithmOutput* output)
{
  this->SetInputConnection(1, output);
}

void vtkElasticDeformation::SetHandlesData(vtkDataObject* data)
{
  this->SetInputDataObject(1, data);
}

void vtkElasticDeformation::Reset()
{
  this->Internals->IsToReset = true;
  this->Modified();
}

double vtkElasticDeformation::GetTime()
{
  return this->Internals->IsToReset ? 0.0 : this->Internals->Time;
}

int vtkElasticDeformation::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(
    vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkUnstructuredGrid" : "vtkPointSet");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

int vtkElasticDeformation::RequestInformation(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* outputVector)
{
  vtkInformation* output = outputVector->GetInformationObject(0);
  output->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  if (HasTimes(input[0]->GetInformationObject(0)))
  {
    return 1; // the executive has passed them on
  }
  vtkInformation* handles = input[1]->GetInformationObject(0);
  if (HasTimes(handles))
  {
    output->CopyEntry(handles, Pipeline::TIME_STEPS());
    output->CopyEntry(handles, Pipeline::TIME_RANGE());
  }
  else if (this->EndTime > 0.0)
  {
    const double range[2] = { 0.0, this->EndTime };
    output->Set(Pipeline::TIME_RANGE(), range, 2);
  }
  else
  {
    output->Remove(Pipeline::TIME_RANGE());
  }
  return 1;
}

int vtkElasticDeformation::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  for (int port = 0; port < 2; ++port)
  {
    if (vtkInformation* info = input[port]->GetInformationObject(0))
    {
      deformvolume::AskForAll(info);
    }
  }
  return 1;
}

int vtkElasticDeformation::ComputePipelineMTime(vtkInformation* request,
  vtkInformationVector** input, vtkInformationVector* output, int requestFromOutputPort,
  vtkMTimeType* mtime)
{
  // An aborted output is not up to date, but the executive takes it for that.
  if (this->Internals->Aborted)
  {
    this->Internals->Aborted = false;
    this->Modified();
  }
  return this->Superclass::ComputePipelineMTime(
    request, input, output, requestFromOutputPort, mtime);
}

int vtkElasticDeformation::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkUnstructuredGrid::GetData(output)->Initialize();
  try
  {
    this->Execute(input, output);
    return 1;
  }
  catch (const deformvolume::Aborted&)
  {
    this->Internals->Aborted = true;
    return 1;
  }
  catch (const deformvolume::Error& error)
  {
    vtkErrorMacro(<< error.what());
  }
  catch (const std::bad_alloc&)
  {
    vtkErrorMacro("There is not enough memory for the simulation. Use a coarser mesh, or free "
                  "memory.");
  }
  return deformvolume::Fail(this);
}

void vtkElasticDeformation::Execute(
  vtkInformationVector** input, vtkInformationVector* outputVector)
{
  vtkUnstructuredGrid* grid = vtkUnstructuredGrid::GetData(input[0]);
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputVector);
  vtkInformation* info = outputVector->GetInformationObject(0);
  if (!deformvolume::IsFirstPiece(outputVector))
  {
    return;
  }
  vtkInternals& internals = *this->Internals;
  deformvolume::BodySettings settings;
  settings.Material = { this->YoungModulus, this->PoissonRatio, this->Density };
  settings.UnitLength = this->LengthUnit == MILLIMETRE ? 1e-3 : 1.0;
  ElasticSimulation& simulation = this->PrepareSimulation();
  if (internals.Update(simulation, grid, settings))
  {
    vtkWarningMacro("The rest mesh has got other points or cells: the simulation starts anew.");
  }
  ElasticSimulation::Frame frame;
  frame.Held = deformvolume::ReadHandles(
    vtkPointSet::GetData(input[1]), this->HandleRadius, internals.Mesh.Body, settings);
  frame.Loads.Gravity = { this->Gravity[0], this->Gravity[1], this->Gravity[2] };
  frame.Loads.Forces = internals.Mesh.Forces;

  double end = internals.Time;
  if (internals.IsToReset)
  {
    internals.ResetBody();
    internals.IsToReset = false;
    end = 0.0;
  }
  // A time that is a whole number of frames from another one is not less, or more, by round-off.
  const double roundOff = 1e-6 * this->FrameTime;
  if (info->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    end = info->Get(Pipeline::UPDATE_TIME_STEP());
    if (end < internals.Time - roundOff)
    {
      internals.ResetBody();
    }
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), end);
  }
  else
  {
    end += this->GetFreeDuration();
  }
  const double duration = std::max(0.0, end - internals.Time);
  const double longest = simulation.HasFrames() ? this->FrameTime : std::max(duration, 1.0);
  const double frames = std::max(1.0, std::ceil((duration - roundOff) / longest));
  // Observers may draw: they are called now and then only.
  auto next = std::chrono::steady_clock::now();
  for (double done = 0.0; done < frames; done += 1.0)
  {
    frame.Duration = std::min(longest, std::max(0.0, end - internals.Time));
    frame.Progress = [&](double fraction)
    {
      if (std::chrono::steady_clock::now() >= next)
      {
        this->UpdateProgress((done + fraction) / frames);
        next = std::chrono::steady_clock::now() + std::chrono::milliseconds(20);
      }
      return !deformvolume::IsAborted(this);
    };
    simulation.Advance(frame);
    internals.HasMoved = true;
    internals.Time = done + 1.0 == frames ? end : internals.Time + frame.Duration;
  }
  this->NumberOfHeldNodes = static_cast<vtkIdType>(frame.Held.size());

  output->ShallowCopy(grid);
  vtkDataArray* displacements = simulation.WriteOutput(1.0 / settings.UnitLength);
  displacements->Modified();
  output->GetPointData()->SetVectors(displacements);
  if (this->ElementResults)
  {
    AddElementResults(output, internals.Mesh, simulation.GetElementResults());
  }
  if (info->Has(Pipeline::UPDATE_TIME_STEP()))
  {
    output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), end);
  }
}

std::string vtkElasticDeformation::GetSummary()
{
  const vtkInternals& internals = *this->Internals;
  if (!internals.HasBody)
  {
    return std::string();
  }
  std::ostringstream text;
  text << "Nodes: " << internals.Mesh.Body.Points.size() << "\n"
       << "Tetrahedra: " << internals.Mesh.Body.Tetrahedra.size() << "\n"
       << "Nodes that handles hold: " << this->NumberOfHeldNodes << "\n"
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
  os << indent << "LengthUnit: " << (this->LengthUnit == METRE ? "METRE" : "MILLIMETRE") << "\n";
  os << indent << "FrameTime: " << this->FrameTime << "\n";
  os << indent << "EndTime: " << this->EndTime << "\n";
  os << indent << "ElementResults: " << (this->ElementResults ? "on" : "off") << "\n";
  os << indent << "Time: " << this->GetTime() << "\n";
  os << indent << "NumberOfHeldNodes: " << this->NumberOfHeldNodes << "\n";
}
