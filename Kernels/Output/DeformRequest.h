// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformRequest_h
#define DeformVolumeDeformRequest_h

#include "DeviceOutput.h"
#include "Extent.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The method that computes an output.
enum class Resampling
{
  /// Every covered voxel is written by exactly one tetrahedron of the sampling mesh. The kernel is
  /// chosen for the device and the arrays.
  Exact,
  /// Exact, with the kernel that handles one cell at a time. For any arrays and any device.
  ExactByCell,
  /// Exact, with the CPU kernel that handles several cells in the lanes of vector registers. For
  /// any arrays. Linear arrays of one component, of type float or 8- or 16-bit integer, are
  /// interpolated in single precision. Throws Error if the whole output has more than 32,768 voxels
  /// on an axis, or if work-items of the device have no vector registers of their own.
  ExactByLanes,
  /// Exact, with the GPU kernel in which each work-item is a lane and handles a column of cells.
  /// Arrays and outputs as for ExactByLanes. Throws Error if the device has too little local
  /// memory.
  ExactByColumns,
  /// Rasterizes the tetrahedra of the deformation mesh, and samples the volume at the interpolated
  /// rest coordinate (MeshRasterizer.h). Needs SetRestMesh, or SetInverseField, whose field gives
  /// the rest coordinate.
  MeshRasterization
};

/// How a volume is interpolated at a rest coordinate.
enum class Interpolation
{
  Linear,
  /// Catmull-Rom interpolation over four voxels on each axis, clamped to the range of integer
  /// types. The exact methods evaluate it at the rest coordinate of a sample in its tetrahedron, if
  /// all 64 voxels exist and no cut or boundary lies between them; otherwise they interpolate
  /// linearly. Not supported by ExactByLanes and ExactByColumns.
  Cubic
};

/// The input of VolumeDeformer::Deform(), and the memory for its output.
struct DeformRequest
{
  /// The resampling method. Default: Exact.
  Resampling Method = Resampling::Exact;
  /// The interpolation of arrays that are not categorical. Default: Linear.
  deformvolume::Interpolation Interpolation = deformvolume::Interpolation::Linear;
  /// The structured extent of the output voxels.
  Extent OutputExtent = EmptyExtent;
  /// The whole output, if OutputExtent is a part of it; empty: OutputExtent is the whole. With the
  /// exact methods, the value of a voxel depends on this extent only, bit for bit.
  Extent WholeOutputExtent = EmptyExtent;
  /// For each array of the volume, memory for Components elements per voxel of OutputExtent. A CPU
  /// device works directly in this memory. After a failure the contents are undefined.
  std::vector<void*> Outputs;
  /// Memory for one byte per voxel: 1 if the deformed volume covers the voxel, otherwise 0.
  signed char* Coverage = nullptr;
  /// Memory for one number per voxel of OutputExtent, initially 0: the number of tetrahedra of the
  /// sampling mesh that contain the voxel. Written only if tetrahedra overlap. Cells at the
  /// boundary of the mesh are not counted. Only with the exact methods, and not incremental. Null:
  /// not counted.
  std::uint32_t* FoldCounts = nullptr;
  /// Whether the output may stay on the device until it is needed on the host. This requires a
  /// device with its own memory that computes the output in one slab. DeformReport::DeviceOutputs
  /// then has the output, and Outputs and Coverage receive their values when it is read.
  bool MayStayOnDevice = false;
  /// For outputs that stay on the device: for the memory of each array in Outputs, then for
  /// Coverage, the DeformReport::Revision of the output that the memory still holds unchanged; 0:
  /// none. After an incremental update, only later changes are copied to that memory. Empty: none.
  std::vector<std::uint64_t> HeldRevisions;
  /// Whether to keep what the next call needs to write only the voxels that change. That call needs
  /// this output in LastOutputs and LastCoverage. If an incremental update is not possible or not
  /// faster, all voxels are written; the result is the same bit for bit. Supported by the exact
  /// methods, for volumes and outputs within the allocation limit.
  bool Incremental = false;
  /// The arrays of the output of the last call, unchanged: the same memory as Outputs, or other
  /// memory, which is then copied. Empty if there is no such output. Not needed for an output that
  /// stays on the device.
  std::vector<const void*> LastOutputs;
  /// The coverage of the output of the last call, as LastOutputs. Null if there is no such output.
  const signed char* LastCoverage = nullptr;
  /// If Outputs and Coverage are not the memory of the last output: the DeformReport::Revision of
  /// the output that they still hold unchanged; 0: none. With two alternating output buffers, this
  /// is the output before the last one, and only differences are copied.
  std::uint64_t OutputRevision = 0;
  /// Called between launches with the completed fraction, 0 to 1. Return false to abort.
  std::function<bool(double)> Progress;
  /// Called with true before kernels are compiled, which can take many seconds, and with false
  /// afterwards. The thread that called Deform() calls it.
  std::function<void(bool)> Compiling;
};

/// The result of VolumeDeformer::Deform().
struct DeformReport
{
  /// The number of output voxels that the deformed volume covers.
  std::int64_t NumberOfCoveredVoxels = 0;
  /// The number of active tetrahedra of the sampling mesh that the deformation inverts; with
  /// MeshRasterization, of tetrahedra of the deformation mesh.
  std::int64_t NumberOfInvertedTetrahedra = 0;
  /// The number of cells with a tetrahedron that extends over more than 4,000 output voxels. Such
  /// tetrahedra are skipped.
  std::int64_t NumberOfOverstretchedCells = 0;
  /// Whether tetrahedra overlap. If several contain a voxel, upright tetrahedra win over inverted
  /// ones; among these, the tetrahedron with the lowest cell and number wins.
  bool Overlapping = false;
  /// The number of samples that winners of overlaps hide, and that are therefore missing in the
  /// output. Not counted in an incremental update.
  std::int64_t NumberOfHiddenSamples = 0;
  /// The number of tetrahedra of the deformation mesh without volume at rest. Only for
  /// MeshRasterization.
  std::int64_t NumberOfFlatTetrahedra = 0;
  /// The number of bricks of 192 x 16 x 16 cells of the volume; 0 for MeshRasterization.
  std::int64_t NumberOfBricks = 0;
  /// The number of bricks that were resampled; less than NumberOfBricks in an incremental update.
  std::int64_t NumberOfResampledBricks = 0;
  /// Identifies this output among the outputs of this deformer. 0: the deformer keeps no data of
  /// this output.
  std::uint64_t Revision = 0;
  /// The output if it stayed on the device: one object for each array, then one for the coverage.
  /// Empty if the output is in the memory of the request. TransferTime does not include the time of
  /// DeviceOutput::Read().
  std::vector<std::shared_ptr<DeviceOutput>> DeviceOutputs;
  /// A box of all output voxels that may differ from the last output: OutputExtent after a full
  /// update; smaller after an incremental update; empty if nothing changed.
  Extent ChangedExtent = EmptyExtent;
  /// The time of the mapping, in seconds. With the exact methods only that of the tetrahedra of
  /// runs and of cells at the boundary, since other kernels map and resample together. With
  /// MeshRasterization, the time to list the tetrahedra of each part of the output.
  double MappingTime = 0.0;
  /// The time of the resampling, in seconds.
  double ResamplingTime = 0.0;
  /// The time of copies to and from the device, in seconds.
  double TransferTime = 0.0;
  /// The time of compiling kernels, in seconds. Not included in the other times.
  double CompilationTime = 0.0;
};

} // namespace deformvolume

#endif
