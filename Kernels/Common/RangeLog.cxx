// SPDX-License-Identifier: BSD-3-Clause
#include "RangeLog.h"

namespace deformvolume
{

void RangeLog::Add(const PointRanges& ranges)
{
  if (ranges.size() > MostEntries)
  {
    this->AddAll();
    return;
  }
  ++this->Revision;
  for (const auto& range : ranges)
  {
    this->Entries.push_back({ this->Revision, range });
  }
  while (this->Entries.size() > MostEntries)
  {
    this->Begin = this->Entries.front().Revision;
    this->Entries.pop_front();
  }
}

void RangeLog::AddAll()
{
  this->Begin = ++this->Revision;
  this->Entries.clear();
}

std::optional<PointRanges> RangeLog::GetSince(std::uint64_t revision) const
{
  if (revision < this->Begin || revision > this->Revision)
  {
    return {};
  }
  PointRanges ranges;
  for (auto entry = this->Entries.rbegin();
       entry != this->Entries.rend() && entry->Revision > revision; ++entry)
  {
    ranges.push_back(entry->Range);
  }
  return ranges;
}

} // namespace deformvolume
