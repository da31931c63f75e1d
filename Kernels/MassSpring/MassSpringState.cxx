// SPDX-License-Identifier: BSD-3-Clause
#include "MassSpringState.h"

#include "DeviceVectorsInternals.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "KernelSources.h"
#include "KernelText.h"

#include <algorithm>
#include <string>

namespace deformvolume
{
namespace
{

constexpr std::uint64_t BytesOfNode = 10 * sizeof(float) + sizeof(cl_uint);
constexpr std::uint64_t BytesOfNodeSaved = 9 * sizeof(float); // saved state and sums of forces
constexpr std::uint64_t BytesOfTetrahedron = (4 + 4) * sizeof(cl_int) + (2 + 4 * 3) * sizeof(float);

} // namespace

int MassSpringState::GetLanes(WorkDevice& device)
{
  return device.GetDevice().HasVectors ? deformvolume::GetLanes(device.GetContext()) : 1;
}

std::uint64_t MassSpringState::GetNeededMemory(std::size_t nodes, std::size_t tetrahedra)
{
  return nodes * (BytesOfNode + BytesOfNodeSaved) + tetrahedra * BytesOfTetrahedron;
}

std::uint64_t MassSpringState::GetMemory() const
{
  return deformvolume::GetMemory(this->Tetrahedra, this->Materials, this->RestPoints, this->Begins,
    this->ForceIndices, this->Mobilities, this->Forces, this->Displacements, this->Velocities,
    this->Loads, this->Handles, this->HasDiverged, this->Sums, this->SavedDisplacements,
    this->SavedVelocities);
}

MassSpringState::MassSpringState(WorkDevice& device, const MassSpringNetwork& network)
  : Device(device)
  , NumberOfNodes(network.Masses.size())
  , NumberOfPackets(network.NumberOfPackets)
{
  OpenCLContext& context = device.GetContext();
  ProgramText text = "#define LANES " + std::to_string(network.Lanes) + "\n";
  if (network.Lanes > 1)
  {
    text += LaneVectors_cl;
  }
  text += ProgramText(MassSpringParameters_h) + MassSpringForces_cl + MassSpringMotion_cl;
  this->Program = context.GetProgram(text, KernelOptions);
  device.Send(this->Tetrahedra, network.Tetrahedra);
  device.Send(this->Materials, network.Materials);
  device.Send(this->RestPoints, network.RestPoints);
  device.Send(this->Begins, network.Begins);
  device.Send(this->ForceIndices, network.ForceIndices);
  device.Send(this->Mobilities, network.Mobilities);
  const std::vector<float> zeros(this->NumberOfNodes * 3, 0.0F);
  device.Send(this->Displacements, zeros);
  device.Send(this->Velocities, zeros);
  const cl_int none = 0;
  device.Send(this->HasDiverged, &none, sizeof(none));
  device.Send(this->Inverted, &none, sizeof(none));
  Reserve(context, this->Forces,
    this->NumberOfPackets * 12 * static_cast<std::size_t>(network.Lanes) * sizeof(float));
  const auto nodes = static_cast<cl_uint>(this->NumberOfNodes);
  this->ComputeForcesKernel =
    MakeKernel(this->Program, "ComputeForces", this->Tetrahedra, this->Materials, this->RestPoints,
      this->Displacements, this->Forces, static_cast<cl_uint>(this->NumberOfPackets));
  this->CountInvertedKernel =
    MakeKernel(this->Program, "CountInverted", this->Tetrahedra, this->RestPoints,
      this->Displacements, this->Inverted, static_cast<cl_uint>(this->NumberOfPackets));
  this->AddForcesKernel = MakeKernel(
    this->Program, "AddForces", this->Begins, this->ForceIndices, this->Forces, this->Sums, nodes);
  this->MoveNodesKernel = MakeKernel(this->Program, "MoveNodes", this->Begins, this->ForceIndices,
    this->Forces, this->Mobilities, this->Loads, this->Velocities, this->Displacements,
    this->HasDiverged, MassSpringStep{}, cl_int{ 0 });
  this->MoveHandlesKernel = cl::Kernel(this->Program, "MoveHandles");
  SetArguments(this->MoveHandlesKernel, 1, this->Velocities, this->Displacements);
  this->WriteOutputKernel = cl::Kernel(this->Program, "WriteOutput");
  this->WriteOutputKernel.setArg(0, this->Displacements);
  this->WriteOutputKernel.setArg(3, nodes * 3);
}

std::vector<float> MassSpringState::Read(const cl::Buffer& buffer)
{
  std::vector<float> values(this->NumberOfNodes * 3);
  BeginToReadRange(this->Device.GetQueue(), buffer, 0, values.size() * sizeof(float), values.data())
    .Check();
  return values;
}

void MassSpringState::SetMobilities(const std::vector<float>& mobilities)
{
  this->Device.Send(this->Mobilities, mobilities);
}

void MassSpringState::SetLoads(const std::vector<glm::dvec3>& forces)
{
  this->HasLoads = !forces.empty();
  if (this->HasLoads)
  {
    std::vector<float> values(this->NumberOfNodes * 3);
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      values[i] = static_cast<float>(forces[i / 3][static_cast<int>(i % 3)]);
    }
    this->Device.Send(this->Loads, values);
    this->MoveNodesKernel.setArg(4, this->Loads);
  }
  this->MoveNodesKernel.setArg(9, cl_int{ this->HasLoads });
}

