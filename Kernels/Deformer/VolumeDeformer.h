// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeDeformer_h
#define DeformVolumeVolumeDeformer_h

#include "DeformRequest.h"
#include "DeformVolumeExport.h"
#include "DeviceVectors.h"
#include "DisplacementField.h"
#include "Error.h"
#include "MeshBoundary.h"
#include "PointRanges.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"
#include "VolumeArray.h"
#include "VoxelGrid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace deformvolume
{

/// Deforms a volume on an OpenCL device: keeps the volume, its sampling mesh and the static
/// mapping there, and maps and resamples whenever it is asked to.
///
/// Order of calls: SetDevice, SetVoxelGrid, SetArrays, then SetMesh or SetRestMesh and
/// SetNodeDisplacements, or SetDisplacementField, then Deform, as often as wanted. SetBlanked,
/// SetActiveTetrahedra, SetBoundaryDistances and SetCut are optional. SetVoxelGrid forgets
/// everything that was set after it. Pointers are used during the call only, but for the data of
/// arrays that have an owner. Every failure is an Error; the object can be used again afterwards.
class DEFORMVOLUME_EXPORT VolumeDeformer
{
public:
  VolumeDeformer();
  ~VolumeDeformer();
  VolumeDeformer(const VolumeDeformer&) = delete;
  VolumeDeformer& operator=(const VolumeDeformer&) = delete;

  /// Chooses the device (see ResolveDevice) and returns its name. A change of device forgets
  /// all that was set. An update begins here: how much memory is free is measured once from
  /// this call to the end of Deform, and again where a fold or a simulation needs more.
  std::string SetDevice(const std::string& request);

  /// Bytes that may be used on the device; 0: what the device (and for a processor, the
  /// system) has available.
  void SetMemoryLimit(std::uint64_t bytes);

  /// Bytes of one allocation on the device at most; 0: what the device allows. Volumes and outputs
  /// over it are worked on in chunks; results do not depend on it.
  void SetAllocationLimit(std::uint64_t bytes);

  /// Work-items in a work-group along the rows of the volume; 0: chosen by device. Results do
  /// not depend on it.
  void SetWorkGroupSize(std::size_t size);

  /// Checks that a voxel grid, arrays and an output of these sizes fit into the memory of the
  /// device, before anything is allocated; throws an Error that names the bytes needed and
  /// available. outputExtent is that of the output; the values of the arrays are not read. Counts
  /// what the caller is about to allocate, too: the output, and the links or runs of a mesh.
  /// runBytes: GetRunBytes (VertexRuns.h) where the mesh comes with runs, 0 where it comes with
  /// links. heldBytes: how much memory for the output the caller has already.
  void CheckMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
    const Extent& outputExtent, std::size_t numberOfNodes, std::size_t numberOfTetrahedra,
    bool field, std::uint64_t runBytes = 0, std::uint64_t heldBytes = 0) const;

  /// The same for MeshRasterization, which needs neither links nor runs. With an inverse field
  /// numberOfNodes are its points, and there are no tetrahedra.
  void CheckRasterizationMemory(const VoxelGrid& voxelGrid, const std::vector<VolumeArray>& arrays,
    const Extent& outputExtent, std::size_t numberOfNodes, std::size_t numberOfTetrahedra,
    std::uint64_t heldBytes = 0) const;

  /// bytesPerVoxel: a voxel's bytes in the widest array that will be set; it decides how a volume
  /// over the allocation limit is split, and so does whether links may be set. MeshRasterization
  /// needs the volume whole.
  void SetVoxelGrid(
    const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel = 16, bool withLinks = true);
  /// The arrays of the volume, in the order of DeformRequest::Outputs. Types and components decide
  /// which kernels are compiled.
  void SetArrays(const std::vector<VolumeArray>& arrays);

  /// Changes which arrays are categorical and their background, and sends nothing: of arrays of the
  /// types and components that were set.
  void SetArrayOptions(const std::vector<VolumeArray>& arrays);

  ///@{
  /// Masks; what differs from the last ones is found by comparing, at the speed of memory, and only
  /// that is sent. written: places of the mask; all others are as in the last call that was given a
  /// mask of this kind, if there was one for this voxel grid, and are not looked at. Null: any may
  /// have been written.

  /// One byte a voxel: nonzero, as far as some bits go, where the voxel is no source (blanked or a
  /// ghost). Null: all are.
  void SetBlanked(
    const unsigned char* blanked, unsigned char bits = 255, const PointRanges* written = nullptr);
  /// One byte a cell, bit i = tetrahedron i is active. Null: all are.
  void SetActiveTetrahedra(const unsigned char* active, const PointRanges* written = nullptr);
  /// One float a voxel: its signed distance to the boundary of what has been carved out, in any
  /// unit; negative there. It is interpolated in each tetrahedron as values are, and samples where
  /// it is negative are left out: boundaries that lie between voxels. A distance that is no number
  /// counts as not negative. Null: nothing is left out. Takes 4 bytes a voxel on the device where a
  /// distance is not 0.
  void SetBoundaryDistances(const float* distances, const PointRanges* written = nullptr);
  ///@}

  /// A smooth cut: crossed tetrahedra, one byte a cell, bit i = tetrahedron i is crossed, and one
  /// float a voxel, its signed distance from the sheet in any unit, of which those of the vertices
  /// of crossed tetrahedra matter. An active crossed tetrahedron with vertices on both sides, where
  /// the distance is negative and where it is not, is there twice: as the part on each side that
  /// moves with the vertices of that side (CutPositions.cl has the rule). So the sides come apart
  /// and no tissue is lost between them. They stay together where they are apart by less than 1/4
  /// output voxel on each axis, and at the end of a cut, where tetrahedra that are not divided join
  /// them. Null for both: there is no cut. MeshRasterization is an Error then. Takes 44 bytes on
  /// the device for each vertex of a cell with crossed tetrahedra.
  void SetCut(const unsigned char* crossed, const float* distances);

  /// A tetrahedral deformation mesh, with a link for each voxel. boundary: where that of the mesh
  /// passes through the volume (StaticMapping::Boundary): the deformed volume ends where the
  /// deformed mesh ends. Null: it ends with the last tetrahedra of the sampling mesh that have all
  /// of their voxels in the mesh.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexLink* links, const MeshBoundary* boundary = nullptr);
  /// The same with runs of voxels. Displacements are as exact as by links but for rounding errors
  /// of less than 1/1024 output voxel where they are under 8,192 voxels (VertexRuns.h has the
  /// bound); equal displacements of all nodes move each voxel by exactly that.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexRuns& runs, const MeshBoundary* boundary = nullptr);
  /// The same mesh, of as many tetrahedra, where some have got other nodes, and there are more
  /// nodes, or fewer: after SetMesh, whose links or runs stay, as the nodes lie at rest where the
  /// others did. changes: what has changed since the last call, each tetrahedron once; null: that
  /// is found by comparing. SetNodeDisplacements follows, for all nodes whose displacement was not
  /// set.
  void ChangeConnectivity(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const std::vector<TetrahedronChange>* changes = nullptr);
  /// Opens a gap where the mesh is split: tetrahedra of the sampling mesh with vertices on both
  /// sides are left out (BridgeMask.cl has the rule). places: for each node a number that all nodes
  /// with one place at rest share. To be called again after SetMesh and ChangeConnectivity.
  /// Null: no gaps open, the default.
  void SetNodePlaces(const std::int32_t* places);
  /// The deformation mesh for MeshRasterization, in place of SetMesh. restNodes: three numbers a
  /// node, continuous indices of the volume.
  void SetRestMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const double* restNodes);
  /// An inverse displacement field for MeshRasterization, in place of SetRestMesh: its vectors, in
  /// output voxels, lead from a point of the output to the point of the volume at rest that is seen
  /// there, and IndexToField takes an index of the output. Vectors that are not-a-number on all
  /// axes are undefined: output voxels whose interpolation needs one are not covered.
  void SetInverseField(const DisplacementField& field);
  /// Displacements of the nodes, three floats each, in output voxels. changes: all others are those
  /// of the last call, and are not looked at, if there was one for this mesh and it did not fail.
  /// Null: any may have changed. areChecked: they are known to be finite, and none is over
  /// LargestDisplacement; else that is looked at.
  void SetNodeDisplacements(
    const float* displacements, const PointRanges* changes = nullptr, bool areChecked = false);

  /// The same of vectors on the device of the volume, a vector for each node. toDisplacement takes
  /// them to displacements, see DisplacementField. On a device with memory of its own nothing
  /// passes through the host, but where there is no double precision and toDisplacement is not the
  /// identity, and for MeshRasterization. What has changed since the last call with these vectors
  /// is known by them.
  void SetNodeDisplacements(const std::shared_ptr<DeviceVectors>& vectors,
    const std::array<double, 9>& toDisplacement = DisplacementField().ToDisplacement);

  /// changes: as above, for fields of the same dimensions.
  void SetDisplacementField(const DisplacementField& field, const PointRanges* changes = nullptr);

  /// A field of vectors on the device of the volume, as above. Vectors and Owner of field are not
  /// used; on a processor the vectors are what Owner keeps.
  void SetDisplacementField(
    const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors);

  /// Deforms the volume into the memory of the request. Throws Aborted where the progress callback
  /// asked for an end.
  DeformReport Deform(const DeformRequest& request);

  /// Bytes allocated on the device.
  std::uint64_t GetDeviceMemory() const;

  /// Frees all that is held on the device.
  void ReleaseMemory();

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
