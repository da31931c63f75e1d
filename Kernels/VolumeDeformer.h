// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeDeformer_h
#define DeformVolumeVolumeDeformer_h

#include "ElementType.h"
#include "Error.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace deformvolume
{

/// An extent in structured indices, both ends included: x min, x max, y min, y max, z min, z max.
using Extent = std::array<int, 6>;

/// Points of an extent along an axis, and altogether; 0 where it is empty.
inline std::int64_t GetSize(const Extent& extent, int axis)
{
  const std::int64_t size = static_cast<std::int64_t>(extent[2 * axis + 1]) - extent[2 * axis] + 1;
  return size > 0 ? size : 0;
}
inline std::int64_t GetNumberOfPoints(const Extent& extent)
{
  return GetSize(extent, 0) * GetSize(extent, 1) * GetSize(extent, 2);
}
inline std::int64_t GetNumberOfCells(const Extent& extent)
{
  std::int64_t cells = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    cells *= GetSize(extent, axis) > 1 ? GetSize(extent, axis) - 1 : 0;
  }
  return cells;
}

/// The implicit sampling mesh. Its vertices are the voxels of the volume at rest.
struct Lattice
{
  /// Structured indices of the voxels. Their parity decides the 5T split.
  Extent VertexExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// Voxel (i, j, k) at rest has the continuous output index Scale * (i, j, k), axis by axis:
  /// the ratio of the volume's spacing to the output's; 1 where both share one spacing.
  std::array<double, 3> Scale{ { 1.0, 1.0, 1.0 } };
  /// Structured indices of the volume that the voxels are a part of; empty: they are all of it.
  /// Voxels of a part are displaced as in the whole, to the last bit.
  Extent WholeExtent{ { 0, -1, 0, -1, 0, -1 } };
};

/// One array over the voxels of the volume: tuples of Components elements, x varying fastest.
struct VolumeArray
{
  const void* Data = nullptr;
  /// What keeps Data where it is and as it is. With it a device that is a processor reads Data
  /// where it lies, at each Deform(), and holds the owner until it has other arrays; without it,
  /// and on other devices, Data is copied during the call. Null by default.
  std::shared_ptr<const void> Owner;
  ElementType Type = ElementType::UInt8;
  int Components = 1;
  /// True: take the value of the nearest vertex. False: interpolate linearly, and round to the
  /// nearest integer where the type is an integer type.
  bool Categorical = false;
  /// What voxels get that the deformed volume does not cover, clamped to the type's range.
  double Background = 0.0;
};

/// Bytes of one tuple.
inline std::size_t GetTupleSize(const VolumeArray& array)
{
  return GetElementSize(array.Type) * static_cast<std::size_t>(array.Components);
}

/// Displacements over so many output voxels are refused: the kernels could not round them.
constexpr double LargestDisplacement = 16383.0;

/// The static link of one voxel into the deformation mesh; 16 bytes.
struct VertexLink
{
  /// Index of the tetrahedron of the deformation mesh, or -1 for a voxel outside it.
  std::int32_t Tetrahedron = -1;
  /// Barycentric weights of the first three nodes; that of the fourth is what misses to 1.
  float Weights[3] = { 0.0F, 0.0F, 0.0F };
};

/// A run of voxels of a row, along x, in one tetrahedron; 8 bytes. It ends where the next run of
/// its row begins, the last one at the end of the row.
struct VertexRun
{
  /// Index into VertexRuns::Tetrahedra, or -1 outside the deformation mesh.
  std::int32_t Tetrahedron = -1;
  /// Local x index of its first voxel: counted from the first voxel of the lattice.
  std::int32_t Begin = 0;
};

/// Where a tetrahedron of the deformation mesh lies at rest: weight k < 3 of the voxel with local
/// index v is Weights[k] + dot(Gradients[k], v - Origin). In doubles: the displacements of the
/// nodes make small numbers of the large gradients of a thin tetrahedron.
struct RestTetrahedron
{
  /// Local index of a voxel in the tetrahedron.
  std::array<double, 3> Origin{ { 0.0, 0.0, 0.0 } };
  std::array<double, 3> Weights{ { 0.0, 0.0, 0.0 } };
  std::array<std::array<double, 3>, 3> Gradients{};
  /// Index of the tetrahedron in the deformation mesh.
  std::int32_t Tetrahedron = 0;
};

