// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputFilling_h
#define DeformVolumeOutputFilling_h

#include "KernelParameters.h"
#include "OpenCLContext.h"
#include "VolumeArray.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace deformvolume
{

/// The bytes of an element that memory is filled with, whatever its type.
struct ElementBytes
{
  std::array<unsigned char, 8> Bytes;
  std::size_t Size;

  template <typename T>
  static ElementBytes Of(T value)
  {
    ElementBytes bytes{ {}, sizeof(T) };
    std::memcpy(bytes.Bytes.data(), &value, sizeof(T));
    return bytes;
  }
};

/// What the voxels of an array hold that the deformed volume does not cover.
ElementBytes GetBackground(const VolumeArray& array);

/// Launches a kernel over so many items that have much to do. Groups run on one thread, and drivers
/// for processors put many items into one. Elsewhere items may be more, which the kernel leaves
/// out: of a prime number drivers would make groups of one item. The event is added to a list.
void LaunchBusyItems(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Kernel& kernel, std::size_t items, std::vector<cl::Event>& events);

/// The same for items that have little to do. There may be more of them, which the kernel leaves
/// out.
void LaunchSmallItems(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Kernel& kernel, std::uint64_t items, std::vector<cl::Event>& events);

/// Output voxels that a work-item takes of the kernel that counts all of them: many where it has a
/// thread for itself, fewer where thousands run at once.
cl_uint GetCountedVoxels(const OpenCLContext& context);

/// Fills a buffer of so many elements. A kernel does that: see OutputClearing.cl.
void Fill(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const ElementBytes& value, std::uint64_t size, std::vector<cl::Event>& events);

/// Fills patches of a buffer over an output, with so many elements a voxel. patches: the numbers of
/// count patches (see IncrementalUpdate::Plan). parameters: with the extent of the output.
void FillPatches(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const ElementBytes& value, std::size_t elements, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters, std::vector<cl::Event>& events);

/// Writes how many voxels of each of count patches are covered, a uint each.
void CountCoveredInPatches(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Buffer& coverage, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters, const cl::Buffer& sums, std::vector<cl::Event>& events);

///@{
/// Where coverage is bits: makes bytes of them, for all voxels of an output or for patches; clears
/// those of patches; and fills the voxels of an array that are not covered.
void ExpandCoverage(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& bits,
  const cl::Buffer& coverage, std::uint64_t voxels, std::vector<cl::Event>& events);
void ExpandPatches(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& bits,
  const cl::Buffer& coverage, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters, std::vector<cl::Event>& events);
void ClearPatchBits(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& bits,
  const cl::Buffer& patches, std::size_t count, const KernelParameters& parameters,
  std::vector<cl::Event>& events);
void FillUncovered(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const ElementBytes& value, std::uint64_t voxels, std::size_t elements, const cl::Buffer& bits,
  std::vector<cl::Event>& events);
///@}

} // namespace deformvolume

#endif
