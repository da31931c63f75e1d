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

struct DeformationSize;

/// Deforms a volume on an OpenCL device. Keeps the volume, its sampling mesh and the static mapping
/// there; each call of Deform maps the vertices and resamples.
///
/// Call SetDevice, SetVoxelGrid and SetArrays; then SetMesh or SetRestMesh and
/// SetNodeDisplacements, or SetDisplacementField; then Deform any number of times. SetBlanked,
/// SetActiveTetrahedra, SetBoundaryDistances and SetCut are optional. SetVoxelGrid discards the
/// arrays, the masks and the deformation. Pointers are only used during the call, except for data
/// of arrays that have an owner. Every failure throws an Error; the object can be used again
/// afterwards.
class DEFORMVOLUME_EXPORT VolumeDeformer
{
public:
  VolumeDeformer();
  ~VolumeDeformer();
  VolumeDeformer(const VolumeDeformer&) = delete;
  VolumeDeformer& operator=(const VolumeDeformer&) = delete;

  /// Set the device (see ResolveDevice); returns its name. A change of device discards the volume
  /// and its deformation. An update begins with this call and ends with Deform. The free memory is
  /// measured once during an update, and again if a fold or a simulation needs more.
  std::string SetDevice(const std::string& request);

  /// Set the memory that may be used on the device, in bytes. Default 0: all that the device (for a
  /// CPU, the system) has available.
  void SetMemoryLimit(std::uint64_t bytes);

  /// Set the largest allocation on the device, in bytes. Default 0: the limit of the device. Larger
  /// volumes and outputs are divided into chunks. Results do not depend on this limit.
  void SetAllocationLimit(std::uint64_t bytes);

  /// Set the number of work-items in a work-group along the rows of the volume. Default 0: chosen
  /// for the device. Results do not depend on this size.
  void SetWorkGroupSize(std::size_t size);

  /// Checks that a voxel grid, arrays and an output of these sizes fit into memory, before anything
  /// is allocated. Throws an Error with the needed and available bytes. The estimate includes what
  /// the caller is about to allocate: the output, and the links or runs of a mesh. heldBytes:
  /// memory that the caller already holds for the output.
  void CheckMemory(const DeformationSize& size, std::uint64_t heldBytes = 0) const;

  /// Set the voxel grid. bytesPerVoxel: the size of a voxel in the widest array that will be set.
  /// withLinks: whether links may be set. Both decide how a volume above the allocation limit is
  /// divided into chunks. MeshRasterization does not support volumes in several chunks.
  void SetVoxelGrid(
    const VoxelGrid& voxelGrid, std::size_t bytesPerVoxel = 16, bool withLinks = true);
  /// Whether a grid is set. After a failure of the device, there is none.
  bool HasVoxelGrid() const;
  /// Set the arrays of the volume, in the order of DeformRequest::Outputs. The types and numbers of
  /// components select the kernels that are compiled.
  void SetArrays(const std::vector<VolumeArray>& arrays);

  /// Changes which arrays are categorical, and their background values. The arrays must have the
  /// types and components that were set; their values are not sent again.
  void SetArrayOptions(const std::vector<VolumeArray>& arrays);

  ///@{
  /// Set masks. Only values that differ from the last mask are sent. written: ranges of values that
  /// may have changed since the last call with a mask of this kind for this voxel grid; other
  /// values are not read. Null: all values are compared.

  /// One byte per voxel. A voxel is hidden (blanked or a ghost) if its byte has one of `bits` set.
  /// Null: no voxel is hidden.
  void SetBlanked(
    const unsigned char* blanked, unsigned char bits = 255, const PointRanges* written = nullptr);
  /// One byte per cell: bit i is set if tetrahedron i is active. Null: all are active.
  void SetActiveTetrahedra(const unsigned char* active, const PointRanges* written = nullptr);
  /// One float per voxel: its signed distance, in any unit, from the surface of the carved region;
  /// negative inside it. The distance is interpolated in each tetrahedron. Samples with a negative
  /// distance are not covered, so the surface can lie between voxels. Not-a-number counts as not
  /// negative. Null: no distances. Takes 4 bytes per voxel on the device if any distance is not 0.
  void SetBoundaryDistances(const float* distances, const PointRanges* written = nullptr);
  ///@}

