// SPDX-License-Identifier: BSD-3-Clause
#include "MassSpringModel.h"

#include "AbortCheck.h"
#include "DeviceVectorsInternals.h"
#include "GuardedCall.h"
#include "HostMemory.h"
#include "MassSpringResults.h"
#include "MassSpringState.h"
#include "MemoryBudget.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace deformvolume
{
namespace
{

// A larger displacement, divided by the size of the body, means that the simulation diverged.
constexpr double LargestDisplacementBySize = 1e4;
// The default time step, as a fraction of the stable one: compressed tetrahedra vibrate faster than
// tetrahedra at rest.
constexpr double PartOfStable = 0.75;
// Wait for the device, and call the progress function, about this often.
constexpr std::chrono::milliseconds Batch(20);

void CheckTimes(const MassSpringRequest& request)
{
  const auto check = [](double value, const char* name)
  {
    if (!(value >= 0.0) || !std::isfinite(value))
    {
      throw Error(std::string("The ") + name + " is " + FormatNumber(value) +
        ". It must be a finite number, 0 or more.");
    }
  };
  check(request.Duration, "duration");
  check(request.TimeStep, "time step");
  check(request.Damping, "damping");
}

} // namespace

class MassSpringModel::Internals
{
public:
  Internals()
    : Budget(this->Device, [this] { return this->State ? this->State->GetMemory() : 0; })
  {
  }

  template <typename Function>
  auto Guard(Function&& function)
  {
    const MemoryBudget::UpdateGuard update(this->Budget);
    return CallGuarded(
      function, [this] { this->Forget(); }, " The state of the springs is lost.");
  }

  void CheckIsSet() const
  {
    if (!this->State)
    {
      throw Error("No body is set: call SetBody first.");
    }
  }

  void Forget()
  {
    this->State.reset();
    this->Network.reset();
  }

  void CheckSize(const ElasticBody& body);
  void Make(AbortCheck& abortCheck, const ElasticBody& body, double cubeEdge);
  void Hold(const std::vector<HeldNode>& held);
  void Run(const MassSpringRequest& request, const MassSpringStep& step, std::int64_t steps);

  WorkDevice Device;
  MemoryBudget Budget;
  ElasticBody Body;
  double CubeEdge = 0.0; // in m
  std::unique_ptr<MassSpringNetwork> Network;
  std::unique_ptr<MassSpringState> State;
  std::vector<std::int32_t> HeldBefore;
};

void MassSpringModel::Internals::CheckSize(const ElasticBody& body)
{
  constexpr std::size_t valuesOfTetrahedron = 12;
  constexpr std::size_t mostLanes = 16;
  if (body.Tetrahedra.size() >
    std::numeric_limits<std::uint32_t>::max() / valuesOfTetrahedron - mostLanes)
  {
    throw Error("The mesh has too many tetrahedra for springs: at most 357,913,925. Use a coarser "
                "mesh.");
  }
  if (body.Points.size() > std::numeric_limits<std::int32_t>::max() / 3)
  {
    throw Error(
      "The mesh has too many nodes for springs: at most 715,827,882. Use a coarser mesh.");
  }
  const std::uint64_t allocation = body.Tetrahedra.size() * valuesOfTetrahedron * sizeof(float);
  CheckAllocation(allocation, this->Device.GetAllocationLimit(), "The springs of the tetrahedra",
    "Use a coarser mesh");
}

void MassSpringModel::Internals::Make(
  AbortCheck& abortCheck, const ElasticBody& body, double cubeEdge)
{
  abortCheck.Check();
  auto network = std::make_unique<MassSpringNetwork>(
    abortCheck, body, MassSpringState::GetLanes(this->Device), cubeEdge);
  abortCheck.Check();
  // From here on the body is set without an abort. The previous body is deleted first, so its
  // memory is available.
  const std::uint64_t needed =
    MassSpringState::GetNeededMemory(body.Points.size(), body.Tetrahedra.size());
  const std::uint64_t held = this->State ? this->State->GetMemory() : 0;
  this->Budget.CheckRoomFor(needed - std::min(held, needed), "on the device", "Use a coarser mesh");
  this->Forget();
  this->Body = body;
  this->CubeEdge = cubeEdge;
  this->Network = std::move(network);
  this->State = std::make_unique<MassSpringState>(this->Device, *this->Network);
  this->HeldBefore.clear();
}

void MassSpringModel::Internals::Hold(const std::vector<HeldNode>& held)
{
  std::vector<std::int32_t> nodes(held.size());
  std::transform(
    held.begin(), held.end(), nodes.begin(), [](const HeldNode& node) { return node.Node; });
  if (nodes != this->HeldBefore)
  {
    std::vector<float> mobilities = this->Network->Mobilities;
    for (const std::int32_t node : nodes)
    {
      mobilities[static_cast<std::size_t>(node)] = 0.0F;
    }
    this->State->SetMobilities(mobilities);
    this->HeldBefore = nodes;
  }
  std::vector<MassSpringHandle> handles(held.size());
  const std::vector<float> now =
    held.empty() ? std::vector<float>() : this->State->GetDisplacements();
  for (std::size_t i = 0; i < held.size(); ++i)
  {
    handles[i].Node = held[i].Node;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      handles[i].Begin[axis] = now[3 * static_cast<std::size_t>(held[i].Node) + axis];
      handles[i].End[axis] = static_cast<float>(held[i].Displacement[static_cast<int>(axis)]);
    }
  }
  this->State->SetHandles(handles);
}

