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

/// How an output is made.
enum class Resampling
{
  /// The exact fill rule: every covered voxel is written by exactly one tetrahedron. The kernel is
  /// chosen by device and arrays.
  Exact,
  /// The same with the kernel that takes one cell after the other: any arrays, any device.
  ExactByCell,
  /// The same with the kernel for processors, several cells in the lanes of vector registers: any
  /// arrays; an Error where the output is over 32,768 voxels on an axis, or 2^31 altogether, and on
  /// devices whose work-items have no vector registers for themselves. Linear
  /// arrays of one component, of float or integers of 8 or 16 bits, are interpolated in single
  /// precision.
  ExactByLanes,
  /// The same with the kernel for graphics cards, whose work-items are lanes, each a column of
  /// cells: arrays as above, outputs as above, any device with local memory for it, else an Error.
  ExactByColumns,
  /// The tetrahedra of the deformation mesh themselves are rasterised, and the volume is looked up
  /// at the interpolated rest coordinate (MeshRasterizer.h). Goes with SetRestMesh, and with
  /// SetInverseField, where the field says the rest coordinate.
  MeshRasterization
};

/// How a volume is interpolated at a rest coordinate.
enum class Interpolation
{
  Linear,
  /// Catmull-Rom, over four voxels on each axis, clamped to the range of integer types. With the
  /// exact methods at the rest coordinate that a sample has in its tetrahedron, where all 64 voxels
  /// are there and no cut or boundary passes between them, and linear elsewhere; not with
  /// ExactByLanes and ExactByColumns.
  Cubic
};

/// What VolumeDeformer::Deform() is to do, and the memory for it.
struct DeformRequest
{
  /// The resampler.
  Resampling Method = Resampling::Exact;
  /// How arrays that are not categorical are interpolated.
  deformvolume::Interpolation Interpolation = deformvolume::Interpolation::Linear;
  /// Structured indices of the output voxels.
  Extent OutputExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// The output that these are a part of; empty: they are all of it. What a voxel gets with the
  /// methods Exact, ExactByCell, ExactByLanes and ExactByColumns depends on this one alone, to the
  /// last bit.
  Extent WholeOutputExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// For each array of the volume, room for Components elements a voxel of OutputExtent. A device
  /// that is a processor works there; after a failure the contents are undefined.
  std::vector<void*> Outputs;
  /// Room for one byte a voxel: 1 where the deformed volume covers it, else 0.
  signed char* Coverage = nullptr;
  /// With the exact methods, room for a number a voxel of OutputExtent that is 0 before: where
  /// tetrahedra of the sampling mesh overlap, how many hold the voxel. Not incremental. Null: they
  /// are not counted. Cells at the boundary of the mesh do not count.
  std::uint32_t* FoldCounts = nullptr;
  /// The output may stay on the device until somebody wants it on the host: where that has memory
  /// of its own and makes the output in one piece, DeformReport::DeviceOutputs are it. Outputs and
  /// Coverage get the values when they are read.
  bool MayStayOnDevice = false;
  /// For such outputs: DeformReport::Revision of what the memory of each of Outputs, and then that
  /// of Coverage, holds unchanged, 0: nothing of use. In an update of a part only what has changed
  /// since is then copied there. Empty: they hold nothing.
  std::vector<std::uint64_t> HeldRevisions;
  /// Keeps what is needed to write only what changes until the next call. That call needs the
  /// output of this one in LastOutputs and LastCoverage. Where that is not faster or not possible,
  /// all is written; the result is the same to the last bit. For volumes and outputs within the
  /// allocation limit, and methods Exact, ExactByCell, ExactByLanes and ExactByColumns.
  bool Incremental = false;
  /// What the last call wrote, unchanged: the same memory as Outputs and Coverage, or other memory,
  /// from which it is copied, whatever the device. Empty and null where there is none. An output
  /// that stays on the device needs neither.
  std::vector<const void*> LastOutputs;
  /// As LastOutputs, of Coverage.
  const signed char* LastCoverage = nullptr;
  /// DeformReport::Revision of the output that Outputs and Coverage hold, where these are other
  /// memory than that of the last output, and unchanged; 0: they hold nothing of use. Where it is
  /// the output before the last one, as when two take turns, only what is different is copied.
  std::uint64_t OutputRevision = 0;
  /// Called between launches with the fraction done, 0 to 1; returning false aborts the work.
  std::function<bool(double)> Progress;
  /// Called with true before kernels are compiled, which may take many seconds, and with false
  /// after. In the thread that called Deform().
  std::function<void(bool)> Compiling;
};

/// What VolumeDeformer::Deform() has done.
struct DeformReport
{
  /// Voxels of the output that the deformed volume covers.
  std::int64_t NumberOfCoveredVoxels = 0;
  /// Active tetrahedra of the sampling mesh that the deformation turns inside out; with
  /// MeshRasterization tetrahedra of the deformation mesh.
  std::int64_t NumberOfInvertedTetrahedra = 0;
  /// Cells with a tetrahedron that is stretched over more than 4,000 output voxels; such tetrahedra
  /// are skipped.
  std::int64_t NumberOfOverstretchedCells = 0;
  /// True where tetrahedra overlap, so that a winner had to be chosen: upright before inverted,
  /// then the lowest cell and tetrahedron.
  bool Overlapping = false;
  /// Samples of tetrahedra that others hide there: what the output lacks of the deformed volume.
  /// Not counted in an incremental update.
  std::int64_t NumberOfHiddenSamples = 0;
  /// Tetrahedra of the deformation mesh without volume at rest; counted by MeshRasterization only.
  std::int64_t NumberOfFlatTetrahedra = 0;
  /// Bricks of 192 x 16 x 16 cells of the volume, and how many of them were resampled: fewer only
  /// in an incremental update. 0 for MeshRasterization.
  std::int64_t NumberOfBricks = 0;
  /// The bricks that were resampled.
  std::int64_t NumberOfResampledBricks = 0;
  /// What tells this output from others that this deformer has made; 0: nothing is kept of it.
  std::uint64_t Revision = 0;
  /// The output where it has stayed on the device: that of each array, and then the coverage. Empty
  /// where the memory of the request has it. TransferTime does not count when that is read.
  std::vector<std::shared_ptr<DeviceOutput>> DeviceOutputs;
  /// Holds all output voxels that may differ from the last output: OutputExtent where all was made,
  /// less in an incremental update, empty where nothing changed.
  Extent ChangedExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// Seconds. The exact kernels map and resample in one: their MappingTime is 0. With
  /// MeshRasterization the mapping is the listing of the tetrahedra of each part of the output.
  double MappingTime = 0.0;
  /// Seconds for the resampling.
  double ResamplingTime = 0.0;
  /// Seconds for copies to and from the device.
  double TransferTime = 0.0;
  /// The compilation of kernels; it is part of no other time.
  double CompilationTime = 0.0;
};

} // namespace deformvolume

#endif
