// SPDX-License-Identifier: BSD-3-Clause
// Measures frames of a simulated body: a step of the simulation, and an update of the volume that
// the body deforms.
#include "Evaluation.h"
#include "Timing.h"

#include "../Reported.h"
#include "vtkDeformationHandleSource.h"
#include "vtkFiniteElementDeformation.h"
#include "vtkLatticeTetrahedraSource.h"
#include "vtkMassSpringDeformation.h"

#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

namespace
{

// Distance by which a handle moves in a frame, relative to the height of the body. In one step of
// springs it moves less, because a step is about 1/50 of a frame.
constexpr double FrameLength = 0.005;
constexpr double StepLength = 0.0001;
constexpr double FrameTime = 1.0 / 60.0;

// A body of cubes, or nearly cubes, over a volume. It is held at its lower end, and a handle in the
// middle of the upper end moves to and fro.
struct Body
{
  Body(vtkImageData* volume, const std::array<int, 3>& nodes)
  {
    double bounds[6];
    volume->GetBounds(bounds);
    // Springs are isotropic only on lattices of cubes.
    double edge = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      edge = std::max(edge, (bounds[2 * axis + 1] - bounds[2 * axis]) / (nodes[axis] - 1));
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      bounds[2 * axis + 1] = bounds[2 * axis] + edge * (nodes[axis] - 1);
    }
    this->Height = bounds[5] - bounds[4];
    vtkNew<vtkLatticeTetrahedraSource> lattice;
    lattice->SetNumberOfNodes(nodes.data());
    lattice->SetBounds(bounds);
    lattice->Update();
    this->Mesh->ShallowCopy(lattice->GetOutput());
    vtkNew<vtkUnsignedCharArray> fixed;
    fixed->SetName("Fixed");
    for (vtkIdType i = 0; i < this->Mesh->GetNumberOfPoints(); ++i)
    {
      fixed->InsertNextValue(this->Mesh->GetPoint(i)[2] == bounds[4] ? 1 : 0);
    }
    this->Mesh->GetPointData()->AddArray(fixed);
    this->Rest[0] = 0.5 * (bounds[0] + bounds[1]);
    this->Rest[1] = 0.5 * (bounds[2] + bounds[3]);
    this->Rest[2] = bounds[5];
    this->Handle->SetRestPosition(this->Rest);
    this->Handle->SetPosition(this->Rest);
    this->Radius = 1.5 * edge;
  }

  void MoveHandle()
  {
    constexpr int turn = 20; // number of frames after which the handle moves back
    const int step = ++this->Step % (2 * turn);
    const double length = this->Length * this->Height * std::min(step, 2 * turn - step);
    this->Handle->SetPosition(this->Rest[0] + length, this->Rest[1], this->Rest[2]);
  }

  vtkNew<vtkUnstructuredGrid> Mesh;
  vtkNew<vtkDeformationHandleSource> Handle;
  double Rest[3];
  double Height;
  double Radius;
  double Length = FrameLength;
  int Step = 0;
};

// A simulation of a body, and the filter that deforms the volume.
template <typename Simulation>
struct SimulatedVolume
{
  SimulatedVolume(vtkImageData* volume, const std::array<int, 3>& nodes, int samplingFactor)
    : Simulated(volume, nodes)
  {
    this->Filter->SetInputData(volume);
    this->Filter->SetSamplingFactor(samplingFactor);
    this->Filter->IncrementalOff(); // the whole output is resampled, as in the published evaluation
    this->Model->SetInputData(this->Simulated.Mesh);
    this->Model->SetHandlesConnection(this->Simulated.Handle->GetOutputPort());
    this->Model->SetHandleRadius(this->Simulated.Radius);
    this->Model->SetLengthUnitToMillimetre();
    if (auto* elements = vtkFiniteElementDeformation::SafeDownCast(this->Model))
    {
      elements->SetModeToInteractive(); // as in a live session
    }
    this->Filter->SetDeformationConnection(this->Model->GetOutputPort());
    this->Model->Update();
  }

