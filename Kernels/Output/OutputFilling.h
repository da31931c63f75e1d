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

/// The bytes of an element of any type, for filling memory.
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

/// Returns the value of voxels of an array that the deformed volume does not cover.
ElementBytes GetBackground(const VolumeArray& array);

/// Launches at least `items` heavy work-items: groups of 1 on CPUs, of 64 elsewhere. The kernel
/// must ignore the additional items. Adds the event to a list.
void LaunchBusyItems(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Kernel& kernel, std::size_t items, std::vector<cl::Event>& events);

/// Launches at least `items` light work-items, in groups of 64. The kernel must ignore the
/// additional items.
void LaunchSmallItems(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Kernel& kernel, std::uint64_t items, std::vector<cl::Event>& events);

/// Returns the number of voxels for each work-item of the kernel CountCovered: many if a work-item
/// has a thread of its own, fewer if the device executes thousands of work-items at once.
cl_uint GetCountedVoxels(const OpenCLContext& context);

/// Fills a buffer of `size` elements by a kernel (see OutputClearing.cl).
void Fill(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const ElementBytes& value, std::uint64_t size, std::vector<cl::Event>& events);

/// Fills patches of an output buffer. elements: number of elements of a voxel. patches: the numbers
/// of `count` patches (see IncrementalUpdate::Plan). parameters: with the extent of the output.
void FillPatches(OpenCLContext& context, const cl::CommandQueue& queue, const cl::Buffer& buffer,
  const ElementBytes& value, std::size_t elements, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters, std::vector<cl::Event>& events);

/// Writes the number of covered voxels of each of `count` patches to `sums`, as uints.
void CountCoveredInPatches(OpenCLContext& context, const cl::CommandQueue& queue,
  const cl::Buffer& coverage, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters, const cl::Buffer& sums, std::vector<cl::Event>& events);

///@{
/// For coverage stored as bits: expands the bits of all voxels or of patches to bytes, clears the
/// bits of patches, or fills the voxels of an array that are not covered.
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
