// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeControlGroups_h
#define DeformVolumeControlGroups_h

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace deformvolume
{

/// The folders of the control groups (version 2) that this process is in, its own first, then those
/// round it as far as they can be seen: what limits one of them limits the process. root is put in
/// front of all paths, so that tests can bring a tree of their own. What cannot be read counts as
/// not there.
std::vector<std::string> FindControlGroups(const std::string& root = "");

/// The number that a file begins with; nothing where there is no file, and no number, as in "max".
std::optional<std::int64_t> ReadNumber(const std::string& path);

/// The sum of the numbers after keys in a file of lines "key number"; nothing where none is there.
std::optional<std::int64_t> ReadSum(const std::string& path, const std::vector<std::string>& keys);

} // namespace deformvolume

#endif
