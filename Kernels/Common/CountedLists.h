// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCountedLists_h
#define DeformVolumeCountedLists_h

#include <cstddef>
#include <numeric>
#include <vector>

namespace deformvolume
{

/// Sorts entries into lists (a stable counting sort). The entries of list n become
/// entries[begins[n]] to entries[begins[n + 1] - 1]. forEach(take) must call take(n, entry) for
/// each entry. MakeLists() calls forEach twice.
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
