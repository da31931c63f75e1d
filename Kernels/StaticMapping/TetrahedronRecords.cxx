// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronRecords.h"

#include "HostMemory.h"
#include "KernelMaking.h"
#include "KernelParameters.h"
#include "KernelText.h"

#include <algorithm>
#include <array>

namespace deformvolume
{
namespace
{

constexpr std::size_t NumbersOfRest = DEFORMVOLUME_REST_NUMBERS;

std::array<double, NumbersOfRest> GetNumbers(const RestTetrahedron& tetrahedron)
{
  std::array<double, NumbersOfRest> numbers;
  auto next = std::copy(tetrahedron.Origin.begin(), tetrahedron.Origin.end(), numbers.begin());
  next = std::copy(tetrahedron.Weights.begin(), tetrahedron.Weights.end(), next);
  for (const auto& gradient : tetrahedron.Gradients)
  {
    next = std::copy(gradient.begin(), gradient.end(), next);
  }
  return numbers;
}

} // namespace

TetrahedronRecords::TetrahedronRecords(
  OpenCLContext& context, const cl::CommandQueue& queue, std::uint64_t allocationLimit)
  : Context(context)
  , Queue(queue)
  , AllocationLimit(allocationLimit)
{
}

std::size_t TetrahedronRecords::GetRestSize() const
{
  return NumbersOfRest * (HasDouble(this->Context) ? sizeof(double) : sizeof(float));
}

void TetrahedronRecords::Clear()
{
  this->Rest = this->Owners = this->Records = cl::Buffer();
  this->Count = 0;
  this->Current = false;
}

cl::Buffer TetrahedronRecords::MakeBuffer(std::uint64_t bytes) const
{
  CheckAllocation(
    bytes, this->AllocationLimit, "The tetrahedra of the deformation mesh", "Use a coarser mesh");
  return { this->Context.GetContext(), CL_MEM_READ_WRITE, bytes };
}

void TetrahedronRecords::WriteRest(
  std::size_t record, const RestTetrahedron& tetrahedron, void* rest) const
{
  const auto numbers = GetNumbers(tetrahedron);
  if (HasDouble(this->Context))
  {
    std::copy(numbers.begin(), numbers.end(), static_cast<double*>(rest) + NumbersOfRest * record);
    return;
  }
  std::transform(numbers.begin(), numbers.end(), static_cast<float*>(rest) + NumbersOfRest * record,
    [](double number) { return static_cast<float>(number); });
}

void TetrahedronRecords::Set(const std::vector<RestTetrahedron>& tetrahedra)
{
  this->Clear();
  const std::size_t room = std::max<std::size_t>(tetrahedra.size(), 1); // OpenCL needs size > 0
  this->Rest = this->MakeBuffer(room * this->GetRestSize());
  this->Owners = this->MakeBuffer(room * sizeof(std::int32_t));
  this->Records = this->MakeBuffer(room * sizeof(TetrahedronRecord));
  std::vector<char> rest(tetrahedra.size() * this->GetRestSize());
  std::vector<std::int32_t> owners(tetrahedra.size());
  for (std::size_t i = 0; i < tetrahedra.size(); ++i)
  {
    this->WriteRest(i, tetrahedra[i], rest.data());
    owners[i] = tetrahedra[i].Tetrahedron;
  }
  if (!tetrahedra.empty())
  {
    Write(this->Queue, this->Rest, 0, rest.size(), rest.data());
    Write(this->Queue, this->Owners, 0, owners.size() * sizeof(std::int32_t), owners.data());
  }
  this->Count = tetrahedra.size();
}

cl::Event TetrahedronRecords::Evaluate(
  const cl::Program& mapping, const cl::Buffer& tetrahedra, const cl::Buffer& nodes)
{
  const cl::Kernel kernel = MakeKernel(mapping, "EvaluateTetrahedra", this->Rest, this->Owners,
    tetrahedra, nodes, this->Records, static_cast<cl_uint>(this->Count));
  constexpr std::size_t group = 64;
  // One group more than whole ones: without tetrahedra there must still be one.
  const std::size_t items = (this->Count / group + 1) * group;
  this->Current = true;
  return this->Context.Launch(this->Queue, kernel, cl::NDRange(items), cl::NDRange(group));
}

void TetrahedronRecords::VisitRest(const std::function<void(const double*)>& visit) const
{
  if (HasDouble(this->Context))
  {
    const MappedBuffer<const double> numbers(this->Queue, this->Rest, CL_MAP_READ);
    visit(numbers.Get());
    return;
  }
  const MappedBuffer<const float> numbers(this->Queue, this->Rest, CL_MAP_READ);
  visit(std::vector<double>(numbers.Get(), numbers.Get() + NumbersOfRest * this->Count).data());
}

std::uint64_t TetrahedronRecords::GetMemory() const
{
  return deformvolume::GetMemory(this->Rest, this->Owners, this->Records);
}

} // namespace deformvolume
