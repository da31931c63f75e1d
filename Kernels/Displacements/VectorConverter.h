// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorConverter_h
#define DeformVolumeVectorConverter_h

#include "DeviceVectors.h"
#include "DisplacementField.h"
#include "HostMemory.h"
#include "WorkDevice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace deformvolume
{

/// Converts vectors to displacements. On a device with memory of its own, a kernel converts them,
/// so that DeviceVectors are not copied to the host. Otherwise they are converted on the host. The
/// class keeps the DeviceVectors and their revision of the last call.
class VectorConverter
{
public:
  explicit VectorConverter(WorkDevice& device)
    : Device(device)
  {
  }

  /// Set the vectors and the matrix (ToDisplacement of field). Returns the points that have changed
  /// since the last call with the same vectors and matrix; empty if any may have changed. Throws
  /// Error and changes nothing if the vectors do not have this number of points or are on another
  /// device.
  std::optional<PointRanges> Begin(const std::shared_ptr<DeviceVectors>& vectors,
    const DisplacementField& field, std::size_t numberOfPoints);
  /// Releases the vectors, and the memory of the conversion.
  void Forget();

  /// Whether a kernel converts vectors with the matrix of a field. A matrix other than the identity
  /// needs double precision.
  bool CanConvert(const DisplacementField& field) const;
  ///@{
  /// Write the displacements to a buffer, four floats per point: of the vectors of Begin(), or of
  /// the points range[0] to range[1] - 1 of a field, whose vectors are in host memory. Throw Error
  /// if a displacement is too large or not finite; the buffer is then undefined. what: "node" or
  /// "point", for the message.
  void Convert(const cl::Buffer& displacements, const char* what);
  void Convert(const DisplacementField& field, const std::array<std::size_t, 2>& range,
    const cl::Buffer& displacements, const char* what);
  ///@}
  /// Least number of points for which Convert() of a field is worth it: it takes less time than the
  /// host needs to find the vectors that have changed.
  static constexpr std::size_t MinPoints = std::size_t{ 1 } << 20;
  /// Most points whose vectors are on the device at a time, if they come from host memory.
  static constexpr std::size_t PointsOfPortion = std::size_t{ 1 } << 21;
  /// Bytes on the device.
  std::uint64_t GetMemory() const { return deformvolume::GetMemory(this->Portion); }

  /// Checks the displacements on the host, and throws the same Error as Convert(). changes: the
  /// result of Begin().
  void Check(const std::optional<PointRanges>& changes, const char* what);
  /// Returns the displacements on the host, three floats per point. changes: the result of Begin().
  const float* GetDisplacements(const std::optional<PointRanges>& changes);

private:
  void ForgetVectors();

  WorkDevice& Device;
  std::shared_ptr<DeviceVectors> Vectors;
  DisplacementField Field; // without vectors
  std::uint64_t Revision = 0;
  std::vector<float> Displacements; // on the host, if there is a matrix
  cl::Buffer Portion;               // vectors that come from host memory
};

} // namespace deformvolume

#endif
