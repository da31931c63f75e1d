// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceSession_h
#define DeformVolumeDeviceSession_h

#include "Deformation.h"
#include "FadedMesh.h"
#include "MappingCache.h"
#include "VolumeArrays.h"
#include "VolumeDeformer.h"

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

class vtkImageData;

namespace deformvolume
{

/// Device name with the meaning of "": the best device. For user interfaces, which have to show a
/// name.
constexpr const char* BEST_DEVICE = "best";

/// A VolumeDeformer with a record of the data on its device. Only data that changed are sent.
class DeviceSession
{
public:
  /// Throws an Error if no device matches a request.
  static void CheckDevice(const std::string& request);

  /// The name of the requested device if it has memory of its own, else "".
  static std::string FindOwnMemory(const std::string& request);

  /// Chooses the device and returns its name.
  std::string SetDevice(const std::string& request, std::uint64_t memoryLimit);

  /// See VolumeDeformer.
  void CheckMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
    const Extent& outputExtent, std::uint64_t heldBytes, const Deformation& deformation,
    std::uint64_t runBytes, Resampling method = Resampling::Exact) const;

  /// Sends the volume, its arrays and masks, as far as they have changed. A change to or from the
  /// method MeshRasterization sends all of them. Voxels with an undefined displacement are blanked.
  void SetVolume(const VoxelGrid& voxelGrid, vtkImageData* volume,
    const std::vector<SourceArray>& arrays, double background, const Deformation& deformation,
    const OutsideVoxels& outside, Resampling method = Resampling::Exact);

  /// Sends the deformation, as far as it has changed. Updates the mapping if it has to be sent.
  /// openSplits: whether gaps open where the mesh is split.
  void SetDeformation(const Deformation& deformation, MappingCache& mapping,
    const MappedVolume& volume, bool openSplits, const std::function<bool(double)>& progress);

  /// Sends a mesh or an inverse field for the method MeshRasterization, which uses no mapping.
  void SetRestMesh(const Deformation& deformation, const OutsideVoxels& outside);

  DeformReport Deform(const DeformRequest& request);

  std::uint64_t GetDeviceMemory() const { return this->Deformer.GetDeviceMemory(); }
  void ReleaseMemory();

  std::int64_t GetNumberOfVolumeUploads() const { return this->NumberOfVolumeUploads; }

  /// The arrays and masks of the volume may have changed, although their times have not.
  void ForgetValues();

private:
  void Forget();
  /// Sends the displacements of nodes. changes: the nodes whose displacements have changed; null:
  /// all.
  void SetNodes(const Deformation& deformation, const PointRanges* changes);
  void SetMesh(const Deformation& deformation, MappingCache& mapping, const MappedVolume& volume,
    bool openSplits, const std::function<bool(double)>& progress);
  /// Sends a mesh and its mapping.
  void SendMesh(const RestMesh& mesh, const StaticMapping& mapping, bool byRuns);
  /// Sends the changed connectivity of a mesh that was sent before.
  void SendConnectivity(const RestMesh& mesh, const StaticMapping& mapping);
  /// Whether changes of the connectivity can be sent without the whole mesh.
  bool CanFollow(const RestMesh& mesh) const;

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
  std::pair<std::uint64_t, OutsideVoxels> SentUndefined{ 0, OutsideVoxels() };
  bool MasksAreSet = false;
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
