// SPDX-License-Identifier: BSD-3-Clause
// Measures the time of a live session from an event, such as a mouse move or a cut, to the new
// volume.
#include "Evaluation.h"
#include "Timing.h"

#include "vtkDeformVolumeSession.h"

#include <vtkCellArray.h>
#include <vtkImageData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

constexpr std::array<int, 3> Head{ { 181, 217, 181 } }; // the size of ch2

// A session in which a handle is dragged to and fro. It holds the last output, as a viewer does.
class LiveBody
{
public:
  LiveBody(int model, int nodes, double radius)
  {
    this->Session->SetInputs(MakeVolume(Head));
    this->Session->ChangeNumberOfNodes(nodes);
    this->Session->ChangeModel(model);
    this->Session->ChangeHandleRadius(radius);
    this->Update();
    double bounds[6];
    this->Output->GetBounds(bounds);
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Rest[axis] = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1]);
    }
    this->Handle = this->Session->BeginGrab(this->Rest[0], this->Rest[1], this->Rest[2]);
    this->Update();
  }

  Measurement Drag()
  {
    return this->Measure(
      [this]
      {
        constexpr int turn = 8; // number of frames after which the handle moves back
        const int step = ++this->Step % (2 * turn);
        this->Session->MoveGrab(this->Handle, this->Rest[0] + std::min(step, 2 * turn - step),
          this->Rest[1], this->Rest[2]);
      });
  }

  // Cuts with a sheet of 50 x 50 voxels beside the handle. The cut is undone after the measurement.
  Measurement Cut()
  {
    constexpr int side = 5; // number of points on each side
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> triangles;
    for (int j = 0; j < side; ++j)
    {
      for (int i = 0; i < side; ++i)
      {
        points->InsertNextPoint(this->Rest[0] + 5.25 + 0.75 * i, this->Rest[1] - 25.0 + 12.5 * i,
          this->Rest[2] - 25.0 + 12.5 * j);
        if (i > 0 && j > 0)
        {
          const vtkIdType last = side * j + i;
          triangles->InsertNextCell({ last - side - 1, last - side, last });
          triangles->InsertNextCell({ last - side - 1, last, last - 1 });
        }
      }
    }
    vtkNew<vtkPolyData> sheet;
    sheet->SetPoints(points);
    sheet->SetPolys(triangles);
    return this->MeasureAndUndo([&] { this->Session->Cut(sheet); });
  }

  Measurement Carve()
  {
    return this->MeasureAndUndo([this]
      { this->Session->CarveSphere(this->Rest[0] + 25.0, this->Rest[1], this->Rest[2], 8.0); });
  }

private:
  void Update()
  {
    this->Session->Update();
    // Release the previous output when there is a new one, as a viewer does.
    const auto output = vtkSmartPointer<vtkImageData>::Take(this->Session->TakeOutput());
    if (!output || !this->Session->GetErrorMessage().empty())
    {
      throw std::runtime_error("there is no output: " + this->Session->GetErrorMessage());
    }
    this->Output = output;
  }

  template <typename Event>
  Measurement Measure(const Event& event)
  {
    Measurement measurement;
    measurement.Seconds = Time(
      [&]
      {
        event();
        this->Update();
      });
    measurement.Counters["simulation"] = this->Session->GetSimulationTime();
    measurement.Counters["resampling"] = this->Session->GetResamplingTime();
    measurement.Counters["moved"] = static_cast<double>(this->Session->GetNumberOfMovedVoxels());
    return measurement;
  }

  template <typename Event>
  Measurement MeasureAndUndo(const Event& event)
  {
    const Measurement measurement = this->Measure(event);
    this->Session->Undo();
    this->Update();
    // Undo has released the handle.
    this->Handle = this->Session->BeginGrab(this->Rest[0], this->Rest[1], this->Rest[2]);
    this->Update();
    return measurement;
  }

  vtkNew<vtkDeformVolumeSession> Session;
  vtkSmartPointer<vtkImageData> Output;
  double Rest[3];
  int Handle = -1;
  int Step = 0;
};

} // namespace

void RegisterSession(const EvaluationSize& size)
{
  using Session = vtkDeformVolumeSession;
  struct Case
  {
    const char* Name;
    int Model;
    int Nodes;
    double Radius;
  };
  for (const Case& one :
    { Case{ "at-rest", Session::NONE, 7, 0.0 }, Case{ "chain-mail", Session::CHAIN_MAIL, 7, 6.0 },
      Case{ "springs-343", Session::MASS_SPRING, 7, 0.0 },
      Case{ "elements-117", Session::FINITE_ELEMENTS, 5, 0.0 },
      Case{ "elements-665", Session::FINITE_ELEMENTS, 9, 0.0 } })
  {
    std::vector<Contestant<LiveBody>> contestants;
    if (one.Model != Session::NONE)
    {
      contestants.push_back({ "drag", [](LiveBody& body) { return body.Drag(); } });
    }
    contestants.push_back({ "cut", [](LiveBody& body) { return body.Cut(); } });
    contestants.push_back({ "carve", [](LiveBody& body) { return body.Carve(); } });
    RegisterRounds<LiveBody>(
      std::string("Session/") + one.Name, size.GetRounds(),
      [one]() { return std::make_shared<LiveBody>(one.Model, one.Nodes, one.Radius); },
      contestants);
  }
}