  /// Set a smooth cut. crossed: one byte per cell; bit i is set if tetrahedron i is crossed.
  /// distances: one float per voxel, its signed distance from the sheet in any unit; only vertices
  /// of crossed tetrahedra matter. An active crossed tetrahedron that has vertices with negative
  /// and with other distances is divided: each side has a copy that moves with the vertices of that
  /// side (rule in CutPositions.cl). So the sides can separate, and no tissue between them is lost.
  /// They stay connected where they are less than 1/4 output voxel apart on each axis, and at the
  /// end of a cut, where tetrahedra are not divided. Null for both: no cut. Deform throws an Error
  /// if a cut is combined with MeshRasterization. Takes 44 bytes on the device per vertex of a cell
  /// with crossed tetrahedra.
  void SetCut(const unsigned char* crossed, const float* distances);

  /// Set a tetrahedral deformation mesh, with a link for each voxel. boundary: the boundary of the
  /// mesh inside the volume (StaticMapping::Boundary); the deformed volume then ends exactly where
  /// the deformed mesh ends. Null: it ends with the last tetrahedra of the sampling mesh that have
  /// all vertices in the mesh.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexLink* links, const MeshBoundary* boundary = nullptr);
  /// The same with runs of voxels. Displacements equal those by links up to rounding errors below
  /// 1/1024 output voxel, for displacements below 8,192 voxels (bound in VertexRuns.h). If all
  /// nodes have the same displacement, each voxel has exactly that displacement.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexRuns& runs, const MeshBoundary* boundary = nullptr);
  /// Changes the connectivity of some tetrahedra of the mesh that SetMesh set, for example after a
  /// split. The number and the rest shapes of the tetrahedra stay the same, so their links or runs
  /// are kept. The number of nodes may change. changes: the changes since the last call, each
  /// tetrahedron once. Null: changes are found by comparing. Call SetNodeDisplacements afterwards,
  /// with the displacements of all new nodes.
  void ChangeConnectivity(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const std::vector<TetrahedronChange>* changes = nullptr);
  /// Opens gaps where the mesh is split: tetrahedra of the sampling mesh with vertices on both
  /// sides are switched off (rule in ResampledMask.cl). numbers: one number per node; nodes with
  /// the same rest position have the same number. Call this again after SetMesh and
  /// ChangeConnectivity. Null (default): no gaps.
  void SetCoincidentNodes(const std::int32_t* numbers);
  /// Set the deformation mesh for MeshRasterization. Use this instead of SetMesh. restNodes: three
  /// values per node, continuous indices of the volume.
  void SetRestMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const double* restNodes);
  /// Set an inverse displacement field for MeshRasterization. Use this instead of SetRestMesh.
  /// Vectors of the field, in output voxels, lead from a point of the output to the point of the
  /// volume at rest whose values the output has there. IndexToField takes indices of the output.
  /// Vectors that are not-a-number on all axes are undefined. Output voxels whose interpolation
  /// needs an undefined vector are not covered.
  void SetInverseField(const DisplacementField& field);
  /// Set the displacements of the nodes, three floats each, in output voxels. changes: the nodes
  /// that may have changed since the last successful call for this mesh; other values are not read.
  /// Null: all may have changed. areChecked: the caller knows that all values are finite and at
  /// most LargestDisplacement; otherwise they are checked.
  void SetNodeDisplacements(
    const float* displacements, const PointRanges* changes = nullptr, bool areChecked = false);

  /// The same with vectors on the device of the volume, one for each node. toDisplacement: see
  /// DisplacementField. The vectors know what changed since the last call with them. On a device
  /// with its own memory, vectors are not copied through the host, with two exceptions:
  /// MeshRasterization, and a toDisplacement other than the identity on a device without double
  /// precision.
  void SetNodeDisplacements(const std::shared_ptr<DeviceVectors>& vectors,
    const std::array<double, 9>& toDisplacement = DisplacementField().ToDisplacement);

  /// Set a displacement field. changes: the points that may have changed since the last field;
  /// ignored if the last field had another grid or another matrix. Null: all may have changed.
  void SetDisplacementField(const DisplacementField& field, const PointRanges* changes = nullptr);

  /// The same with vectors on the device of the volume. Vectors and Owner of `field` are ignored.
  /// On a CPU device, the memory of the vectors is used in place.
  void SetDisplacementField(
    const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors);

  /// Deforms the volume into the memory of the request. Throws Aborted if the progress callback
  /// requested it.
  DeformReport Deform(const DeformRequest& request);

  /// Returns the memory allocated on the device, in bytes.
  std::uint64_t GetDeviceMemory() const;

  /// Frees all memory on the device.
  void ReleaseMemory();

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
