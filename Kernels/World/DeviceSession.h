// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceSession_h
#define DeformVolumeDeviceSession_h

#include "DataStamp.h"
#include "DeformVolumeExport.h"
#include "FadedMesh.h"
#include "IndexDeformation.h"
#include "MappingCache.h"
#include "VolumeDeformer.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace deformvolume
{

/// The masks of a volume; see VolumeDeformer. Null: no mask of this kind.
struct WorldMasks
{
  ///@{
  /// See VolumeDeformer::SetBlanked(), SetActiveTetrahedra() and SetBoundaryDistances().
  const unsigned char* Blanked = nullptr;
  const unsigned char* ActiveTetrahedra = nullptr;
  const float* BoundaryDistances = nullptr;
  ///@}
  ///@{
  /// A smooth cut (VolumeDeformer::SetCut()). Set both arrays or none.
  const unsigned char* CutTetrahedra = nullptr;
  const float* CutDistances = nullptr;
  ///@}
  /// The bits of Blanked that hide a voxel.
  unsigned char BlankedBits = 255;
  ///@{
  /// The values that may have changed since the last call with a mask of this kind. Null: all.
  const PointRanges* WrittenBlanked = nullptr;
  const PointRanges* WrittenActive = nullptr;
  const PointRanges* WrittenDistances = nullptr;
  ///@}
  /// Whether the smooth cut has not changed since the last call of DeviceSession::SetMasks().
  bool HasSameCut = false;
};

/// A VolumeDeformer with a record of the data on its device. Only data that changed are sent. Call
/// SetDevice, SetVoxelGrid, SetArrays, SetMasks, SetDeformation and Deform for each output.
class DEFORMVOLUME_EXPORT DeviceSession
{
public:
  /// Chooses the device and returns its name; see VolumeDeformer.
  std::string SetDevice(const std::string& request, std::uint64_t memoryLimit);

  /// See VolumeDeformer. The mapping is not made, only its size is found.
  void CheckMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
    const Extent& outputExtent, std::uint64_t heldBytes, const IndexDeformation& deformation,
    MappingCache& mapping, const MappedVolume& volume, Resampling method) const;

  /// Sends the voxel grid, and prepares it for arrays. A change to or from the method
  /// MeshRasterization discards everything else.
  void SetVoxelGrid(
    const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays, Resampling method);

  ///@{
  /// Sends arrays or masks, if their stamp is not that of the data on the device. Stamps are never
  /// empty. Without arrays or masks on the device, the stamp of these is empty.
  void SetArrays(const std::vector<VolumeArray>& arrays, const Stamp& stamp);
  void SetMasks(const WorldMasks& masks, const Stamp& stamp);
  const Stamp& GetArraysStamp() const { return this->SentArrays; }
  const Stamp& GetMasksStamp() const { return this->SentMasks; }
  ///@}

  /// Sends the deformation, as far as it has changed. Updates the mapping if it has to be sent.
  /// openSplits: whether gaps open where the mesh is split.
  void SetDeformation(const IndexDeformation& deformation, MappingCache& mapping,
    const MappedVolume& volume, Resampling method, bool openSplits,
    const std::function<bool(double)>& progress);

  /// Makes the output; see VolumeDeformer.
  DeformReport Deform(const DeformRequest& request);

  /// Bytes on the device.
  std::uint64_t GetDeviceMemory() const { return this->Deformer.GetDeviceMemory(); }
  /// Frees the memory of the device. The next calls send all data again.
  void ReleaseMemory();

  /// Number of calls of SetArrays() that sent the arrays.
  std::int64_t GetNumberOfVolumeUploads() const { return this->NumberOfVolumeUploads; }

  /// The arrays and masks of the volume may have changed, although their stamps have not.
  void ForgetValues();

private:
  void Forget();
  /// Calls a function that sends data.
  void Send(const std::function<void()>& send);
  void SetField(const IndexDeformation& deformation, const OutsideVoxels& outside);
  void SetMesh(const IndexDeformation& deformation, MappingCache& mapping,
    const MappedVolume& volume, bool openSplits, const std::function<bool(double)>& progress);
  void SetRestMesh(const IndexDeformation& deformation, const ImageGeometry& volume);
  /// Sends the displacements of nodes. changes: the nodes whose displacements have changed; null:
  /// all.
  void SetNodes(const IndexDeformation& deformation, const PointRanges* changes);
  /// Sends a mesh and its mapping.
  void SendMesh(const MeshAtRest& mesh, const StaticMapping& mapping);
  /// Sends the changed connectivity of a mesh that was sent before.
  void SendConnectivity(const IndexDeformation& deformation, const StaticMapping& mapping);
  /// Whether changes of the connectivity can be sent without the whole mesh.
  bool CanFollow(const IndexDeformation& deformation) const;

  VolumeDeformer Deformer;
  std::string Device;
  FadedMesh Faded; // the mesh on the device, if voxels outside the deformation mesh are kept

  // Contents of the device. Known is false while something is sent: after a call that throws, the
  // contents are unknown, and everything is sent again.
  bool Known = false;
  VoxelGrid SentGrid;
  // Bytes of a voxel in the widest array that the voxel grid was prepared for.
  std::size_t SentWidth = 0;
  bool SentForLinks = false;
  Stamp SentArrays;
  Stamp SentMasks;
  enum class Contents
  {
    None,
    Mesh,
    Field,
    RestMesh,
    InverseField
  };
  Contents Sent = Contents::None;
  bool HasFadedMesh = false;
  std::uint64_t SentConnectivity = 0;
  bool CoincidentNodesAreSent = false;
  std::uint64_t SentMapping = 0;
  std::uint64_t SentVectors = 0;
  OutsideVoxels SentOutside;

  std::int64_t NumberOfVolumeUploads = 0;
};

} // namespace deformvolume

#endif
