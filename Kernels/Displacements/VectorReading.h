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

/// Converts DeviceVectors to displacements. On a device with memory of its own, a kernel converts
/// them, so that no vectors are copied to the host. Otherwise they are converted on the host. The
/// class keeps the vectors and their revision of the last call.
class VectorReading
{
public:
  explicit VectorReading(WorkDevice& device)
    : Device(device)
  {
  }

  /// Set the vectors and the matrix (ToDisplacement of field). Returns the points that have changed
  /// since the last call with the same vectors and matrix; empty if any may have changed. Throws
  /// Error and changes nothing if the vectors do not have this number of points or are on another
  /// device.
  std::optional<PointRanges> Begin(const std::shared_ptr<DeviceVectors>& vectors,
    const DisplacementField& field, std::size_t numberOfPoints);
  /// Releases the vectors.
  void Forget();

  /// Whether a kernel can convert the vectors. A matrix other than the identity needs double
  /// precision.
  bool CanConvert() const;
  /// Writes the displacements to a buffer, four floats per point. Throws Error if a displacement is
  /// too large or not finite; the buffer is then undefined. what: "node" or "point", for the
  /// message.
  void Convert(const cl::Buffer& displacements, const char* what);

  /// Checks the displacements on the host, and throws the same Error as Convert(). changes: the
  /// result of Begin().
  void Check(const std::optional<PointRanges>& changes, const char* what);
  /// Returns the displacements on the host, three floats per point. changes: the result of Begin().
  const float* GetDisplacements(const std::optional<PointRanges>& changes);

private:
  WorkDevice& Device;
  std::shared_ptr<DeviceVectors> Vectors;
  DisplacementField Field; // without vectors
  std::uint64_t Revision = 0;
  std::vector<float> Displacements; // on the host, if there is a matrix
};

} // namespace deformvolume

#endif
