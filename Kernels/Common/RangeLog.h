// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRangeLog_h
#define DeformVolumeRangeLog_h

#include "PointRanges.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace deformvolume
{

/// Log of the points that have been written, with the revision of each write. Only the last
/// MostEntries ranges are kept.
class RangeLog
{
public:
  static constexpr std::size_t MostEntries = 65536;

  /// The current revision: 0 at first, incremented by each call of Add() and AddAll().
  std::uint64_t GetRevision() const { return this->Revision; }

  void Add(const PointRanges& ranges);
  /// Records that any point may have been written.
  void AddAll();

  /// Returns the ranges that have been written since a revision. Empty if the log no longer holds
  /// all of them: then any point may have been written.
  std::optional<PointRanges> GetSince(std::uint64_t revision) const;

private:
  struct Entry
  {
    std::uint64_t Revision;
    std::array<std::size_t, 2> Range;
  };

  std::uint64_t Revision = 0;
  std::uint64_t Begin = 0; // the log is complete after this revision
  std::deque<Entry> Entries;
};

} // namespace deformvolume

#endif
