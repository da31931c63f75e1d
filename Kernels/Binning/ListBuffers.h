// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeListBuffers_h
#define DeformVolumeListBuffers_h

#include "OpenCLContext.h"
#include "RasterParameters.h"

#include <cstdint>

namespace deformvolume
{

class WorkDevice;

/// The lists of tetrahedra for each tile, and the data from which the lists are made
/// (TetrahedronLists).
struct ListBuffers
{
  cl::Buffer Boxes;    // the tiles of each tetrahedron
  cl::Buffer Counters; // see RasterParameters.h
  cl::Buffer Begins;   // index in Lists at which each tile's list begins; then the end of the last
  cl::Buffer Lists;
};

std::uint64_t CountTiles(const RasterParameters& p);

/// Allocates a larger buffer if needed. Throws an Error if the device cannot allocate that many
/// bytes.
void ReserveLists(WorkDevice& device, cl::Buffer& buffer, std::uint64_t bytes);

/// Returns the total length of all lists. Throws an Error if it is too large.
cl_uint CheckLength(std::uint64_t length);

} // namespace deformvolume

#endif
