// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeOutputFilling_h
#define DeformVolumeOutputFilling_h

#include "KernelLauncher.h"
#include "KernelParameters.h"
#include "VolumeArray.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

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
/// must ignore the additional items.
void LaunchHeavyItems(KernelLauncher& launcher, const cl::Kernel& kernel, std::size_t items);

/// Launches at least `items` light work-items, in groups of 64. The kernel must ignore the
/// additional items.
void LaunchLightItems(KernelLauncher& launcher, const cl::Kernel& kernel, std::uint64_t items);

/// Launches a work-group for each of `count` listed patches (see ChangeTracker::Plan), with a
/// work-item for each row of the patch.
void LaunchPatches(KernelLauncher& launcher, const cl::Kernel& kernel, std::size_t count);

/// Launches a kernel whose work-items process memory in steps of `step` elements. There are no more
/// work-items than a device executes at once: starting a work-item takes longer than a step.
void LaunchSteps(
  KernelLauncher& launcher, const cl::Kernel& kernel, std::uint64_t size, std::uint64_t step);

/// Fills a buffer of `size` elements by a kernel (see OutputClearing.cl).
void Fill(KernelLauncher& launcher, const cl::Buffer& buffer, const ElementBytes& value,
  std::uint64_t size);

/// Fills patches of an output buffer. elements: number of elements of a voxel. patches: the numbers
/// of `count` patches (see ChangeTracker::Plan). parameters: with the extent of the output.
void FillPatches(KernelLauncher& launcher, const cl::Buffer& buffer, const ElementBytes& value,
  std::size_t elements, const cl::Buffer& patches, std::size_t count,
  const KernelParameters& parameters);

/// For coverage stored as bits: fills the voxels of an array that are not covered.
void FillUncovered(KernelLauncher& launcher, const cl::Buffer& buffer, const ElementBytes& value,
  std::uint64_t voxels, std::size_t elements, const cl::Buffer& bits);

} // namespace deformvolume

#endif
