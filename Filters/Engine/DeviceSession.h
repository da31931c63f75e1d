// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeviceSession_h
#define DeformVolumeDeviceSession_h

#include "CoincidentNodes.h"
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

/// Stands for no wish, as "" does, where a wish has to be seen.
constexpr const char* BEST_DEVICE = "best";

/// Tells apart what needs different kernels. form: of the mapping.
std::string GetKernelKey(const std::string& device, const DeformRequest& request,
  const std::string& form, const std::vector<VolumeArray>& arrays);

/// A VolumeDeformer that remembers what it was sent and is sent only what changed.
class DeviceSession
{
public:
  /// Throws an Error where no device answers to a request.
  static void CheckDevice(const std::string& request);

  /// The name of the device for a request where it has memory of its own, else nothing.
  static std::string FindOwnMemory(const std::string& request);

  /// Chooses the device and returns its name.
  std::string SetDevice(const std::string& request, std::uint64_t memoryLimit);

  /// See VolumeDeformer.
  void CheckMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
    const Extent& outputExtent, std::uint64_t heldBytes, const Deformation& deformation,
    std::uint64_t runBytes, Resampling method = Resampling::Exact) const;

  /// A change to or from the method MeshRasterization sends the volume anew.
  /// Voxels whose displacement is undefined count as blanked.
  void SetVolume(const VoxelGrid& voxelGrid, vtkImageData* volume,
    const std::vector<SourceArray>& arrays, double background, const Deformation& deformation,
    const OutsideVoxels& outside, Resampling method = Resampling::Exact);

  /// Brings the mapping up to date, too, where it has to be sent. openSplits: whether gaps open
  /// where the mesh is split.
  void SetDeformation(const Deformation& deformation, MappingCache& mapping,
    const MappedVolume& volume, bool openSplits, const std::function<bool(double)>& progress);

  /// A mesh, or an inverse field, for the method MeshRasterization: there is no mapping.
  void SetRestMesh(const Deformation& deformation, const OutsideVoxels& outside);

  DeformReport Deform(const DeformRequest& request);

  std::uint64_t GetDeviceMemory() const { return this->Deformer.GetDeviceMemory(); }
  void ReleaseMemory();

  std::int64_t GetNumberOfVolumeUploads() const { return this->NumberOfVolumeUploads; }

private:
  class Transfer;

  void Forget();
  /// Sends the displacements of nodes. changes: null, or others are as before.
  void SetNodes(const Deformation& deformation, const PointRanges* changes);
  void SetMesh(const Deformation& deformation, MappingCache& mapping, const MappedVolume& volume,
    bool openSplits, const std::function<bool(double)>& progress);
  /// Sends a mesh and its mapping, or what has changed of its tetrahedra.
  void SendMesh(const RestMesh& mesh, const StaticMapping& mapping, bool byRuns);
  void SendConnectivity(const RestMesh& mesh, const StaticMapping& mapping);
  /// Whether what has changed of the tetrahedra can be sent as changes.
  bool CanFollow(const RestMesh& mesh) const;

  VolumeDeformer Deformer;
  std::string Device;
  FadedMesh Faded; // what the device has, where voxels outside the mesh are kept

  // What the device has. A call that throws leaves it unknown, and then everything is sent again.
  bool Known = false;
  VoxelGrid SentGrid;
  // Bytes of a voxel in the widest array that the voxel grid was prepared for.
  std::size_t SentWidth = 0;
  bool SentForLinks = false;
  Stamp SentArrays;
  Stamp SentMasks;
  std::pair<std::uint64_t, OutsideVoxels> SentUndefined{ 0, OutsideVoxels() };
  bool MasksAreSet = false;
  bool HasMesh = false;
  bool HasFadedMesh = false;
  bool HasField = false;
  bool HasInverseField = false;
  bool HasRestMesh = false;
  std::uint64_t SentConnectivity = 0;
  CoincidentNodes Coincident;
  bool CoincidentNodesAreSent = false;
  std::uint64_t SentMapping = 0;
  std::uint64_t SentVectors = 0;
  OutsideVoxels SentOutside;

  std::int64_t NumberOfVolumeUploads = 0;
};

} // namespace deformvolume

#endif