  Measurement MeasureFrame()
  {
    this->Simulated.MoveHandle();
    Measurement measurement;
    const double simulation = Time([&] { this->Model->Update(); });
    measurement.Seconds = simulation + Time([&] { this->Filter->Update(); });
    if (this->Filter->GetNumberOfCoveredVoxels() == 0)
    {
      throw std::runtime_error("nothing was deformed");
    }
    measurement.Counters["simulation"] = simulation;
    measurement.Counters["mapping"] = GetReportedSeconds(this->Filter, "Seconds for mapping");
    measurement.Counters["resampling"] = GetReportedSeconds(this->Filter, "Seconds for resampling");
    measurement.Counters["nodes"] =
      static_cast<double>(this->Model->GetOutput()->GetNumberOfPoints());
    measurement.Counters["tetrahedra"] =
      static_cast<double>(this->Simulated.Mesh->GetNumberOfCells());
    measurement.Counters["device_bytes"] = static_cast<double>(this->Filter->GetDeviceMemory());
    return measurement;
  }

  Body Simulated;
  vtkNew<Simulation> Model;
  vtkNew<vtkDeformVolumeFilter> Filter;
};

using Springs = SimulatedVolume<vtkMassSpringDeformation>;
using Elements = SimulatedVolume<vtkFiniteElementDeformation>;

struct SpringFrames
{
  std::string Name;
  std::array<int, 3> Volume;
  std::array<int, 3> Nodes;
  bool IsRealTime; // true: all steps of a frame of 1/60 s; false: one step
  int SamplingFactor;
};

void RegisterSprings(const SpringFrames& frames, int rounds)
{
  RegisterRounds<Springs>("Physics/" + frames.Name, rounds,
    [frames]()
    {
      auto springs =
        std::make_shared<Springs>(MakeVolume(frames.Volume), frames.Nodes, frames.SamplingFactor);
      springs->Simulated.Length = frames.IsRealTime ? FrameLength : StepLength;
      springs->Model->SetFrameTime(
        frames.IsRealTime ? FrameTime : springs->Model->GetTimeStepInUse());
      return springs;
    },
    { { "frame",
      [](Springs& springs)
      {
        Measurement measurement = springs.MeasureFrame();
        measurement.Counters["steps"] = static_cast<double>(springs.Model->GetNumberOfSteps());
        return measurement;
      } } });
}

void RegisterElements(const std::string& name, const std::array<int, 3>& nodes, int rounds)
{
  RegisterRounds<Elements>("Physics/" + name, rounds,
    [nodes]() { return std::make_shared<Elements>(MakeVolume(BenchmarkVolume), nodes, 1); },
    { { "frame",
      [](Elements& elements)
      {
        Measurement measurement = elements.MeasureFrame();
        measurement.Counters["residual"] = elements.Model->GetRelativeResidual();
        return measurement;
      } } });
}

} // namespace

void RegisterPhysics(const EvaluationSize& size)
{
  constexpr std::array<int, 3> head{ { 181, 217, 181 } }; // the size of ch2
  const int rounds = size.GetRounds();
  // The numbers of nodes are as close to 2,197 and 512,000 as cubes over these volumes allow.
  for (const SpringFrames& frames :
    { SpringFrames{ "springs-2431", BenchmarkVolume, { { 11, 17, 13 } }, false, 1 },
      SpringFrames{ "springs-507584", BenchmarkVolume, { { 64, 103, 77 } }, false, 1 },
      SpringFrames{ "springs-2197-60Hz", head, { { 13, 13, 13 } }, true, 1 },
      SpringFrames{ "springs-2197-60Hz-half", head, { { 13, 13, 13 } }, true, 2 },
      // Bodies that are cubes, over small volumes. One has as many nodes as a scene that was
      // measured with SOFA.
      SpringFrames{ "springs-2197", { { 13, 13, 13 } }, { { 13, 13, 13 } }, false, 1 },
      SpringFrames{ "springs-4096", { { 16, 16, 16 } }, { { 16, 16, 16 } }, false, 1 },
      SpringFrames{ "springs-512000", { { 80, 80, 80 } }, { { 80, 80, 80 } }, false, 1 } })
  {
    RegisterSprings(frames, rounds);
  }
  // These numbers are those of lattices of corners. Most nodes are mid-side nodes.
  RegisterElements("elements-117", { { 3, 3, 3 } }, rounds);
  RegisterElements("elements-3193", { { 6, 10, 9 } }, rounds);
  RegisterElements("elements-19307", { { 9, 38, 9 } }, rounds);
}
