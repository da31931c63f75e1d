// SPDX-License-Identifier: BSD-3-Clause
#include "Ranks.h"

#include "Device.h"
#include "Hash.h"

#include "vtkCommunicator.h"
#include "vtkMultiProcessController.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <numeric>
#include <set>
#include <unistd.h>
#include <utility>

namespace deformvolume
{

namespace
{

// A value of 64 bits as two integers of 32 bits: not all controllers can send unsigned numbers of
// 64 bits.
using Halves = std::array<int, 2>;

Halves Split(std::uint64_t value)
{
  return { { static_cast<int>(value >> 32), static_cast<int>(value & 0xFFFFFFFFU) } };
}

std::uint64_t Join(const int* halves)
{
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(halves[0])) << 32 |
    static_cast<std::uint32_t>(halves[1]);
}

} // namespace

Ranks::Ranks()
  : Controller(vtkMultiProcessController::GetGlobalController())
{
  if (this->Controller && this->Controller->GetNumberOfProcesses() > 1)
  {
    this->Rank = this->Controller->GetLocalProcessId();
    this->Count = this->Controller->GetNumberOfProcesses();
  }
}

std::vector<std::uint64_t> Ranks::Gather(std::uint64_t value) const
{
  if (!this->AreMany())
  {
    return { value };
  }
  const Halves mine = Split(value);
  std::vector<int> all(2 * static_cast<std::size_t>(this->Count));
  this->Controller->AllGather(mine.data(), all.data(), 2);
  std::vector<std::uint64_t> values;
  for (std::size_t i = 0; i < all.size(); i += 2)
  {
    values.push_back(Join(&all[i]));
  }
  return values;
}

std::uint64_t Ranks::GetMost(std::uint64_t value) const
{
  const std::vector<std::uint64_t> values = this->Gather(value);
  return *std::max_element(values.begin(), values.end());
}

std::uint64_t Ranks::GetSum(std::uint64_t value) const
{
  const std::vector<std::uint64_t> values = this->Gather(value);
  return std::accumulate(values.begin(), values.end(), std::uint64_t{ 0 });
}

bool Ranks::AreEqual(std::uint64_t value) const
{
  const std::vector<std::uint64_t> values = this->Gather(value);
  return std::count(values.begin(), values.end(), value) ==
    static_cast<std::ptrdiff_t>(values.size());
}

std::vector<char> Ranks::Gather(const void* data, std::size_t bytes, const std::string& what) const
{
  const auto* begin = static_cast<const char*>(data);
  if (!this->AreMany())
  {
    return std::vector<char>(begin, begin + bytes);
  }
  const std::vector<std::uint64_t> sizes = this->Gather(static_cast<std::uint64_t>(bytes));
  const std::uint64_t sum = std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{ 0 });
  // MPI counts with int, also if vtkIdType has 64 bits.
  if (sum > static_cast<std::uint64_t>(std::numeric_limits<int>::max()))
  {
    throw Error("The " + what + " takes " + std::to_string(sum) +
      " bytes altogether, and the ranks can exchange 2,147,483,647 at most. Connect a coarser "
      "deformation mesh, or one that each rank has whole.");
  }
  std::vector<vtkIdType> lengths;
  std::vector<vtkIdType> offsets;
  std::vector<char> all;
  // Allocate before the exchange: if a rank failed to allocate, the other ranks would wait for it.
  this->Attempt(
    [&]
    {
      vtkIdType offset = 0;
      for (const std::uint64_t size : sizes)
      {
        lengths.push_back(static_cast<vtkIdType>(size));
        offsets.push_back(offset);
        offset += lengths.back();
      }
      all.resize(static_cast<std::size_t>(sum));
    });
  if (sum > 0)
  {
    char none = 0; // sent by ranks without data
    this->Controller->AllGatherV(bytes > 0 ? begin : &none, all.data(),
      static_cast<vtkIdType>(bytes), lengths.data(), offsets.data());
  }
  return all;
}

void Ranks::Agree(Outcome outcome, const std::string& message) const
{
  const std::vector<std::uint64_t> outcomes =
    this->Gather(static_cast<std::uint64_t>(static_cast<int>(outcome)));
  const auto isFailure = [](std::uint64_t value)
  { return value != static_cast<std::uint64_t>(static_cast<int>(Outcome::Done)); };
  const auto first = std::find_if(outcomes.begin(), outcomes.end(), isFailure);
  if (first == outcomes.end())
  {
    return;
  }
  const int rank = static_cast<int>(first - outcomes.begin());
  int length = static_cast<int>(message.size());
  this->Controller->Broadcast(&length, 1, rank);
  std::vector<char> text(message.begin(), message.end());
  text.resize(static_cast<std::size_t>(length) + 1, '\0');
  this->Controller->Broadcast(text.data(), length + 1, rank);
  // Numbers in the message, such as that of a point, may be those of the rank.
  std::uint64_t hash = HashOfNothing;
  AddToHash(hash, message.data(), message.size());
  const bool isOfAll = this->AreEqual(hash); // ranks that have not failed have no message
  switch (static_cast<Outcome>(*first))
  {
    case Outcome::Aborted:
      throw Aborted();
    case Outcome::OutOfMemory:
      throw std::bad_alloc();
    default:
      throw Error(
        text.data() + (isOfAll ? std::string() : " (On rank " + std::to_string(rank) + ".)"));
  }
}

void Ranks::ShareProcessors() const
{
  // Once for each number of ranks, since ranks do not move to other machines.
  static std::mutex mutex;
  static std::set<int> counts;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (counts.count(this->Count) > 0)
    {
      return;
    }
  }
  constexpr std::size_t length = 256;
  std::array<char, length> name{};
  gethostname(name.data(), length - 1);
  const std::vector<char> names = this->Gather(name.data(), length, "names of machines");
  int here = 0;
  for (int rank = 0; rank < this->Count; ++rank)
  {
    here += std::equal(name.begin(), name.end(), names.begin() + rank * static_cast<int>(length));
  }
  deformvolume::ShareProcessors(here);
  const std::lock_guard<std::mutex> lock(mutex);
  counts.insert(this->Count);
}

void Ranks::ShareProcessorsAlone() const
{
  int here = this->Count;
  // Variables of Open MPI, of MPICH and its derivatives, of MVAPICH, and of Slurm.
  for (const char* name : { "OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS",
         "MV2_COMM_WORLD_LOCAL_SIZE", "SLURM_STEP_TASKS_PER_NODE" })
  {
    const char* value = std::getenv(name);
    const int ranksHere = value ? std::atoi(value) : 0;
    if (ranksHere > 0)
    {
      here = std::min(here, ranksHere);
      break;
    }
  }
  deformvolume::ShareProcessors(here);
}

} // namespace deformvolume
