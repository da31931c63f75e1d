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

/// Which points have been written, and in which revision. Only the last ranges are kept.
class RangeLog
{
public:
  static constexpr std::size_t MostEntries = 65536;

  /// It is 0 at first, and grows with each entry.
  std::uint64_t GetRevision() const { return this->Revision; }

  void Add(const PointRanges& ranges);
  /// Any point may have been written.
  void AddAll();

  /// What has been written since a revision; nothing where that is not known, and any point may
  /// have been.
  std::optional<PointRanges> GetSince(std::uint64_t revision) const;

private:
  struct Entry
  {
    std::uint64_t Revision;
    std::array<std::size_t, 2> Range;
  };

  std::uint64_t Revision = 0;
  std::uint64_t Begin = 0; // the log knows what has come after this revision
  std::deque<Entry> Entries;
};

} // namespace deformvolume

#endif
