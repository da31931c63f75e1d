// SPDX-License-Identifier: BSD-3-Clause
#include "CorotationalSimulation.h"

#include <new>

namespace deformvolume
{

void CorotationalSimulation::SetBody(
  const ElasticBody& body, bool keepsState, const std::function<bool()>& progress)
{
  const std::vector<glm::dvec3> displacements =
    keepsState ? this->Model.GetDisplacements() : std::vector<glm::dvec3>();
  this->Model.SetBody(body, progress);
  if (keepsState)
  {
    this->Model.SetDisplacements(displacements);
  }
}

void CorotationalSimulation::SplitNodes(
  const ElasticBody& body, const std::vector<std::int32_t>& origins)
{
  std::vector<glm::dvec3> displacements = this->Model.GetDisplacements();
  for (const std::int32_t origin : origins)
  {
    displacements.push_back(displacements[static_cast<std::size_t>(origin)]);
  }
  this->Model.SetBody(body);
  this->Model.SetDisplacements(displacements);
}

void CorotationalSimulation::Return(const ElasticBody& body, const State& state)
{
  this->Model.SetBody(body);
  this->Model.SetDisplacements(state.Displacements);
}

void CorotationalSimulation::Advance(const Frame& frame)
{
  constexpr double someProgress = 0.5; // nobody knows how much there is to do
  CorotationalRequest request;
  request.Held = frame.Held;
  request.Loads = frame.Loads;
  request.Mode = this->Mode;
  request.Progress = [&] { return frame.Progress(someProgress); };
  this->Report = this->Model.Solve(request);
}

vtkDataArray* CorotationalSimulation::WriteOutput(double factor)
{
  constexpr int components = 3;
  const std::vector<glm::dvec3>& displacements = this->Model.GetDisplacements();
  const auto nodes = static_cast<vtkIdType>(displacements.size());
  if (!this->Output || this->Output->GetNumberOfTuples() != nodes)
  {
    this->Output = vtkSmartPointer<vtkFloatArray>::New();
    this->Output->SetName("Displacement");
    this->Output->SetNumberOfComponents(components);
    if (!this->Output->Resize(nodes))
    {
      throw std::bad_alloc();
    }
    this->Output->SetNumberOfTuples(nodes);
  }
  float* value = this->Output->GetPointer(0);
  for (const glm::dvec3& displacement : displacements)
  {
    for (int axis = 0; axis < components; ++axis)
    {
      *value++ = static_cast<float>(displacement[axis] * factor);
    }
  }
  return this->Output;
}

} // namespace deformvolume
