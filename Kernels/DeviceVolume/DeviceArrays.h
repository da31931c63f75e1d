// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceArrays_h
#define DeformVolumeDeviceArrays_h

#include "HostMemory.h"
#include "OpenCLContext.h"
#include "VolumeArray.h"
#include "VolumeChunk.h"

#include <array>
#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Whether an array of the volume is not copied to the device.
bool IsUsedInPlace(const OpenCLContext& context, const VolumeArray& array);

/// The point arrays of a volume on the device, chunk by chunk: copies, or buffers over the memory
/// of the host.
class DeviceArrays
{
public:
  /// size: voxels on each axis. chunks: those of the volume; this object sets their Arrays.
  DeviceArrays(const OpenCLContext& context, const cl::CommandQueue& queue,
    const std::array<int, 3>& size, std::uint64_t allocationLimit,
    std::vector<VolumeChunk>& chunks);

  /// Arrays with an owner are used in place if the device can do that and their memory does not
  /// overlap that of other arrays. field: the memory of a displacement field that is used in place.
  void Set(const std::vector<VolumeArray>& arrays, const BufferInPlace& field = {});
  /// The arrays of the last call of Set. Only those that are used in place have an owner, and only
  /// their Data is read. Empty if Set has failed.
  const std::vector<VolumeArray>& Get() const { return this->Described; }
  /// Sets which arrays are categorical, and their background. Throws an Error if the arrays have
  /// other types or components than those of Set. Returns whether any option has changed.
  bool SetOptions(const std::vector<VolumeArray>& arrays);
  bool IsInPlace(std::size_t array) const { return this->Places[array].Bytes > 0; }
  /// The array whose memory overlaps this memory; with its buffer if the volume is one chunk.
  BufferInPlace FindOverlapping(const void* data, std::uint64_t bytes) const;
  /// Makes the device read arrays that are used in place again: their values have changed.
  void ReadAgain() const;
  /// The buffers of a chunk. Only one chunk at a time has buffers over memory of the host, as these
  /// would overlap: if that is another chunk, waits for the queue first.
  const std::vector<cl::Buffer>& GetBuffers(const VolumeChunk& chunk);

private:
  /// Releases the buffers over memory of the host.
  void Leave();

  const OpenCLContext& Context;
  cl::CommandQueue Queue;
  std::array<int, 3> Size;
  std::uint64_t AllocationLimit;
  std::vector<VolumeChunk>& Chunks;
  std::vector<VolumeArray> Described;
  std::vector<BufferInPlace> Places;   // one for each array, of no bytes where it was sent
  VolumeChunk* ChunkInPlace = nullptr; // the one that has buffers over them
};

} // namespace deformvolume

#endif
