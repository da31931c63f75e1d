// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementSource_h
#define DeformVolumeDisplacementSource_h

#include "DisplacementBuffer.h"
#include "DisplacementField.h"
#include "HostMemory.h"
#include "KernelParameters.h"
#include "MappingProgram.h"
#include "MeshBoundary.h"
#include "Tetrahedron.h"
#include "VectorConverter.h"
#include "VertexLink.h"
#include "VertexRuns.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class ChangeTracker;
class WorkDevice;
struct VolumeChunk;

/// The displacements that move a volume, on the device: of the nodes of a deformation mesh, or of
/// the points of a field, which may be read in place. The class selects the form of the deformation
/// mapping by which kernels compute the displacement of a vertex, and sets their arguments.
///
/// After a call that throws, the previous deformation is set, or none.
class DisplacementSource
{
public:
  /// volume: receives the static mapping of the mesh. tracker: is notified of changes.
  DisplacementSource(WorkDevice& device, DeviceVolume& volume, ChangeTracker& tracker);

  ///@{
  /// Set a deformation mesh with a link for each voxel or with runs. The mesh must have been
  /// checked (CheckMesh(), CheckLinks(), CheckRuns()). Its nodes have no displacements until
  /// SetNodeDisplacements() is called.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexLink* links);
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexRuns& runs);
  ///@}
  bool HasMesh() const;
  /// See VolumeDeformer.
  void ChangeConnectivity(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const std::vector<TetrahedronChange>* changes);
  void SetCoincidentNodes(const std::int32_t* numbers);
  /// Set the displacements of nodes: three floats per node, in output voxels. changes, areChecked:
  /// see VolumeDeformer::SetNodeDisplacements().
  void SetNodeDisplacements(
    const float* displacements, const PointRanges* changes, bool areChecked);

  /// Set the displacements of nodes to vectors on the device. toDisplacement: see
  /// DisplacementField.
  void SetNodeDisplacements(
    const std::shared_ptr<DeviceVectors>& vectors, const std::array<double, 9>& toDisplacement);

  /// Set a field, which must not be empty. changes: see VolumeDeformer::SetDisplacementField().
  void SetField(const DisplacementField& field, const PointRanges* changes);
  /// Set a field whose vectors are on the device.
  void SetField(const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors);

  /// Removes the deformation.
  void Forget();

  /// Whether displacements are set.
  bool IsReady() const;

  /// Number of nodes of the mesh, or of points of the field.
  std::size_t GetNumberOfNodes() const { return this->NumberOfNodes; }
  std::size_t GetNumberOfTetrahedra() const { return this->NumberOfTetrahedra; }

  /// Updates the mask of bridges: tetrahedra of the sampling mesh over a split of the mesh, which
  /// are not resampled (SetCoincidentNodes()). Returns the boxes of cells whose bridges have
  /// changed.
  std::vector<Extent> UpdateResampledMask();
  /// Updates the data that depend on displacements and masks: the records of runs and the state of
  /// the vertices. bricks: bricks to resample, if the other bricks do not change
  /// (DEFORMVOLUME_BRICK_BITS); null: all. Returns the launch that updates the records of runs;
  /// null if they are current.
  cl::Event PrepareMapping(const std::vector<cl_uint>* bricks = nullptr);
  MappingKind GetMappingKind() const;
  /// Sets the arguments of the mapping, which are the first arguments of a kernel. Returns their
  /// number.
  cl_uint SetMappingArguments(cl::Kernel& kernel, const VolumeChunk& chunk) const;

  /// Sets three arguments, starting at index `argument`: tetrahedra, displacements of points, and
  /// the dimensions of a field as four integers (0 for a mesh). Returns the index of the next
  /// argument.
  cl_uint SetPointArguments(cl::Kernel& kernel, cl_uint argument) const;

  /// Finds the points that move each sub-brick of the volume. The volume must be one chunk.
  BrickPoints MakeBrickPoints() const;
  /// BrickGrid::Halo has changed.
  void ChangeHalo() { this->BoundsOfSubBricks.clear(); }
  /// Calls visit(displacements, numberOfPoints) with the current displacements, or with their
  /// bounds if they are only on the device.
  void WithDisplacements(const std::function<void(const Displacements&, std::size_t)>& visit) const;

  /// Whether the last call of SetField() changed only some points, for a field that is read in
  /// place or that a kernel has converted.
  bool IsWrittenInPart() const
  {
    return (this->FieldInPlace.Owner || this->IsConverted) && this->WrittenInPart;
  }
  /// Returns the host memory of the field that is read in place. Bytes is 0 if there is no such
  /// field.
  BufferInPlace GetFieldInPlace() const;
  /// Updates the field that is read in place after its memory has been written.
  void RereadField() const;

  /// Bytes on the device.
  std::uint64_t GetMemory() const;

