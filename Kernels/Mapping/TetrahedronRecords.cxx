// SPDX-License-Identifier: BSD-3-Clause
#include "TetrahedronRecords.h"

#include "HostMemory.h"
#include "KernelParameters.h"
#include "KernelText.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace deformvolume
{
namespace
{

constexpr std::size_t NumbersOfRest = 15;

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

void TetrahedronRecords::Grow(cl::Buffer& buffer, std::uint64_t bytes, std::uint64_t used) const
{
  CheckAllocation(bytes, this->AllocationLimit);
  const cl::Buffer larger(this->Context.GetContext(), CL_MEM_READ_WRITE, bytes);
  if (used > 0)
  {
    this->Queue.enqueueCopyBuffer(buffer, larger, 0, 0, used);
    this->Queue.finish();
  }
  buffer = larger;
}

void TetrahedronRecords::MakeRoom(std::size_t count)
{
  const std::size_t room = std::max<std::size_t>(count, 1); // no buffer is of no bytes
  if (deformvolume::GetMemory(this->Owners) < room * sizeof(std::int32_t))
  {
    this->Grow(this->Rest, room * this->GetRestSize(), this->Count * this->GetRestSize());
    this->Grow(this->Owners, room * sizeof(std::int32_t), this->Count * sizeof(std::int32_t));
    this->Grow(this->Records, (room + 1) * sizeof(TetrahedronRecord), 0); // evaluated anew
  }
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

void TetrahedronRecords::Set(const std::vector<RestTetrahedron>& tetrahedra, const MeshOrder& order)
{
  this->Clear();
  this->MakeRoom(tetrahedra.size());
  std::vector<char> rest(tetrahedra.size() * this->GetRestSize());
  std::vector<std::int32_t> owners(tetrahedra.size());
  for (std::size_t i = 0; i < tetrahedra.size(); ++i)
  {
    this->WriteRest(i, tetrahedra[i], rest.data());
    owners[i] = MeshOrder::Get(order.Tetrahedra, tetrahedra[i].Tetrahedron);
  }
  if (!tetrahedra.empty())
  {
    Write(this->Queue, this->Rest, 0, rest.size(), rest.data());
    Write(this->Queue, this->Owners, 0, owners.size() * sizeof(std::int32_t), owners.data());
  }
  this->Count = tetrahedra.size();
}

std::vector<std::int32_t> TetrahedronRecords::Add(const std::vector<RestTetrahedron>& tetrahedra,
  const MeshOrder& order, const std::vector<std::int32_t>& removed)
{
  this->Current = false;
  // What is looked for, by owner.
  std::vector<std::pair<std::int32_t, std::size_t>> wanted;
  std::int32_t last = -1;
  for (std::size_t i = 0; i < tetrahedra.size(); ++i)
  {
    wanted.emplace_back(MeshOrder::Get(order.Tetrahedra, tetrahedra[i].Tetrahedron), i);
    last = std::max(last, wanted.back().first);
  }
  std::sort(wanted.begin(), wanted.end());
  enum Kind : unsigned char
  {
    Other,
    Removed,
    Wanted
  };
  const std::int32_t lastRemoved =
    removed.empty() ? -1 : *std::max_element(removed.begin(), removed.end());
  std::vector<unsigned char> kinds(
    static_cast<std::size_t>(std::max(last, lastRemoved)) + 1, Other);
  for (const auto& one : wanted)
  {
    kinds[one.first] = Wanted;
  }
  std::vector<std::int32_t> numbers(tetrahedra.size(), -1);
  std::vector<std::int32_t> unused;
  // A tetrahedron that is new may have the number of one that is gone, but none of its records.
  for (const std::int32_t tetrahedron : removed)
  {
    kinds[tetrahedron] = Removed;
  }
  if (this->Count > 0)
  {
    const MappedBuffer<std::int32_t> owners(this->Queue, this->Owners, CL_MAP_READ | CL_MAP_WRITE);
    const MappedBuffer<const char> rest(this->Queue, this->Rest, CL_MAP_READ);
    std::vector<char> one(this->GetRestSize());
    for (std::size_t record = 0; record < this->Count; ++record)
    {
      const std::int32_t owner = owners.Get()[record];
      if (owner >= static_cast<std::int32_t>(kinds.size()))
      {
        continue;
      }
      if (owner < 0 || kinds[owner] == Removed)
      {
        owners.Get()[record] = -1;
        unused.push_back(static_cast<std::int32_t>(record));
      }
      else if (kinds[owner] == Wanted)
      {
        // Those of a sliver differ.
        for (auto found = std::lower_bound(
               wanted.begin(), wanted.end(), std::make_pair(owner, std::size_t{ 0 }));
             found != wanted.end() && found->first == owner; ++found)
        {
          this->WriteRest(0, tetrahedra[found->second], one.data());
          if (std::equal(one.begin(), one.end(), rest.Get() + record * one.size()))
          {
            numbers[found->second] = static_cast<std::int32_t>(record);
          }
        }
      }
    }
  }
  const auto missing =
    static_cast<std::size_t>(std::count(numbers.begin(), numbers.end(), std::int32_t{ -1 }));
  const std::size_t added = missing - std::min(missing, unused.size());
  if ((this->Count + added) * sizeof(std::int32_t) > deformvolume::GetMemory(this->Owners))
  {
    this->MakeRoom(this->Count + added + (this->Count + added) / 8); // more may follow soon
  }
  const MappedBuffer<std::int32_t> owners(this->Queue, this->Owners, CL_MAP_READ | CL_MAP_WRITE);
  const MappedBuffer<char> rest(this->Queue, this->Rest, CL_MAP_READ | CL_MAP_WRITE);
  auto free = unused.begin();
  for (std::size_t i = 0; i < tetrahedra.size(); ++i)
  {
    if (numbers[i] < 0)
    {
      numbers[i] = free != unused.end() ? *free++ : static_cast<std::int32_t>(this->Count++);
      owners.Get()[numbers[i]] = MeshOrder::Get(order.Tetrahedra, tetrahedra[i].Tetrahedron);
      this->WriteRest(static_cast<std::size_t>(numbers[i]), tetrahedra[i], rest.Get());
    }
  }
  return numbers;
}

cl::Event TetrahedronRecords::Evaluate(
  const cl::Program& mapping, const cl::Buffer& tetrahedra, const cl::Buffer& nodes)
{
  cl::Kernel kernel(mapping, "EvaluateTetrahedra");
  kernel.setArg(0, this->Rest);
  kernel.setArg(1, this->Owners);
  kernel.setArg(2, tetrahedra);
  kernel.setArg(3, nodes);
  kernel.setArg(4, this->Records);
  kernel.setArg(5, static_cast<cl_uint>(this->Count));
  constexpr std::size_t group = 64;
  const std::size_t items = (this->Count + group) / group * group;
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
  return deformvolume::GetMemory(this->Rest) + deformvolume::GetMemory(this->Owners) +
    deformvolume::GetMemory(this->Records);
}

} // namespace deformvolume
