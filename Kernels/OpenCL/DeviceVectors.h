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

/// Vectors of points, in the memory of an OpenCL device: where the nodes of a deformation mesh, or
/// the points of a displacement field, are now. Three floats a point, in world units. Whoever moves
/// the points writes them once, from the host or on the device; any number of VolumeDeformer
/// objects on the same device read them there, each by a matrix of its own.
///
/// On a device with memory of its own they are brought to the host where somebody asks (Read). A
/// processor has them in the memory of the host, and they are never copied.
///
/// They are shared by std::shared_ptr, and used by one thread at a time. Every failure is an Error.
class DEFORMVOLUME_EXPORT DeviceVectors
{
public:
  /// device: see ResolveDevice. All vectors are 0 at first. At least one point.
  DeviceVectors(const std::string& device, std::size_t numberOfPoints);
  ~DeviceVectors();
  DeviceVectors(const DeviceVectors&) = delete;
  DeviceVectors& operator=(const DeviceVectors&) = delete;

  /// The name of the device.
  const std::string& GetDevice() const;
  /// Whether it has them in the memory of the host.
  bool AreInHostMemory() const;
  /// How many vectors there are.
  std::size_t GetNumberOfPoints() const;
  /// Bytes allocated on the device.
  std::uint64_t GetDeviceMemory() const;

  /// Writes all vectors.
  void Write(const float* vectors);
  /// Writes some of them. vectors: of all points; only those of the ranges are read.
  void Write(const float* vectors, const PointRanges& written);

  /// The vectors in memory of the host, which is there as long as this object is. This call brings
  /// it up to date: of what has been written on the device it copies what may have changed, and at
  /// the first time all.
  const float* Read();

  /// Grows with each change.
  std::uint64_t GetRevision() const;
  /// What has changed since a revision; nothing where that is not known, and any vector may have.
  std::optional<PointRanges> GetChanges(std::uint64_t revision) const;

  /// For objects of this library that work on the device.
  class DEFORMVOLUME_NO_EXPORT Internals;
  /// For objects of this library.
  Internals& GetInternals() { return *this->Impl; }

private:
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
