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

/// Computes displacements of the voxels of a volume by ChainMail. Each voxel is linked to its six
/// neighbors, and links can be deformed within limits. Handles move voxels, and other voxels follow
/// as far as the limits require, each by the smallest possible amount. The run time of a step
/// depends only on the voxels that move.
///
/// Displacements are multiples of 1/65536 voxel. Results are bit for bit the same for any device,
/// size of work-groups and order of blocks.
///
/// Call SetDevice, SetVoxelGrid, SetMaterials and SetOutput, then Step any number of times.
/// SetActiveTetrahedra and SetPinned are optional. SetVoxelGrid discards the materials, active
/// tetrahedra, pinned voxels and output that were set before. Every failure throws an Error. All
/// settings and displacements are then unchanged, except after failures of the device, which
/// require a new call of SetVoxelGrid.
///
/// Memory on the device: 12 bytes per voxel for the displacement, and one byte each for flags,
/// links and material, in blocks of 8 x 8 x 8 voxels (partly filled at the end of each axis).
/// Memory on the host: one byte per voxel if SetActiveTetrahedra was called with a mask. A step
/// needs no other memory: it keeps the displacements that it may have to restore in the memory of
/// the output.
class DEFORMVOLUME_EXPORT ChainMailModel
{
public:
  /// The largest displacement, in voxels on each axis.
  static constexpr double LargestDisplacement = 4095.0;

  ChainMailModel();
  ~ChainMailModel();
  ChainMailModel(const ChainMailModel&) = delete;
  ChainMailModel& operator=(const ChainMailModel&) = delete;

  /// Set the device (see ResolveDevice); returns its name. A change of device discards the voxel
  /// grid and all that depends on it.
  std::string SetDevice(const std::string& request);

  /// Set the memory that may be used on the device, in bytes. Default 0: all that is available.
  void SetMemoryLimit(std::uint64_t bytes);

  /// Set the number of work-items in a work-group. Default 0: chosen for the device. Call it before
  /// SetVoxelGrid.
  void SetWorkGroupSize(std::size_t size);

  /// Set the order in which blocks are visited: 0 for the default order, other numbers for
  /// different random orders. Results do not depend on it.
  void SetBlockOrder(unsigned int order);

  /// Set the voxel grid. extent: structured indices of the voxels, at least two on each axis.
  /// indexToWorld: row-major 3 x 3; its columns are the steps to the next voxel on each axis. All
  /// voxels are then at rest and have the default material. Throws an Error if there is not enough
  /// memory for the voxels and an output.
  void SetVoxelGrid(const Extent& extent,
    const std::array<double, 9>& indexToWorld = { { 1, 0, 0, 0, 1, 0, 0, 0, 1 } });

  /// Set the materials. table: 1 to 256 materials. indices: the material of each voxel, x varying
  /// fastest; null: the first one. If displacements violate the new limits, all displacements are
  /// set to 0; otherwise they do not change.
  void SetMaterials(
    const std::vector<ChainMailMaterial>& table, const unsigned char* indices = nullptr);

  /// Set the active tetrahedra. One byte per cell: bit i is set if tetrahedron i is active; null:
  /// all are active. A link exists if any of the up to four tetrahedra with this edge is active. A
  /// voxel is an element if any of its tetrahedra is active. Voxels are therefore connected by
  /// links only if they are connected by active tetrahedra. Changes are found by a comparison with
  /// the last mask. If displacements violate restored links, all displacements are set to 0.
  void SetActiveTetrahedra(const unsigned char* active);

  /// Set the pinned voxels. One byte per voxel: nonzero if the voxel must not move. Null: no voxel
  /// is pinned.
  void SetPinned(const unsigned char* pinned);

  /// Set the memory for the output: three floats per voxel, x varying fastest, the displacements in
  /// world units. The memory must remain valid until SetOutput is called again. This call writes
  /// all of it. A step writes only what changes; during a step the contents are undefined.
  void SetOutput(float* output);

  /// Set vectors on the device of the model as the output, one vector for each voxel. On a device
  /// with its own memory they are not copied through the host. The vectors record what each step
  /// has changed. If a step fails and the voxel grid must be set again, the values of the vectors
  /// are undefined.
  void SetOutput(const std::shared_ptr<DeviceVectors>& output);

  /// Throws the Error that SetMaterials would throw for this table.
  static void CheckMaterials(const std::vector<ChainMailMaterial>& table);
  /// Throws the Error that Step would throw for this request and voxels of an extent.
  static void CheckRequest(const Extent& extent, const ChainMailRequest& request);

  /// Moves the handles, then relaxes.
  ChainMailReport Step(const ChainMailRequest& request);

  /// Sets all displacements to 0.
  void Reset();

  /// Returns a copy of the current displacements. last: null, or another snapshot with which
  /// unchanged blocks are shared.
  std::shared_ptr<const ChainMailSnapshot> TakeSnapshot(
    const std::shared_ptr<const ChainMailSnapshot>& last = {});
  /// Restores the displacements of a snapshot bit for bit. Blocks that were relaxing stop relaxing.
  /// If the displacements violate current limits or links, the next step first sets them to 0.
  /// Throws an Error if the snapshot was taken of another extent.
  void Restore(const ChainMailSnapshot& snapshot);

  /// Returns the memory allocated on the device, in bytes, without the output.
  std::uint64_t GetDeviceMemory() const;

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
