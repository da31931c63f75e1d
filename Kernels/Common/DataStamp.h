// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDataStamp_h
#define DeformVolumeDataStamp_h

#include <cstdint>
#include <utility>
#include <vector>

namespace deformvolume
{

/// Addresses of data, with their versions or modification times. Two stamps differ if data were
/// replaced or modified.
using Stamp = std::vector<std::pair<const void*, std::uint64_t>>;

} // namespace deformvolume

#endif
