// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMemoryError_h
#define DeformVolumeMemoryError_h

#include "Error.h"

namespace deformvolume
{

/// Thrown if there is not enough memory for an update. With another resampler, or after other data
/// have been released, the memory may suffice.
class DEFORMVOLUME_EXPORT MemoryError : public Error
{
public:
  using Error::Error;
};

} // namespace deformvolume

#endif