/// The static mapping where many voxels lie in each tetrahedron: runs instead of a link a voxel.
struct VertexRuns
{
  std::vector<VertexRun> Runs;
  /// The runs of row r = z * (voxels on y) + y, in local indices, are those from RowBegins[r] to
  /// RowBegins[r + 1].
  std::vector<std::uint32_t> RowBegins;
  /// Those that hold voxels; several of them may be one tetrahedron of the mesh.
  std::vector<RestTetrahedron> Tetrahedra;
};

/// The nodes of a tetrahedron of the deformation mesh.
using Tetrahedron = std::array<std::int32_t, 4>;

/// Points of a deformation: of each range the first one, and one past the last. In ascending order.
using PointRanges = std::vector<std::array<std::size_t, 2>>;

/// A displacement field on a regular grid, trilinear between its points.
struct DisplacementField
{
  std::array<int, 3> Dimensions{ { 0, 0, 0 } };
  /// Three floats a point, x varying fastest.
  const float* Vectors = nullptr;
  /// Row-major 3 x 3 matrix that takes a vector to a displacement in output voxels. It is applied
  /// in double precision (see GetFactor), and the result rounded to float.
  std::array<double, 9> ToDisplacement{ { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };
  /// What keeps Vectors where they are and as they are. With it a device that is a processor, and
  /// has double precision, reads Vectors where they lie, at each Deform(), where each voxel is a
  /// point of the field, and holds the owner until it has another deformation. They are not
  /// checked then: tetrahedra with displacements that are not finite, or too large, are skipped.
  /// Nor are they compared: all is made anew where they are set again. Else Vectors are checked,
  /// converted and copied during the call. Null by default.
  std::shared_ptr<const void> Owner;
  /// Row-major 3 x 4 matrix that takes a structured index of the volume to a continuous index of
  /// the field, 0 being the field's first point.
  std::array<double, 12> IndexToField{ { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 } };
  /// True: voxels outside the field take the displacement of its nearest point on the border.
  /// False: they are discarded.
  bool Extrapolate = false;
};

/// The points of a field; 0 where it has none on an axis.
inline std::int64_t GetNumberOfPoints(const DisplacementField& field)
{
  std::int64_t points = 1;
  for (const int dimension : field.Dimensions)
  {
    points *= dimension > 0 ? dimension : 0;
  }
  return points;
}

/// Whether displacements are the vectors of a field as they are.
inline bool HasDisplacements(const DisplacementField& field)
{
  return field.ToDisplacement == DisplacementField().ToDisplacement;
}

/// An element of the matrix of a field as it is applied: rounded to 29 bits, so that its product
/// with a float is exact in double precision. Then it does not matter whether a compiler, of the
/// host or of the device, fuses products with sums.
inline double GetFactor(const DisplacementField& field, int element)
{
  std::uint64_t bits = 0;
  std::memcpy(&bits, &field.ToDisplacement[element], sizeof(bits));
  constexpr std::uint64_t unit = 1 << 24;
  bits = (bits + unit / 2) & ~(unit - 1);
  double factor = 0.0;
  std::memcpy(&factor, &bits, sizeof(factor));
  return factor;
}

/// The displacement of a point of a field, to the last bit as the kernels have it.
inline std::array<float, 3> GetDisplacement(const DisplacementField& field, std::int64_t point)
{
  const float* vector = field.Vectors + 3 * point;
  std::array<float, 3> displacement;
  for (int axis = 0; axis < 3; ++axis)
  {
    displacement[axis] =
      static_cast<float>(GetFactor(field, 3 * axis) * static_cast<double>(vector[0]) +
        GetFactor(field, 3 * axis + 1) * static_cast<double>(vector[1]) +
        GetFactor(field, 3 * axis + 2) * static_cast<double>(vector[2]));
  }
  return displacement;
}

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
  /// The published kernel, kept as the yardstick of benchmarks: float tolerance, racing writes.
  Published,
  /// The tetrahedra of the deformation mesh themselves are rasterised, and the volume is looked up
  /// at the interpolated rest coordinate (MeshRasterizer.h). Goes with SetRestMesh, and with
  /// SetInverseField, where the field says the rest coordinate.
  MeshRasterization
};

