// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNewWarnings_h
#define DeformVolumeNewWarnings_h

#include <set>
#include <string>
#include <utility>

namespace deformvolume
{

/// Replaces the warnings of the last update by those of this one. Returns the warnings that the
/// last update did not have, separated by blanks; empty if there are none.
inline std::string ReplaceWarnings(std::set<std::string>& last, std::set<std::string> warnings)
{
  std::string news;
  for (const std::string& warning : warnings)
  {
    news += last.count(warning) > 0 ? "" : (news.empty() ? "" : " ") + warning;
  }
  last = std::move(warnings);
  return news;
}

} // namespace deformvolume

#endif
