// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePublishedPass_h
#define DeformVolumePublishedPass_h

#include "DeformRequest.h"
#include "KernelParameters.h"
#include "OpenCLContext.h"

#include <cstdint>

namespace deformvolume
{

class DeviceVolume;
class DisplacementSource;
class Launches;
class OutputSlab;
class WorkDevice;
struct VolumeChunk;

/// The published method: maps all vertices, and then resamples all cells
/// (PublishedResampling.cl).
class PublishedPass
{
public:
  PublishedPass(
    WorkDevice& device, DeviceVolume& volume, const DisplacementSource& source, Launches& launches);

  /// The mapping is up to date (DisplacementSource::PrepareMapping).
  void Run(const DeformRequest& request, const OutputSlab& output);

  /// Bytes on the device.
  std::uint64_t GetMemory() const;

private:
  void Map(const VolumeChunk& chunk, const KernelParameters& p);

  WorkDevice& Device;
  DeviceVolume& Volume;
  const DisplacementSource& Source;
  Launches& Launched;
  cl::Buffer Positions; // of the vertices of a chunk
};

} // namespace deformvolume

#endif
