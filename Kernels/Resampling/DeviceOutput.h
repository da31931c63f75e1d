// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceOutput_h
#define DeformVolumeDeviceOutput_h

#include "DeformVolumeExport.h"
#include "Error.h"

#include <memory>

namespace deformvolume
{

/// An array of an output, or its coverage, that is still on the device (DeformRequest::
/// MayStayOnDevice). It goes to the memory of the request when somebody asks for it, and before
/// that by itself where the deformer needs the memory of the device: for its next output, for
/// another volume, and when it is to release its memory. That memory has to be there as long as
/// this object is; the deformer need not, and what nobody has asked for when this object goes never
/// gets there.
class DEFORMVOLUME_EXPORT DeviceOutput
{
public:
  ~DeviceOutput();
  DeviceOutput(const DeviceOutput&) = delete;
  DeviceOutput& operator=(const DeviceOutput&) = delete;

  /// Whether the values are in the memory of the request, or the background after a failure.
  bool IsRead() const;

  /// Brings the values to the memory of the request, unless they are there. Threads may call this
  /// at once: the first one copies, and the others wait. Throws an Error where they could not be
  /// copied, now or by another call; the memory then holds the background.
  void Read();

  /// For objects of this library.
  class DEFORMVOLUME_NO_EXPORT Internals;
  explicit DeviceOutput(std::shared_ptr<Internals> internals);
  const std::shared_ptr<Internals>& GetInternals() const { return this->Impl; }

private:
  std::shared_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