/// How a volume is interpolated at a rest coordinate.
enum class Interpolation
{
  Linear,
  /// Catmull-Rom, over four voxels on each axis, clamped to the range of integer types. Only with
  /// MeshRasterization.
  Cubic
};

struct DeformRequest
{
  Resampling Method = Resampling::Exact;
  deformvolume::Interpolation Interpolation = deformvolume::Interpolation::Linear;
  /// Structured indices of the output voxels.
  Extent OutputExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// The output that these are a part of; empty: they are all of it. What a voxel gets with the
  /// methods Exact, ExactByCell and ExactByLanes depends on this one alone, to the last bit.
  Extent WholeOutputExtent{ { 0, -1, 0, -1, 0, -1 } };
  /// For each array of the volume, room for Components elements a voxel of OutputExtent. A device
  /// that is a processor works there; after a failure the contents are undefined.
  std::vector<void*> Outputs;
  /// Room for one byte a voxel: 1 where the deformed volume covers it, else 0.
  signed char* Coverage = nullptr;
  /// Keeps what is needed to write only what changes until the next call. That call needs the
  /// output of this one in LastOutputs and LastCoverage. Where that is not faster or not possible,
  /// all is written; the result is the same to the last bit. For processors, volumes and outputs
  /// within the allocation limit, and methods Exact and ExactByLanes.
  bool Incremental = false;
  /// What the last call wrote, unchanged: the same memory as Outputs and Coverage, or other memory,
  /// from which it is copied. Empty and null where there is none.
  std::vector<const void*> LastOutputs;
  const signed char* LastCoverage = nullptr;
  /// Called between launches with the fraction done, 0 to 1; returning false aborts the work.
  std::function<bool(double)> Progress;
  /// Called with true before kernels are compiled, which may take many seconds, and with false
  /// after. In the thread that called Deform().
  std::function<void(bool)> Compiling;
};

struct DeformReport
{
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
  /// Tetrahedra of the deformation mesh without volume at rest; counted by MeshRasterization only.
  std::int64_t NumberOfFlatTetrahedra = 0;
  /// Bricks of 192 x 16 x 16 cells of the volume, and how many of them were resampled: fewer only
  /// in an incremental update. 0 for MeshRasterization.
  std::int64_t NumberOfBricks = 0;
  std::int64_t NumberOfResampledBricks = 0;
  /// Seconds. The exact kernels map and resample in one: their MappingTime is 0. With
  /// MeshRasterization the mapping is the listing of the tetrahedra of each part of the output.
  double MappingTime = 0.0;
  double ResamplingTime = 0.0;
  double TransferTime = 0.0;
  /// The compilation of kernels; it is part of no other time.
  double CompilationTime = 0.0;
};

/// Deforms a volume on an OpenCL device: keeps the volume, its sampling mesh and the static
/// mapping there, and maps and resamples whenever it is asked to.
///
/// Order of calls: SetDevice, SetLattice, SetArrays, then SetMesh or SetRestMesh and
/// SetNodeDisplacements, or SetDisplacementField, then Deform, as often as wanted. SetBlanked and
/// SetActiveTetrahedra are optional. SetLattice forgets everything that was set after it. Pointers
/// are used during the call only, but for the data of arrays that have an owner. Every failure is
/// an Error; the object can be used again afterwards.
class VolumeDeformer
{
public:
  VolumeDeformer();
  ~VolumeDeformer();
  VolumeDeformer(const VolumeDeformer&) = delete;
  VolumeDeformer& operator=(const VolumeDeformer&) = delete;

  /// Chooses the device (see ResolveDevice) and returns its name. A change of device forgets
  /// all that was set. An update begins here: how much memory is free is measured once from this
  /// call to the end of Deform.
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

  /// Checks that a lattice, arrays and an output of these sizes fit into the memory of the device,
  /// before anything is allocated; throws an Error that names the bytes needed and available.
  /// outputExtent is that of the output; the values of the arrays are not read. Counts
  /// what the caller is about to allocate, too: the output, and the links or runs of a mesh.
  /// runBytes: GetRunBytes (VertexRuns.h) where the mesh comes with runs, 0 where it comes with
  /// links. heldBytes: how much memory for the output the caller has already.
  void CheckMemory(const Lattice& lattice, const std::vector<VolumeArray>& arrays,
    const Extent& outputExtent, std::size_t numberOfNodes, std::size_t numberOfTetrahedra,
    bool field, std::uint64_t runBytes = 0, std::uint64_t heldBytes = 0) const;

