// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeControlGroups_h
#define DeformVolumeControlGroups_h

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace deformvolume
{

/// Lists the folders of the control groups (cgroup version 2) of this process: its own group first,
/// then the visible parents. The limits of each of them apply to the process. Files that cannot be
/// read are ignored. root is a prefix of all paths, for tests.
std::vector<std::string> FindControlGroups(const std::string& root = "");

/// Reads the number at the start of a file. Empty if there is no file or no number, as in "max".
std::optional<std::int64_t> ReadNumber(const std::string& path);

/// Sums the numbers of the given keys in a file of lines "key number". Empty if no key is found.
std::optional<std::int64_t> ReadSum(const std::string& path, const std::vector<std::string>& keys);

} // namespace deformvolume

#endif
