// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailModel_h
#define DeformVolumeChainMailModel_h

#include "ChainMailSnapshot.h"
#include "ChainMailTypes.h"
#include "DeformVolumeExport.h"
#include "DeviceVectors.h"
#include "Error.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace deformvolume
{

/// Displacements of the voxels of a volume by ChainMail: each voxel is linked to its six
/// neighbours, and a link gives way within limits. Handles move voxels; others follow as far as the
/// limits demand, each by as little as possible. A step takes time for what moves only.
///
/// Displacements are whole multiples of 1/65536 voxel. Results do not depend on the device, the
/// size of work-groups or the order of blocks, to the last bit.
///
/// Order of calls: SetDevice, SetVoxelGrid, SetMaterials, SetOutput, then Step, as often as wanted.
/// SetActiveTetrahedra and SetPinned are optional. SetVoxelGrid forgets everything that was set
/// after it. Every failure is an Error; what was set and the displacements are then as before, but
/// for failures of the device, after which SetVoxelGrid has to be called again.
///
/// Memory: 12 bytes a voxel for the displacement and one byte each for flags, links and material,
/// in blocks of 8 x 8 x 8 voxels, of which the last ones on each axis are filled up; on the host
/// one byte a voxel where SetActiveTetrahedra was given some. A step needs no more: it keeps what
/// it may have to restore in the output.
class DEFORMVOLUME_EXPORT ChainMailModel
{
public:
  /// Displacements are at most this many voxels.
  static constexpr double LargestDisplacement = 4095.0;

  ChainMailModel();
  ~ChainMailModel();
  ChainMailModel(const ChainMailModel&) = delete;
  ChainMailModel& operator=(const ChainMailModel&) = delete;

  /// Chooses the device (see ResolveDevice) and returns its name. A change of device forgets all
  /// that was set.
  std::string SetDevice(const std::string& request);

  /// Bytes that may be used on the device; 0: what it has available.
  void SetMemoryLimit(std::uint64_t bytes);

  /// Work-items in a work-group; 0: chosen by device. To be called before SetVoxelGrid.
  void SetWorkGroupSize(std::size_t size);

  /// Visits blocks in another order for each number but 0.
  void SetBlockOrder(unsigned int order);

  /// extent: structured indices of the voxels. indexToWorld: row-major 3 x 3, its columns lead from
  /// a voxel to the next one on an axis. All voxels are at rest and of the default material. An
  /// Error where there is no memory for them and for an output.
  void SetVoxelGrid(const Extent& extent,
    const std::array<double, 9>& indexToWorld = { { 1, 0, 0, 0, 1, 0, 0, 0, 1 } });

  /// table: 1 to 256 materials. indices: which one each voxel has, x varying fastest; null: the
  /// first one. Displacements stay unless they violate a limit now; then they are put to 0.
  void SetMaterials(
    const std::vector<ChainMailMaterial>& table, const unsigned char* indices = nullptr);

  /// One byte a cell, bit i = tetrahedron i is active; null: all are. A link is there if any of the
  /// up to four tetrahedra that have it as an edge is active; a voxel is an element if any of its
  /// tetrahedra is. So there is a way along links only where there is one along active tetrahedra.
  /// What differs from the last ones is found by comparing. Where links return that the
  /// displacements violate, these are put to 0.
  void SetActiveTetrahedra(const unsigned char* active);

  /// One byte a voxel: nonzero where it stays as it is. Null: none is pinned.
  void SetPinned(const unsigned char* pinned);

  /// Three floats a voxel, x varying fastest: the displacements in world units. It stays the same
  /// memory until SetOutput is called again. A step writes only what it changes; during a step the
  /// contents are undefined. All of it is written by the call.
  void SetOutput(float* output);

  /// The same on the device of the model: a vector for each voxel, so that on a device with memory
  /// of its own nothing passes through the host. The vectors know what each step has changed. Where
  /// a step fails, and the voxel grid has to be set again, they are undefined.
  void SetOutput(const std::shared_ptr<DeviceVectors>& output);

  /// What SetMaterials and Step would refuse of these: they throw the same.
  static void CheckMaterials(const std::vector<ChainMailMaterial>& table);
  /// The same of a request for the voxels of an extent.
  static void CheckRequest(const Extent& extent, const ChainMailRequest& request);

  /// Moves the handles, and relaxes.
  ChainMailReport Step(const ChainMailRequest& request);

  /// Puts all displacements to 0.
  void Reset();

  /// The displacements as they are. last: null, or another snapshot, which is shared where nothing
  /// has changed.
  std::shared_ptr<const ChainMailSnapshot> TakeSnapshot(
    const std::shared_ptr<const ChainMailSnapshot>& last = {});
  /// Takes the displacements back to what they were, to the last bit; what was relaxing then rests
  /// until it is touched. Where they violate a limit or a link of now, the next step puts them to 0
  /// first. An Error where the snapshot is one of other voxels.
  void Restore(const ChainMailSnapshot& snapshot);

  /// Bytes allocated on the device, without the output.
  std::uint64_t GetDeviceMemory() const;

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
