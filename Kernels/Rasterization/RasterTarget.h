// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeRasterTarget_h
#define DeformVolumeRasterTarget_h

#include "DeformRequest.h"
#include "Extent.h"
#include "HostMemory.h"
#include "OpenCLContext.h"
#include "OutputFilling.h"
#include "VolumeArray.h"

#include <memory>
#include <vector>

namespace deformvolume
{

/// A slab of the output that a kernel writes completely, background included. A CPU device writes
/// directly to the memory of the request if this memory is aligned. Other devices write to a
/// buffer, which Read() copies.
class RasterTarget
{
public:
  /// The request must outlive this object.
  RasterTarget(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
    const DeformRequest& request, const Extent& slab);
  RasterTarget(const RasterTarget&) = delete;
  RasterTarget& operator=(const RasterTarget&) = delete;

  const cl::Buffer& GetArray(std::size_t index) const { return this->Memories[index].Buffer; }
  const cl::Buffer& GetCoverage() const { return this->Memories.back().Buffer; }
  /// Eight bytes for each array. The first of these bytes are the background value in the type of
  /// the array.
  const cl::Buffer& GetBackgrounds() const { return this->Backgrounds; }

  /// Begins to copy the finished slab in a separate queue. The voxels are in the memory of the
  /// request after FinishReading(), which throws cl::Error if a copy failed.
  void Read(const cl::CommandQueue& queue);
  void FinishReading() { this->Reads.Check(); }
  /// Leaves the slab, which must be the whole output, on the device. queue: for copying it later.
  std::vector<std::shared_ptr<DeviceOutput>> KeepOnDevice(const cl::CommandQueue& queue) const;

private:
  /// The memory of an array or of the coverage: on the device, and in the request.
  struct Memory
  {
    cl::Buffer Buffer;
    char* Host;
    std::uint64_t Tuple; // bytes of a voxel
    ElementBytes Background;
  };
  void AddMemory(
    OpenCLContext& context, void* output, std::uint64_t tuple, const ElementBytes& background);

  Extent SlabExtent;
  std::uint64_t FirstVoxel; // index of the slab's first voxel in the output
  std::uint64_t NumberOfVoxels;
  std::vector<Memory> Memories;
  cl::Buffer Backgrounds;
  PendingCopies Reads; // last member: copies end before buffers are deleted
};

} // namespace deformvolume

#endif
