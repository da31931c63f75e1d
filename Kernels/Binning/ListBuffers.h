// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeListBuffers_h
#define DeformVolumeListBuffers_h

#include "OpenCLContext.h"
#include "RasterParameters.h"

#include <cstdint>

namespace deformvolume
{

class WorkDevice;

/// What the lists of the tetrahedra in each tile are made of, and the lists (TetrahedronLists).
struct ListBuffers
{
  cl::Buffer Boxes;    // the tiles of each tetrahedron
  cl::Buffer Counters; // see RasterParameters.h
  cl::Buffer Begins;   // of the list of each tile in the lists, and the end of the last one
  cl::Buffer Lists;
};

std::uint64_t CountTiles(const RasterParameters& p);

/// Makes a buffer larger where it has to be. Throws an Error where the device gives none of so many
/// bytes.
void ReserveLists(WorkDevice& device, cl::Buffer& buffer, std::uint64_t bytes);

/// The length of all lists together, unless it is too large: then it throws an Error.
cl_uint CheckLength(std::uint64_t length);

} // namespace deformvolume

#endif
