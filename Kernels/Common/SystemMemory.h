// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSystemMemory_h
#define DeformVolumeSystemMemory_h

#include <cstdint>
#include <string>

namespace deformvolume
{

/// Returns the bytes of memory that this process can allocate without swapping: the minimum of the
/// available memory of the system and the memory that the control groups (cgroup version 2) of the
/// process have left. Page cache counts as available. At least 1; 0 if neither number is known.
/// root is a prefix of all paths, for tests.
std::uint64_t GetSystemMemory(const std::string& root = "");

} // namespace deformvolume

#endif