  /// The same for MeshRasterization, which needs neither links nor runs. With an inverse field
  /// numberOfNodes are its points, and there are no tetrahedra.
  void CheckRasterizationMemory(const Lattice& lattice, const std::vector<VolumeArray>& arrays,
    const Extent& outputExtent, std::size_t numberOfNodes, std::size_t numberOfTetrahedra,
    std::uint64_t heldBytes = 0) const;

  /// bytesPerVoxel: a voxel's bytes in the widest array that will be set; it decides how a volume
  /// over the allocation limit is split, and so does whether links may be set. MeshRasterization
  /// needs the volume whole.
  void SetLattice(const Lattice& lattice, std::size_t bytesPerVoxel = 16, bool withLinks = true);
  void SetArrays(const std::vector<VolumeArray>& arrays);

  /// Changes which arrays are categorical and their background, and sends nothing: of arrays of the
  /// types and components that were set.
  void SetArrayOptions(const std::vector<VolumeArray>& arrays);

  /// One byte a voxel: nonzero where the voxel is no source (blanked or a ghost). Null: all are.
  void SetBlanked(const unsigned char* blanked);

  /// One byte a cell, bit i = tetrahedron i is active. Null: all are.
  void SetActiveTetrahedra(const unsigned char* active);

  /// A tetrahedral deformation mesh, with a link for each voxel.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexLink* links);
  /// The same with runs of voxels. Displacements are as exact as by links but for rounding errors
  /// of less than 1/1024 output voxel where they are under 8,192 voxels (VertexRuns.h has the
  /// bound); equal displacements of all nodes move each voxel by exactly that.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexRuns& runs);
  /// The deformation mesh for MeshRasterization, in place of SetMesh. restNodes: three numbers a
  /// node, continuous indices of the volume.
  void SetRestMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const double* restNodes);
  /// An inverse displacement field for MeshRasterization, in place of SetRestMesh: its vectors, in
  /// output voxels, lead from a point of the output to the point of the volume at rest that is seen
  /// there, and IndexToField takes an index of the output.
  void SetInverseField(const DisplacementField& field);
  /// Displacements of the nodes, three floats each, in output voxels. changes: all others are those
  /// of the last call, and are not looked at, if there was one for this mesh and it did not fail.
  /// Null: any may have changed.
  void SetNodeDisplacements(const float* displacements, const PointRanges* changes = nullptr);

  /// changes: as above, for fields of the same dimensions.
  void SetDisplacementField(const DisplacementField& field, const PointRanges* changes = nullptr);

  DeformReport Deform(const DeformRequest& request);

  /// Bytes allocated on the device.
  std::uint64_t GetDeviceMemory() const;

  /// Frees all that is held on the device.
  void ReleaseMemory();

private:
  DeformReport Execute(const DeformRequest& request);

  /// Bytes on the device.
  struct DeviceMemory
  {
    std::uint64_t Needed;
    std::uint64_t Available;
  };
  /// The part of CheckMemory for the device. outputBytesPerVoxel: of the output there.
  DeviceMemory CheckDeviceMemory(const Lattice& lattice, const std::vector<VolumeArray>& arrays,
    const Extent& outputExtent, std::uint64_t outputBytesPerVoxel, std::size_t numberOfNodes,
    std::size_t numberOfTetrahedra, std::uint64_t mappingBytes) const;
  DeviceMemory CheckRasterizationDeviceMemory(const Lattice& lattice,
    const std::vector<VolumeArray>& arrays, const Extent& outputExtent,
    std::uint64_t outputBytesPerVoxel, std::size_t numberOfNodes,
    std::size_t numberOfTetrahedra) const;

  /// The part of both for the device, by a function that is given the bytes of a voxel of the
  /// output there, and then the part for the system. mappingBytes: of links or runs that the caller
  /// holds.
  void CheckMemories(const std::vector<VolumeArray>& arrays, const Extent& outputExtent,
    std::uint64_t mappingBytes, std::uint64_t heldBytes,
    const std::function<DeviceMemory(std::uint64_t)>& checkDevice) const;

  class Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
