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

/// A slab of an output that a kernel writes wholly, background included. A processor writes the
/// memory of the request itself, where that is aligned; another device a copy, which Read brings
/// there.
class RasterTarget
{
public:
  /// The request must outlive the object.
  RasterTarget(OpenCLContext& context, const std::vector<VolumeArray>& arrays,
    const DeformRequest& request, const Extent& slab);
  RasterTarget(const RasterTarget&) = delete;
  RasterTarget& operator=(const RasterTarget&) = delete;

  const cl::Buffer& GetArray(std::size_t index) const { return this->Memories[index].Buffer; }
  const cl::Buffer& GetCoverage() const { return this->Memories.back().Buffer; }
  /// Eight bytes an array, the first of which are the background in the array's type.
  const cl::Buffer& GetBackgrounds() const { return this->Backgrounds; }

  /// Begins to copy the slab, which is done, in a queue of its own. The request has its voxels
  /// after FinishReading, which throws cl::Error where that has failed.
  void Read(const cl::CommandQueue& queue);
  void FinishReading() { this->Reads.Check(); }
  /// Leaves the slab, which is the whole output, on the device. The queue is that by which it is
  /// read then.
  std::vector<std::shared_ptr<DeviceOutput>> Leave(const cl::CommandQueue& queue) const;

private:
  /// Of an array, or of the coverage: on the device, and of the request.
  struct Memory
  {
    cl::Buffer Buffer;
    char* Host;
    ElementType Type;
    std::uint64_t Tuple; // bytes of a voxel
    ElementBytes Background;
  };
  void AddMemory(OpenCLContext& context, void* output, std::uint64_t tuple, ElementType type,
    const ElementBytes& background);

  Extent SlabExtent;
  std::uint64_t FirstVoxel; // of the slab in the output
  std::uint64_t NumberOfVoxels;
  std::vector<Memory> Memories;
  cl::Buffer Backgrounds;
  PendingCopies Reads; // last: they end before the buffers do
};

} // namespace deformvolume

#endif
