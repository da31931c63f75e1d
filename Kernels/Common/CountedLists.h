// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCountedLists_h
#define DeformVolumeCountedLists_h

#include <cstddef>
#include <numeric>
#include <vector>

namespace deformvolume
{

/// Sorts entries into lists by counting. Those of list n are from begins[n] to begins[n + 1] then,
/// in the order in which they are given. forEach(take) has to call take(n, entry) for each of them;
/// it is called twice.
template <typename Index, typename Entry, typename ForEach>
void MakeLists(std::size_t numberOfLists, const ForEach& forEach, std::vector<Index>& begins,
  std::vector<Entry>& entries)
{
  begins.assign(numberOfLists + 1, 0);
  forEach([&](std::size_t list, const Entry&) { ++begins[list + 1]; });
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  entries.resize(begins.back());
  std::vector<Index> next(begins.begin(), begins.end() - 1);
  forEach([&](std::size_t list, const Entry& entry) { entries[next[list]++] = entry; });
}

} // namespace deformvolume

#endif
