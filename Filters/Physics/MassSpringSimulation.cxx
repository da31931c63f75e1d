// SPDX-License-Identifier: BSD-3-Clause
#include "MassSpringSimulation.h"

#include <algorithm>
#include <utility>

namespace deformvolume
{
namespace
{

std::vector<glm::dvec3> ToVectors(const std::vector<float>& values)
{
  std::vector<glm::dvec3> vectors(values.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i)
  {
    vectors[i] = glm::dvec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  }
  return vectors;
}

std::vector<float> ToFloats(const std::vector<glm::dvec3>& vectors)
{
  std::vector<float> values;
  values.reserve(vectors.size() * 3);
  for (const glm::dvec3& vector : vectors)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      values.push_back(static_cast<float>(vector[axis]));
    }
  }
  return values;
}

} // namespace

void MassSpringSimulation::SetDevice(const std::string& device, std::uint64_t memoryLimit)
{
  this->Model.SetMemoryLimit(memoryLimit);
  this->Device = this->Model.SetDevice(device);
}

double MassSpringSimulation::GetStableTimeStep()
{
  return this->HasBody() ? this->Model.GetStableTimeStep() : 0.0;
}

void MassSpringSimulation::SetBody(
  const ElasticBody& body, bool keepsState, const std::function<bool()>& progress)
{
  std::vector<float> displacements;
  std::vector<float> velocities;
  if (keepsState)
  {
    displacements = this->Model.GetDisplacements();
    velocities = this->Model.GetVelocities();
  }
  this->Factor = 0.0;
  this->Model.SetBody(body, progress);
  this->Report = keepsState ? this->Report : MassSpringReport();
  this->HasInverted = keepsState && this->HasInverted;
  const auto ratios = std::count_if(body.Materials.begin(), body.Materials.end(),
    [](const ElasticMaterial& material)
    { return material.PoissonRatio < MassSpringModel::LeastPoissonRatio; });
  if (ratios > 0)
  {
    this->Warnings.push_back("The Poisson ratio of " +
      (body.Materials.size() == 1 ? "the body" : std::to_string(ratios) + " tetrahedra") +
      " is less than 0.25, which springs cannot have: it counts as 0.25. Use "
      "finite elements, if the ratio matters.");
  }
  this->NumberOfNodes = body.Points.size();
  if (keepsState)
  {
    // A node that is fixed for a while is at rest when it is freed.
    for (std::size_t node = 0; node < body.Fixed.size(); ++node)
    {
      if (body.IsFixed(node))
      {
        std::fill_n(&velocities[3 * node], 3, 0.0F);
      }
    }
    this->Model.SetState(displacements, velocities);
  }
}

void MassSpringSimulation::SplitNodes(
  const ElasticBody& body, const std::vector<std::int32_t>& origins)
{
  this->Factor = 0.0;
  this->Model.SplitNodes(body, origins);
  this->NumberOfNodes = body.Points.size();
}

void MassSpringSimulation::Advance(const Frame& frame)
{
  if (this->TimeStep > 0.0 && this->TimeStep > this->Model.GetStableTimeStep())
  {
    throw Error("The time step of " + FormatNumber(this->TimeStep * 1e3) +
      " ms is longer than the stable one of " +
      FormatNumber(this->Model.GetStableTimeStep() * 1e3) +
      " ms. Set a shorter one, or 0 to have it chosen.");
  }
  MassSpringRequest request;
  request.Duration = frame.Duration;
  request.TimeStep = this->TimeStep;
  request.Damping = this->Damping;
  request.Held = frame.Held;
  request.Loads = frame.Loads;
  request.Progress = frame.Progress;
  this->Report = this->Model.Advance(request);
  if (!frame.IsLast)
  {
    return; // springs turn many tetrahedra back in later frames
  }
  const bool hadInverted =
    std::exchange(this->HasInverted, this->Report.NumberOfInvertedTetrahedra > 0);
  if (!hadInverted && this->HasInverted)
  {
    this->Warnings.push_back(std::to_string(this->Report.NumberOfInvertedTetrahedra) +
      " tetrahedra are inverted (inside out) at the end of the update, and springs can keep them "
      "inverted. Start again from rest with smaller displacements of handles and smaller loads, "
      "move them more slowly, or use finite elements.");
  }
}

ElasticSimulation::State MassSpringSimulation::GetState()
{
  return { ToVectors(this->Model.GetDisplacements()), ToVectors(this->Model.GetVelocities()) };
}

void MassSpringSimulation::Return(const ElasticBody& body, const State& state)
{
  this->SplitNodes(body, {});
  this->Model.SetState(ToFloats(state.Displacements), ToFloats(state.Velocities));
}

vtkDataArray* MassSpringSimulation::WriteOutput(double factor)
{
  if (factor != this->Factor)
  {
    this->Factor = 0.0;
    this->Output.Make(
      this->Model, this->Device, static_cast<vtkIdType>(this->NumberOfNodes), factor);
    this->Factor = factor;
  }
  // The model has written the output at the end of its last frame.
  this->Output.Restore();
  return this->Output.GetArray();
}

} // namespace deformvolume
