// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeDeformation_h
#define DeformVolumeVolumeDeformation_h

#include "DeformRequest.h"
#include "DeviceOutputInternals.h"
#include "DeviceVolume.h"
#include "DisplacementSource.h"
#include "Error.h"
#include "ExactResampler.h"
#include "IncrementalOutput.h"
#include "MemoryNeeds.h"
#include "MeshRasterizer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

class MemoryBudget;
class WorkDevice;

/// A volume on the device with the deformation that is set, by the sampling mesh or by mesh
/// rasterisation, and what makes outputs of both. What VolumeDeformer forgets with the voxel grid.
/// See there for what the methods do; where cl::Error is thrown, what is on the device may be half
/// done.
class VolumeDeformation
{
public:
  VolumeDeformation(WorkDevice& device, MemoryBudget& budget, const VoxelGrid& voxelGrid,
    std::size_t bytesPerVoxel, bool withLinks);

  void SetArrays(const std::vector<VolumeArray>& arrays);
  void SetArrayOptions(const std::vector<VolumeArray>& arrays);
  void SetBlanked(const unsigned char* blanked, unsigned char bits, const PointRanges* written);
  void SetActiveTetrahedra(const unsigned char* active, const PointRanges* written);
  void SetBoundaryDistances(const float* distances, const PointRanges* written);
  void SetCut(const unsigned char* crossed, const float* distances);

  ///@{
  /// Meshes and fields that were checked (CheckMesh, CountPoints). Mapping: links or runs.
  template <typename Mapping>
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const Mapping& mapping, const MeshBoundary* boundary)
  {
    this->SetBoundary({}, {}, nullptr);
    this->Source.SetMesh(tetrahedra, numberOfTetrahedra, numberOfNodes, mapping);
    if (boundary)
    {
      this->SetBoundary(*boundary, this->Source.FindNumbers(boundary->Pieces), tetrahedra);
    }
    this->Rasterizer.Clear();
  }
  void ChangeConnectivity(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const std::vector<TetrahedronChange>* changes)
  {
    if (!tetrahedra && !this->Exact.GetBoundary().IsEmpty())
    {
      throw Error("All tetrahedra are needed where the mesh ends within the volume.");
    }
    this->Source.ChangeConnectivity(tetrahedra, numberOfTetrahedra, numberOfNodes, changes);
    this->Exact.GetBoundary().SetCorners(tetrahedra);
  }
  void SetNodePlaces(const std::int32_t* places);
  void SetRestMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const double* restNodes);
  void SetInverseField(const DisplacementField& field);
  void SetNodeDisplacements(
    const float* displacements, const PointRanges* changes, bool areChecked);
  void SetNodeDisplacements(
    const std::shared_ptr<DeviceVectors>& vectors, const std::array<double, 9>& toDisplacement);
  void SetDisplacementField(const DisplacementField& field, const PointRanges* changes);
  void SetDisplacementField(
    const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors);
  ///@}

  /// Throws an Error where something is not set that a request needs.
  void CheckRequest(const DeformRequest& request) const;
  DeformReport Deform(const DeformRequest& request);

  /// Brings to the host what can still be read of the last output and is on the device. Throws
  /// nothing.
  void BringOutput() { this->Unread.Bring(); }

  /// Bytes on the device.
  std::uint64_t GetMemory() const;

private:
  void SetBoundary(const MeshBoundary& boundary, const std::vector<std::int32_t>& numbers,
    const Tetrahedron* tetrahedra);
  /// Finds the boundary of a field, where its mapping is another one than before.
  void UpdateFieldBoundary(const DisplacementField& field);
  /// Throws an Error where there is no deformation mesh.
  void CheckMesh() const;
  DeformationSize GetSize(const DeformRequest& request) const;
  DeformReport Resample(const DeformRequest& request, std::uint64_t spare);
  DeformReport Rasterize(const DeformRequest& request, std::uint64_t spare);

  WorkDevice& Device;
  MemoryBudget& Budget;
  DeviceVolume Volume;
  IncrementalOutput Incremental;
  DisplacementSource Source;
  ExactResampler Exact;
  MeshRasterizer Rasterizer;
  UnreadOutputs Unread;
  DisplacementField BoundaryField; // the one that the boundary was found of, without its vectors
};

} // namespace deformvolume

#endif
