// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceOutput_h
#define DeformVolumeDeviceOutput_h

#include "DeformVolumeExport.h"
#include "Error.h"

#include <memory>
#include <optional>

namespace deformvolume
{

/// An array of an output, or its coverage, that is still on the device (DeformRequest::
/// MayStayOnDevice). It goes to the memory of the request when somebody asks for it, and before
/// that by itself where the deformer needs the memory of the device: for its next output, for
/// another volume, and when it is to release its memory. The memory of the request has to be there
/// until then, or until Drop(); the deformer need not.
class DEFORMVOLUME_EXPORT DeviceOutput
{
public:
  ~DeviceOutput();
  DeviceOutput(const DeviceOutput&) = delete;
  DeviceOutput& operator=(const DeviceOutput&) = delete;

  /// Whether nobody has asked for the values yet, and somebody still may.
  bool IsOnDevice() const;
  /// Whether they have been brought to the memory of the request.
  bool IsRead() const;

  /// Brings the values to the memory of the request, unless they are there. Threads may call this
  /// at once: the first one copies, and the others wait. Throws an Error where they could not be
  /// copied, now or by another call; the memory then holds the background.
  void Read();

  /// What a component holds: from the least to the largest of the values that are finite.
  struct Range
  {
    /// The least finite value.
    double Least = 0.0;
    /// The largest finite value.
    double Largest = 0.0;
    /// Whether no value is infinite or not-a-number.
    bool AllFinite = false;
  };
  /// Found on the device, as nobody reads the values for that. Nothing where they are not there,
  /// where there is no such component, where none is finite, or where they are integers of 64 bits,
  /// which a double does not hold.
  /// Throws an Error where the device fails.
  std::optional<Range> FindRange(int component);

  /// Nobody wants the values, and the memory of the request may go. Waits for a copy that is under
  /// way. The destructor does so, too.
  void Drop();

  /// For objects of this library.
  class DEFORMVOLUME_NO_EXPORT Internals;
  /// For objects of this library.
  DEFORMVOLUME_NO_EXPORT explicit DeviceOutput(std::shared_ptr<Internals> internals);
  /// For objects of this library.
  const std::shared_ptr<Internals>& GetInternals() const { return this->Impl; }

private:
  std::shared_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
