// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeSystemMemory_h
#define DeformVolumeSystemMemory_h

#include <cstdint>
#include <string>

namespace deformvolume
{

/// Bytes of memory that this process can get without swapping: what the system has available, and
/// what the control groups (of version 2) that the process is in have left, whichever is
/// less. Page cache counts as available. At least 1; 0 where nothing is known.
/// root is put in front of all paths, for tests.
std::uint64_t GetSystemMemory(const std::string& root = "");

} // namespace deformvolume

#endif
