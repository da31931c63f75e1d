// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorReading_h
#define DeformVolumeVectorReading_h

#include "DeviceVectors.h"
#include "DisplacementField.h"
#include "WorkDevice.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace deformvolume
{

/// Reads DeviceVectors as displacements: by a kernel on a device with memory of its own, so that
/// nothing passes through the host, else on the host. It knows what has been read last.
class VectorReading
{
public:
  explicit VectorReading(WorkDevice& device)
    : Device(device)
  {
  }

  /// What has changed since these vectors were read last, by the same matrix (ToDisplacement of
  /// field); nothing where any may have. Throws an Error, and leaves all as it was, where they are
  /// not so many vectors on the device.
  std::optional<PointRanges> Begin(const std::shared_ptr<DeviceVectors>& vectors,
    const DisplacementField& field, std::size_t numberOfPoints);
  /// Other displacements than those of vectors are in use.
  void Forget();

  /// Whether a kernel can read what was begun: where there is a matrix, that needs double
  /// precision.
  bool CanConvert() const;
  /// Writes four floats a point to a buffer. Throws an Error where a displacement is not finite or
  /// too large; the buffer is then undefined. what: what has it, in the Error.
  void Convert(const cl::Buffer& displacements, const char* what);

  /// Throws the same Error where they are read on the host. changes: what Begin() has returned.
  void Check(const std::optional<PointRanges>& changes, const char* what);
  /// The displacements on the host, three floats a point. changes: what Begin() has returned.
  const float* GetDisplacements(const std::optional<PointRanges>& changes);

private:
  WorkDevice& Device;
  std::shared_ptr<DeviceVectors> Vectors;
  DisplacementField Field; // without vectors
  std::uint64_t Revision = 0;
  std::vector<float> Displacements; // those on the host that a matrix has made
};

} // namespace deformvolume

#endif
