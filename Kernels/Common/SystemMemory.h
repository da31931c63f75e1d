// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSystemMemory_h
#define DeformVolumeSystemMemory_h

#include <cstdint>
#include <string>

namespace deformvolume
{

/// Returns the bytes of memory that this process can allocate without swapping: the minimum of the
/// available memory of the system, the memory that the control groups (cgroup version 2) of the
/// process have left, and the address space that the process has left (ulimit -v). Page cache
/// counts as available. At least 1; 0 if no number is known. root is a prefix of all paths, for
/// tests; if it is given, the address space is not limited.
std::uint64_t GetSystemMemory(const std::string& root = "");

} // namespace deformvolume

#endif
