// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceOutput_h
#define DeformVolumeDeviceOutput_h

#include "DeformVolumeExport.h"
#include "Error.h"

#include <memory>

namespace deformvolume
{

/// An output array, or the coverage, that stayed on the device (DeformRequest::MayStayOnDevice).
/// Read() copies it to the memory of the request. The deformer also copies it before it needs the
/// device memory: for its next output, for another volume, or to release its memory. The memory of
/// the request must exist until one of these copies, or until Drop(). The deformer may be deleted
/// earlier.
class DEFORMVOLUME_EXPORT DeviceOutput
{
public:
  ~DeviceOutput();
  DeviceOutput(const DeviceOutput&) = delete;
  DeviceOutput& operator=(const DeviceOutput&) = delete;

  /// Whether the values are on the device, neither read nor dropped.
  bool IsOnDevice() const;
  /// Whether the values are in the memory of the request.
  bool IsRead() const;

  /// Copies the values to the memory of the request, unless they have been copied. Thread-safe: the
  /// first thread copies, other threads wait. Throws Error if the copy failed in this or an earlier
  /// call; the memory then holds the background.
  void Read();

  /// Discards the values, and allows the memory of the request to be freed. Waits for a copy in
  /// progress. The destructor does the same.
  void Drop();

  /// For use inside this library.
  class DEFORMVOLUME_NO_EXPORT Internals;
  /// For use inside this library.
  DEFORMVOLUME_NO_EXPORT explicit DeviceOutput(std::shared_ptr<Internals> internals);
  /// For use inside this library.
  const std::shared_ptr<Internals>& GetInternals() const { return this->Impl; }

private:
  std::shared_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