void MassSpringState::SetHandles(const std::vector<MassSpringHandle>& handles)
{
  this->NumberOfHandles = handles.size();
  if (!handles.empty())
  {
    this->Device.Send(this->Handles, handles);
    this->MoveHandlesKernel.setArg(0, this->Handles);
    this->MoveHandlesKernel.setArg(5, static_cast<cl_uint>(handles.size()));
  }
}

void MassSpringState::SetDisplacements(const std::vector<float>& values)
{
  this->Device.Send(this->Displacements, values);
}

void MassSpringState::SetVelocities(const std::vector<float>& values)
{
  this->Device.Send(this->Velocities, values);
}

std::vector<float> MassSpringState::ComputeForces()
{
  Reserve(this->Device.GetContext(), this->Sums, this->NumberOfNodes * 3 * sizeof(float));
  this->AddForcesKernel.setArg(3, this->Sums);
  this->Device.Launch(this->ComputeForcesKernel, this->NumberOfPackets);
  this->Device.Launch(this->AddForcesKernel, this->NumberOfNodes);
  return this->Read(this->Sums);
}

void MassSpringState::EnqueueStep(const MassSpringStep& step, float fraction, float rate)
{
  this->Device.Launch(this->ComputeForcesKernel, this->NumberOfPackets);
  this->MoveNodesKernel.setArg(8, step);
  this->Device.Launch(this->MoveNodesKernel, this->NumberOfNodes);
  if (this->NumberOfHandles > 0)
  {
    SetArguments(this->MoveHandlesKernel, 3, fraction, rate);
    this->Device.Launch(this->MoveHandlesKernel, this->NumberOfHandles);
  }
}

bool MassSpringState::TakeDivergence()
{
  cl_int hasDiverged = 0;
  this->Device.GetQueue().enqueueReadBuffer(
    this->HasDiverged, CL_TRUE, 0, sizeof(hasDiverged), &hasDiverged);
  if (hasDiverged != 0)
  {
    const cl_int none = 0;
    this->Device.Send(this->HasDiverged, &none, sizeof(none));
  }
  return hasDiverged != 0;
}

std::int64_t MassSpringState::CountInverted()
{
  cl_int count = 0;
  this->Device.Send(this->Inverted, &count, sizeof(count));
  this->Device.Launch(this->CountInvertedKernel, this->NumberOfPackets);
  this->Device.GetQueue().enqueueReadBuffer(this->Inverted, CL_TRUE, 0, sizeof(count), &count);
  return count;
}

void MassSpringState::Save()
{
  const std::size_t bytes = this->NumberOfNodes * 3 * sizeof(float);
  OpenCLContext& context = this->Device.GetContext();
  Reserve(context, this->SavedDisplacements, bytes);
  Reserve(context, this->SavedVelocities, bytes);
  const cl::CommandQueue& queue = this->Device.GetQueue();
  queue.enqueueCopyBuffer(this->Displacements, this->SavedDisplacements, 0, 0, bytes);
  queue.enqueueCopyBuffer(this->Velocities, this->SavedVelocities, 0, 0, bytes);
}

void MassSpringState::Restore()
{
  const std::size_t bytes = this->NumberOfNodes * 3 * sizeof(float);
  const cl::CommandQueue& queue = this->Device.GetQueue();
  queue.enqueueCopyBuffer(this->SavedDisplacements, this->Displacements, 0, 0, bytes);
  queue.enqueueCopyBuffer(this->SavedVelocities, this->Velocities, 0, 0, bytes);
  queue.finish();
}

void MassSpringState::SetOutput(float* output, float factor)
{
  this->Output.Bind(this->Device.GetContext(), output, this->NumberOfNodes);
  this->Factor = factor;
}

void MassSpringState::SetOutput(const std::shared_ptr<DeviceVectors>& output, float factor)
{
  this->Output.Bind(this->Device.GetContext(), output);
  this->Factor = factor;
}

void MassSpringState::WriteOutput()
{
  const cl::CommandQueue& queue = this->Device.GetQueue();
  SetArguments(this->WriteOutputKernel, 1, this->Output.GetBuffer(), this->Factor);
  this->Device.Launch(this->WriteOutputKernel, this->NumberOfNodes * 3);
  if (float* const memory = this->Output.GetHostMemory())
  {
    PendingCopies reads;
    reads.Add(BeginToRead(
      queue, this->Output.GetBuffer(), this->NumberOfNodes * 3 * sizeof(float), memory));
    reads.Check();
  }
  queue.finish();
  if (DeviceVectors::Internals* const vectors = this->Output.GetVectors())
  {
    vectors->MarkAllWritten();
  }
}

} // namespace deformvolume