void MassSpringModel::Internals::Run(
  const MassSpringRequest& request, const MassSpringStep& step, std::int64_t steps)
{
  std::int64_t batch = 1;
  for (std::int64_t done = 0; done < steps;)
  {
    const auto begin = std::chrono::steady_clock::now();
    const std::int64_t end = std::min(steps, done + batch);
    for (; done < end; ++done)
    {
      const double fraction = static_cast<double>(done + 1) / static_cast<double>(steps);
      this->State->EnqueueStep(
        step, static_cast<float>(fraction), static_cast<float>(1.0 / request.Duration));
    }
    this->State->Finish();
    if (this->State->TakeDivergence())
    {
      throw Error("The simulation has diverged with a time step of " +
        FormatNumber(step.TimeStep * 1e3) +
        " ms. The body is as it was before. Use a shorter "
        "time step, move handles less at a time, or use smaller forces.");
    }
    const auto taken = std::chrono::steady_clock::now() - begin;
    batch = taken * 2 < Batch ? batch * 2
      : taken > Batch         ? std::max<std::int64_t>(batch / 2, 1)
                              : batch;
    if (request.Progress &&
      !request.Progress(static_cast<double>(done) / static_cast<double>(steps)))
    {
      throw Aborted();
    }
  }
}

MassSpringModel::MassSpringModel()
  : Impl(new Internals)
{
}

MassSpringModel::~MassSpringModel() = default;

std::string MassSpringModel::SetDevice(const std::string& request)
{
  return this->Impl->Guard(
    [&] { return this->Impl->Device.Choose(request, [&] { this->Impl->Forget(); }); });
}

void MassSpringModel::SetMemoryLimit(std::uint64_t bytes)
{
  this->Impl->Budget.SetLimit(bytes);
}

void MassSpringModel::SetWorkGroupSize(std::size_t size)
{
  this->Impl->Device.SetWorkGroupSize(size);
}

void MassSpringModel::SetBody(const ElasticBody& body, const std::function<bool()>& progress)
{
  AbortCheck abortCheck(progress);
  abortCheck.Check();
  CheckBody(body, &abortCheck);
  const double cubeEdge = FindCubeEdge(abortCheck, body);
  Internals& impl = *this->Impl;
  impl.Guard(
    [&]
    {
      impl.Device.GetContext();
      impl.CheckSize(body);
      impl.Make(abortCheck, body, cubeEdge);
    });
}

void MassSpringModel::SplitNodes(const ElasticBody& body, const std::vector<std::int32_t>& origins)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  CheckBody(body);
  const std::size_t before = impl.Body.Points.size();
  if (body.Tetrahedra.size() != impl.Body.Tetrahedra.size() ||
    body.Points.size() > before + origins.size() ||
    (!origins.empty() && body.Points.size() < before + origins.size()) ||
    std::any_of(origins.begin(), origins.end(),
      [&](std::int32_t node) { return node < 0 || static_cast<std::size_t>(node) >= before; }))
  {
    throw Error("A body of " + std::to_string(before) + " nodes and " +
      std::to_string(impl.Body.Tetrahedra.size()) + " tetrahedra cannot be split into one of " +
      std::to_string(body.Points.size()) + " nodes and " + std::to_string(body.Tetrahedra.size()) +
      " tetrahedra with " + std::to_string(origins.size()) +
      " origins. The number of tetrahedra must stay the same, "
      "and each appended node must have one of the old nodes as its origin.");
  }
  impl.Guard(
    [&]
    {
      std::vector<float> displacements = impl.State->GetDisplacements();
      std::vector<float> velocities = impl.State->GetVelocities();
      for (const std::int32_t origin : origins)
      {
        for (std::size_t axis = 0; axis < 3; ++axis)
        {
          displacements.push_back(displacements[3 * static_cast<std::size_t>(origin) + axis]);
          velocities.push_back(velocities[3 * static_cast<std::size_t>(origin) + axis]);
        }
      }
      displacements.resize(body.Points.size() * 3);
      velocities.resize(body.Points.size() * 3);
      AbortCheck abortCheck(nullptr);
      impl.Make(abortCheck, body, impl.CubeEdge);
      impl.State->SetDisplacements(displacements);
      impl.State->SetVelocities(velocities);
    });
}

void MassSpringModel::SetOutput(float* output, double factor)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  if (!output)
  {
    throw Error("The output of the mass-spring simulation is null.");
  }
  impl.Guard(
    [&]
    {
      impl.State->SetOutput(output, static_cast<float>(factor));
      impl.State->WriteOutput();
    });
}

