// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputRange_h
#define DeformVolumeOutputRange_h

#include "DeviceOutput.h"
#include "ElementType.h"
#include "OpenCLContext.h"

#include <cstddef>
#include <cstdint>

namespace deformvolume
{

/// Finds the range of a component of an array on a device. The buffer holds `tuples` tuples of
/// `components` components and must not be written meanwhile. Returns an empty range if no value is
/// finite. Waits for the queue. Throws cl::Error or Error.
DeviceOutput::Range FindRange(const cl::CommandQueue& queue, const cl::Buffer& buffer,
  ElementType type, std::uint64_t tuples, std::size_t components, std::size_t component);

} // namespace deformvolume

#endif
