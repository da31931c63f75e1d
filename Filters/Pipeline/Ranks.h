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

/// The processes of VTK's global controller, and the operations that they do together. With one
/// process nothing is sent. Functions are collective unless their comments say otherwise: every
/// rank has to call them in the same order.
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
  /// The concatenated bytes of all ranks. Throws an Error on all ranks if there are more than
  /// 2,147,483,647. what: names the data in the message.
  std::vector<char> Gather(const void* data, std::size_t bytes, const std::string& what) const;

  /// Calls a function, which must not call collective functions. If it throws on any rank, all
  /// ranks throw the exception of the first of these ranks, as an Error, Aborted or std::bad_alloc.
  /// The Error names this rank, unless all ranks have the same one.
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

  /// The ranks on one machine share its processors: the first call limits the threads of this rank,
  /// on the host and on CPU devices, to its share. It has to come before a device is selected.
  void ShareProcessors() const;

  /// Like ShareProcessors(), if a device is needed before the ranks can communicate. The number of
  /// ranks on this machine is taken from an environment variable of the launcher, or else is that
  /// of all ranks. Not collective.
  void ShareProcessorsAlone() const;

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