void MassSpringModel::SetOutput(const std::shared_ptr<DeviceVectors>& output, double factor)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  CheckVectors(output.get(), impl.Device, impl.State->GetNumberOfNodes());
  impl.Guard(
    [&]
    {
      impl.State->SetOutput(output, static_cast<float>(factor));
      impl.State->WriteOutput();
    });
}

double MassSpringModel::GetStableTimeStep() const
{
  this->Impl->CheckIsSet();
  return this->Impl->Network->StableTimeStep;
}

MassSpringReport MassSpringModel::Advance(const MassSpringRequest& request)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  CheckTimes(request);
  CheckHeldNodes(impl.Body, request.Held);
  CheckLoads(impl.Body, request.Loads);
  return impl.Guard(
    [&]
    {
      MassSpringReport report;
      if (request.Duration > 0.0)
      {
        const std::vector<float>& mobilities = impl.Network->Mobilities;
        if (std::count(mobilities.begin(), mobilities.end(), 0.0F) ==
          static_cast<std::ptrdiff_t>(mobilities.size()))
        {
          throw Error("All nodes of the mesh are fixed: there is nothing to simulate.");
        }
        const double longest =
          request.TimeStep > 0.0 ? request.TimeStep : PartOfStable * impl.Network->StableTimeStep;
        // The duration may exceed a whole number of steps by a rounding error.
        constexpr double hair = 1e-9;
        const double steps = std::max(1.0, std::ceil(request.Duration / longest * (1.0 - hair)));
        report.NumberOfSteps = static_cast<std::int64_t>(steps);
        report.TimeStep = request.Duration / steps;
        MassSpringStep step{};
        step.TimeStep = static_cast<float>(report.TimeStep);
        // The exact solution of dv/dt = a - damping * v for a constant acceleration a, so that the
        // velocity tends to a / damping whatever the time step is.
        step.Retained = static_cast<float>(std::exp(-request.Damping * report.TimeStep));
        step.Impulse = static_cast<float>(request.Damping > 0.0
            ? -std::expm1(-request.Damping * report.TimeStep) / request.Damping
            : report.TimeStep);
        for (int axis = 0; axis < 3; ++axis)
        {
          step.Gravity[axis] = static_cast<float>(request.Loads.Gravity[axis]);
        }
        step.Limit = static_cast<float>(LargestDisplacementBySize * impl.Network->Size);
        step.NumberOfNodes = static_cast<int>(impl.State->GetNumberOfNodes());
        impl.State->SetLoads(request.Loads.Forces);
        impl.Hold(request.Held);
        impl.State->Save();
        try
        {
          impl.Run(request, step, report.NumberOfSteps);
        }
        catch (const cl::Error&)
        {
          throw;
        }
        catch (...)
        {
          impl.State->Restore();
          throw;
        }
      }
      if (impl.State->HasOutput())
      {
        impl.State->WriteOutput();
      }
      report.NumberOfInvertedTetrahedra = impl.State->CountInverted();
      return report;
    });
}

void MassSpringModel::Reset()
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  impl.Guard(
    [&]
    {
      const std::vector<float> zeros(impl.State->GetNumberOfNodes() * 3, 0.0F);
      impl.State->SetDisplacements(zeros);
      impl.State->SetVelocities(zeros);
      if (impl.State->HasOutput())
      {
        impl.State->WriteOutput();
      }
    });
}

std::vector<float> MassSpringModel::GetDisplacements()
{
  this->Impl->CheckIsSet();
  return this->Impl->Guard([&] { return this->Impl->State->GetDisplacements(); });
}

std::vector<float> MassSpringModel::GetVelocities()
{
  this->Impl->CheckIsSet();
  return this->Impl->Guard([&] { return this->Impl->State->GetVelocities(); });
}

void MassSpringModel::SetState(
  const std::vector<float>& displacements, const std::vector<float>& velocities)
{
  Internals& impl = *this->Impl;
  impl.CheckIsSet();
  const std::size_t values = impl.State->GetNumberOfNodes() * 3;
  const auto isFinite = [](float value) { return std::isfinite(value); };
  if (displacements.size() != values || velocities.size() != values ||
    !std::all_of(displacements.begin(), displacements.end(), isFinite) ||
    !std::all_of(velocities.begin(), velocities.end(), isFinite))
  {
    throw Error("The state of the springs needs three finite components of the displacement and of "
                "the velocity of each node.");
  }
  impl.Guard(
    [&]
    {
      impl.State->SetDisplacements(displacements);
      impl.State->SetVelocities(velocities);
    });
}

std::vector<float> MassSpringModel::GetForces()
{
  this->Impl->CheckIsSet();
  return this->Impl->Guard([&] { return this->Impl->State->ComputeForces(); });
}

std::vector<ElementResults> MassSpringModel::GetElementResults()
{
  const std::vector<float> displacements = this->GetDisplacements();
  return ComputeMassSpringResults(this->Impl->Body, displacements, this->Impl->CubeEdge);
}

std::uint64_t MassSpringModel::GetDeviceMemory() const
{
  return this->Impl->State ? this->Impl->State->GetMemory() : 0;
}

} // namespace deformvolume