private:
  void SendTetrahedra(
    const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes);
  /// Finds the tetrahedra that differ from those on the device.
  std::vector<TetrahedronChange> FindChanges(const Tetrahedron* tetrahedra) const;
  void CheckChanges(const std::vector<TetrahedronChange>& changes, std::size_t numberOfNodes) const;
  void SendChanges(const std::vector<TetrahedronChange>& changes);
  void SendNodes(const float* displacements, const PointRanges* changes, bool areChecked);
  void SetNumberOfNodes(std::size_t numberOfNodes);
  void ForgetNodes();
  void ForgetField();
  bool HasField() const { return this->GetFieldVectors()() != nullptr; }
  const cl::Buffer& GetFieldVectors() const;
  /// Removes a mesh, if one is set, and prepares for a field. Returns the parameters of the field
  /// for kernels.
  FieldParameters PrepareForField(const DisplacementField& field);
  void SetFieldOnHost(const DisplacementField& field, const PointRanges* changes);
  bool CanReadInPlace(const DisplacementField& field, const FieldParameters& parameters) const;
  /// Changes some points of the field that is read in place. Returns false if all points must count
  /// as changed.
  bool UpdateFieldInPlace(const DisplacementField& field, const PointRanges& changes);
  void SetFieldInPlace(const DisplacementField& field);
  void CheckFieldSize() const;
  /// Sets a field whose displacements are written by a kernel. changes: points that may have
  /// changed; null: all. convert(displacements, partly): writes the displacements to the buffer;
  /// partly: at least those of `changes`.
  void ConvertFieldOnDevice(const DisplacementField& field, const PointRanges* changes,
    const std::function<void(const cl::Buffer&, bool)>& convert);
  const std::vector<DisplacementBounds>& FindBoundsOfSubBricks() const;
  /// Notifies the tracker of changed points. after: computes the bounds of their new
  /// displacements. Returns false if all points must count as changed.
  bool NotifyOfChanges(
    const PointRanges& changes, const std::function<DisplacementBounds()>& after);
  void UploadField(
    const DisplacementField& field, const FieldParameters& parameters, const PointRanges* changes);

  WorkDevice& Device;
  DeviceVolume& Volume;
  ChangeTracker& Tracker;

  cl::Buffer Tetrahedra; // nodes of the tetrahedra, times DEFORMVOLUME_NODE_STRIDE
  std::size_t NumberOfTetrahedra = 0;
  std::size_t NumberOfNodes = 0;
  // The largest number of nodes since SetMesh(), and the size of the buffers.
  std::size_t MaxNumberOfNodes = 0;
  DisplacementBuffer Nodes;
  bool NodesSet = false;

  FieldParameters Field = {};
  DisplacementBuffer FieldVectors;
  bool WrittenInPart = false;
  DisplacementField FieldInPlace; // has an owner if the kernels read its vectors in place
  cl::Buffer VectorsInPlace;      // uses the memory of these vectors

  VectorConverter Converter;
  bool IsConverted = false; // whether a kernel has written the displacements of the field
  mutable std::vector<DisplacementBounds> BoundsOfSubBricks; // if converted; empty: not known
  bool DeviceIsCurrent = false; // whether the device has the displacements of the last call
};

} // namespace deformvolume

#endif
