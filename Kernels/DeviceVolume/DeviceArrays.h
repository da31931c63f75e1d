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

/// Whether an array of the volume can be used in place, without a copy.
bool IsUsedInPlace(const OpenCLContext& context, const VolumeArray& array);

/// The point arrays of a volume on the device. The buffers of each chunk are copies, or use host
/// memory.
class DeviceArrays
{
public:
  /// size: voxels on each axis. chunks: of the volume; this object sets their Arrays.
  DeviceArrays(const OpenCLContext& context, const cl::CommandQueue& queue,
    const std::array<int, 3>& size, std::uint64_t allocationLimit,
    std::vector<VolumeChunk>& chunks);

  /// Set the arrays. An array with an owner is used in place if the device supports it and its
  /// memory does not overlap that of other arrays. field: memory of a displacement field that is
  /// used in place.
  void Set(const std::vector<VolumeArray>& arrays, const BufferInPlace& field = {});
  /// The arrays of the last call of Set(). Data and Owner are valid only for arrays in place. Empty
  /// if Set() has thrown.
  const std::vector<VolumeArray>& Get() const { return this->Described; }
  /// Set Categorical and Background of the arrays. Throws Error if types or components differ from
  /// those of Set(). Returns whether any option has changed.
  bool SetOptions(const std::vector<VolumeArray>& arrays);
  bool IsInPlace(std::size_t array) const { return this->BuffersInPlace[array].Bytes > 0; }
  /// Returns an array in place whose memory overlaps the given memory. It has a buffer if the
  /// volume is one chunk. Bytes is 0 if there is no such array.
  BufferInPlace FindOverlapping(const void* data, std::uint64_t bytes) const;
  /// Updates the arrays in place after their memory has been written.
  void Reread() const;
  /// Returns the buffers of a chunk. The arrays in place of several chunks overlap, so only one
  /// chunk at a time has buffers for them. If another chunk had them before, the function waits for
  /// all commands of the queue.
  const std::vector<cl::Buffer>& GetBuffers(const VolumeChunk& chunk);

private:
  /// Releases the buffers that use host memory.
  void ReleaseBuffersInPlace();

  const OpenCLContext& Context;
  cl::CommandQueue Queue;
  std::array<int, 3> Size;
  std::uint64_t AllocationLimit;
  std::vector<VolumeChunk>& Chunks;
  std::vector<VolumeArray> Described;
  std::vector<BufferInPlace> BuffersInPlace; // one for each array, with 0 bytes if it was copied
  VolumeChunk* ChunkInPlace = nullptr;       // the chunk that has buffers for arrays in place
};

} // namespace deformvolume

#endif
