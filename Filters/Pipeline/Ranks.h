// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRanks_h
#define DeformVolumeRanks_h

#include "Error.h"

#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <vector>

class vtkMultiProcessController;

namespace deformvolume
{

/// The processes that VTK's global controller knows, and what they decide together. With one
/// process nothing is sent. Functions are collective unless they say otherwise: every rank has to
/// call them, in the same order.
class Ranks
{
public:
  Ranks();

  /// Not collective.
  int GetRank() const { return this->Rank; }
  int GetCount() const { return this->Count; }
  bool AreMany() const { return this->Count > 1; }

  /// The largest of the values of all ranks, and their sum.
  std::uint64_t GetMost(std::uint64_t value) const;
  std::uint64_t GetSum(std::uint64_t value) const;
  bool IsAny(bool value) const { return this->GetMost(value ? 1 : 0) > 0; }
  /// Whether all ranks have the same value.
  bool AreEqual(std::uint64_t value) const;
  /// The values of all ranks, in their order.
  std::vector<std::uint64_t> Gather(std::uint64_t value) const;
  /// The bytes of all ranks, one after the other. Throws an Error, on all ranks, where there are
  /// more than one message can hold.
  std::vector<char> Gather(const void* data, std::size_t bytes, const std::string& what) const;
  void Wait() const;

  /// Runs a function, which must be without calls to other ranks. If it throws on any rank, all
  /// ranks throw: what the first of those has thrown, as an Error or Aborted.
  template <typename Function>
  void Attempt(Function&& function) const
  {
    if (!this->AreMany())
    {
      function();
      return;
    }
    Outcome outcome = Outcome::Done;
    std::string message;
    try
    {
      function();
    }
    catch (const Aborted&)
    {
      outcome = Outcome::Aborted;
    }
    catch (const std::bad_alloc&)
    {
      outcome = Outcome::OutOfMemory;
    }
    catch (const std::exception& error)
    {
      outcome = Outcome::Failed;
      message = error.what();
    }
    this->Agree(outcome, message);
  }

  /// The ranks on this machine, this one included, in ascending order. They share its processors:
  /// the first call on a machine makes the device's share smaller, before there is a device.
  const std::vector<int>& GetNeighbours() const;

  /// Makes the device's share smaller on this rank alone, where a device is asked for before all
  /// ranks have come together: by the number of ranks on this machine that the launcher tells, or
  /// else by that of all. Not collective.
  void ShareProcessors() const;

private:
  enum class Outcome
  {
    Done,
    Failed,
    OutOfMemory,
    Aborted
  };
  void Agree(Outcome outcome, const std::string& message) const;

  vtkMultiProcessController* Controller = nullptr;
  int Rank = 0;
  int Count = 1;
};

} // namespace deformvolume

#endif
