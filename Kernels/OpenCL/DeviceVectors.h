// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceVectors_h
#define DeformVolumeDeviceVectors_h

#include "DeformVolumeExport.h"
#include "Error.h"
#include "PointRanges.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace deformvolume
{

/// Positions of points in the memory of an OpenCL device: the deformed positions of the nodes of a
/// deformation mesh, or of the points of a displacement field. Three floats per point, in world
/// units. A simulation writes the vectors once, from the host or on the device. Any number of
/// VolumeDeformer objects on the same device read them there, each with a matrix of its own.
///
/// A CPU device keeps the vectors in host memory. On other devices, Read() copies them to the host.
///
/// Share the object by std::shared_ptr, and use it from one thread at a time. All failures are
/// thrown as Error.
class DEFORMVOLUME_EXPORT DeviceVectors
{
public:
  /// Allocates vectors for at least one point and sets them to 0. device: as in ResolveDevice().
  DeviceVectors(const std::string& device, std::size_t numberOfPoints);
  ~DeviceVectors();
  DeviceVectors(const DeviceVectors&) = delete;
  DeviceVectors& operator=(const DeviceVectors&) = delete;

  /// The name of the device.
  const std::string& GetDevice() const;
  /// Whether the vectors are in host memory. True on CPU devices only.
  bool AreInHostMemory() const;
  /// Number of points.
  std::size_t GetNumberOfPoints() const;
  /// Allocated bytes.
  std::uint64_t GetDeviceMemory() const;

  /// Writes all vectors.
  void Write(const float* vectors);
  /// Writes the vectors of some points. vectors: the array of all points, of which only the given
  /// ranges are read.
  void Write(const float* vectors, const PointRanges& written);

  /// Returns the current vectors in host memory, which this object owns. Copies them from the
  /// device if necessary: all vectors at the first call, later only those that may have changed.
  const float* Read();

  /// Revision of the vectors, which grows with each change.
  std::uint64_t GetRevision() const;
  /// Returns the points whose vectors have changed since a revision. Empty if this is not known:
  /// then any vector may have changed.
  std::optional<PointRanges> GetChanges(std::uint64_t revision) const;

  /// Access for classes of this library that work on the device.
  class DEFORMVOLUME_NO_EXPORT Internals;
  /// Access for classes of this library.
  Internals& GetInternals() { return *this->Impl; }

private:
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
