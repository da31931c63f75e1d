// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputMemory_h
#define DeformVolumeOutputMemory_h

#include "DeformRequest.h"
#include "Extent.h"
#include "HostMemory.h"
#include "OpenCLContext.h"
#include "OutputFilling.h"
#include "VolumeArray.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The arrays and the coverage of a slab of the output, a range of its planes. A CPU device works
/// directly in the memory of the request if this memory is aligned. Other devices have buffers,
/// which Read() copies.
class OutputMemory
{
public:
  /// An array, or the coverage, which is the last element.
  struct Element
  {
    cl::Buffer Buffer;
    char* Host = nullptr;
    std::size_t TupleSize = 0; // bytes of a voxel
    ElementBytes Background{};

    std::size_t GetComponents() const { return this->TupleSize / this->Background.Size; }
  };

  /// Allocates buffers for a slab of the request's output, reuses existing buffers, or uses the
  /// memory of the request in place.
  void Bind(const OpenCLContext& context, const DeformRequest& request,
    const std::vector<VolumeArray>& arrays, const Extent& slab);
  /// Whether the last output, for the same extent and arrays, is available: in the memory of this
  /// request for arrays that are written in place, otherwise on the device.
  bool HoldsLastOutput(const OpenCLContext& context, const DeformRequest& request) const;

  const Extent& GetExtent() const { return this->Slab; }
  std::uint64_t GetNumberOfVoxels() const { return this->NumberOfVoxels; }
  const std::vector<Element>& GetElements() const { return this->Elements; }
  const cl::Buffer& GetArray(std::size_t index) const { return this->Elements[index].Buffer; }
  const cl::Buffer& GetCoverage() const { return this->Elements.back().Buffer; }

  /// Begins to copy a part of the finished slab to the memory of the request, in a separate queue.
  void Read(const cl::CommandQueue& queue, const Extent& part);
  /// Leaves the finished slab, which must be the whole output, on the device. The returned outputs
  /// must be copied to the host before Bind() is called. queue: for these copies. parts: for each
  /// array, then for the coverage, the extent in which the memory of the request does not have the
  /// current values.
  std::vector<std::shared_ptr<DeviceOutput>> KeepOnDevice(
    const cl::CommandQueue& queue, const std::vector<Extent>& parts) const;
  /// The same if that memory has no current values.
  std::vector<std::shared_ptr<DeviceOutput>> KeepOnDevice(const cl::CommandQueue& queue) const
  {
    return this->KeepOnDevice(queue, std::vector<Extent>(this->Elements.size(), this->Slab));
  }
  /// Waits until the slab is in the memory of the request. Throws cl::Error if a copy failed.
  void FinishReading() { this->Reads.Check(); }
  /// Waits for all copies, also after a failure, and releases the memory of the request. Does not
  /// throw.
  void Release();

  /// Returns the memory on the device, in bytes.
  std::uint64_t GetMemory() const;

private:
  Extent Slab = EmptyExtent;
  std::uint64_t NumberOfVoxels = 0;
  std::vector<Element> Elements;
  PendingCopies Reads; // last member: copies end before buffers are deleted
};

} // namespace deformvolume

#endif
