// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDisplacementSource_h
#define DeformVolumeDisplacementSource_h

#include "BoxBounds.h"
#include "DisplacementBuffer.h"
#include "DisplacementField.h"
#include "HostMemory.h"
#include "KernelParameters.h"
#include "MappingProgram.h"
#include "MeshBoundary.h"
#include "Tetrahedron.h"
#include "VectorReading.h"
#include "VertexLink.h"
#include "VertexRuns.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

class DeviceVolume;
class DisplacementObserver;
class WorkDevice;
struct VolumeChunk;

/// Where the displacements are that move a volume, on the device: those of the nodes of a
/// deformation mesh, or of the points of a field, which may be read where it lies. It says by which
/// form of the deformation mapping the kernels find the displacement of a vertex, and gives them
/// the arguments of that.
///
/// Each call that fails leaves the deformation of before, or none.
class DisplacementSource
{
public:
  /// The volume gets the static mapping of the mesh. The observer is told what changes.
  DisplacementSource(WorkDevice& device, DeviceVolume& volume, DisplacementObserver& observer);

  ///@{
  /// A deformation mesh that was checked (CheckMesh), with a link for each voxel or with runs. Its
  /// nodes have no displacements yet.
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexLink* links);
  void SetMesh(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const VertexRuns& runs);
  ///@}
  bool HasMesh() const;
  /// See VolumeDeformer; the mesh is the one that was set.
  void ChangeConnectivity(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, const std::vector<TetrahedronChange>* changes);
  void SetNodePlaces(const std::int32_t* places);
  /// Three floats a node, in output voxels. changes, areChecked: see
  /// VolumeDeformer::SetNodeDisplacements.
  void SetNodeDisplacements(
    const float* displacements, const PointRanges* changes, bool areChecked);

  /// The same of vectors on the device. toDisplacement: see DisplacementField.
  void SetNodeDisplacements(
    const std::shared_ptr<DeviceVectors>& vectors, const std::array<double, 9>& toDisplacement);

  /// A field that is not empty (CountPoints). changes: see VolumeDeformer::SetDisplacementField.
  void SetField(const DisplacementField& field, const PointRanges* changes);
  /// A field that has its vectors on the device.
  void SetField(const DisplacementField& field, const std::shared_ptr<DeviceVectors>& vectors);

  /// There is no deformation any more.
  void Forget();

  /// Whether there are displacements for each vertex.
  bool IsReady() const;

  /// Nodes of the mesh, or points of the field.
  std::size_t GetNumberOfNodes() const { return this->NumberOfNodes; }
  std::size_t GetNumberOfTetrahedra() const { return this->NumberOfTetrahedra; }

  /// Leaves out the tetrahedra of the sampling mesh that bridge a gap of the mesh, where that is
  /// wanted; returns the boxes of cells that have other ones than before.
  std::vector<Extent> UpdateBridges();
  /// Brings up to date what follows from displacements and masks: the records of runs and the state
  /// of the vertices. Events of launches are added to a list. bricks: the ones that are to be made
  /// (DEFORMVOLUME_BRICK_BITS), if all else stays as it is; null: all.
  void PrepareMapping(std::vector<cl::Event>& events, const std::vector<cl_uint>* bricks = nullptr);
  MappingForm GetMappingForm() const;
  /// Sets a kernel's first arguments, those of the mapping, and returns how many they are.
  cl_uint SetMappingArguments(cl::Kernel& kernel, const VolumeChunk& chunk) const;

  /// Sets arguments from one on, and returns the number of the next one: tetrahedra, points, and as
  /// four integers the dimensions of a field, 0 for a mesh. other: any buffer.
  cl_uint SetPointArguments(cl::Kernel& kernel, cl_uint argument, const cl::Buffer& other) const;

  /// Which points move the sub-bricks of the volume, where that is one chunk.
  BrickPoints MakeBrickPoints() const;
  /// Bricks look further or less far than before (BrickGrid::Halo).
  void ChangeHalo() { this->BoundsOfSubBricks.clear(); }
  /// Calls a function with the displacements as they are now, or with what is known of them, and
  /// how many they are.
  void Visit(const std::function<void(const Displacements&, std::size_t)>& visit) const;

  /// Whether a field that the kernels read where it lies, or that a kernel has converted, is
  /// written in part, and that is told.
  bool IsWrittenInPart() const
  {
    return (this->FieldInPlace.Owner || this->IsConverted) && this->WrittenInPart;
  }
  /// Memory of the host where the kernels read a field, of no bytes where they do not.
  BufferInPlace GetFieldInPlace() const;
  /// Has it be read as it is now.
  void ReadFieldAgain() const;

  /// Bytes on the device.
  std::uint64_t GetMemory() const;

private:
  void SendTetrahedra(
    const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes);
  /// The tetrahedra that are not as the device has them.
  std::vector<TetrahedronChange> FindChanges(const Tetrahedron* tetrahedra) const;
  void CheckChanges(const std::vector<TetrahedronChange>& changes, std::size_t numberOfNodes) const;
  void SendChanges(const std::vector<TetrahedronChange>& changes);
  void SendNodes(const float* displacements, const PointRanges* changes, bool areChecked);
  /// There are so many nodes now.
  void SetNumberOfNodes(std::size_t numberOfNodes);
  void ForgetNodes();
  void ForgetField();
  bool HasField() const { return this->GetFieldVectors()() != nullptr; }
  const cl::Buffer& GetFieldVectors() const;
  /// What moves the voxels becomes a field, of which this returns what the kernels are told.
  FieldParameters BeginField(const DisplacementField& field);
  void UseField(const DisplacementField& field, const PointRanges* changes);
  bool CanReadInPlace(const DisplacementField& field, const FieldParameters& parameters) const;
  /// Some points of the field that is read where it lies have changed. False where all of it is as
  /// good as new.
  bool ChangeInPlace(const DisplacementField& field, const PointRanges& changes);
  void SetFieldInPlace(const DisplacementField& field);
  void CheckFieldSize() const;
  /// Has a kernel make the displacements of the field. changes: what may have changed of them, and
  /// of no others; null: all.
  void ConvertField(const PointRanges* changes);
  const std::vector<DisplacementBounds>& FindBoundsOfSubBricks() const;
  /// Points that have changed, so many of them: the observer is told, if that is worthwhile and
  /// possible. after: finds what their displacements lie between now. False where all of the field
  /// is as good as new.
  bool TellOfChanges(const PointRanges& changes, const std::function<DisplacementBounds()>& after);
  void SendField(
    const DisplacementField& field, const FieldParameters& parameters, const PointRanges* changes);

  WorkDevice& Device;
  DeviceVolume& Volume;
  DisplacementObserver& Observer;

  cl::Buffer Tetrahedra; // their nodes (DEFORMVOLUME_NODE_PLACES)
  std::size_t NumberOfTetrahedra = 0;
  std::size_t NumberOfNodes = 0;
  std::size_t MostNodes = 0; // that the mesh has had: the buffers have room for them
  DisplacementBuffer Nodes;
  bool NodesSet = false;

  FieldParameters Field = {};
  DisplacementBuffer FieldVectors;
  bool WrittenInPart = false;
  DisplacementField FieldInPlace; // with an owner, where the kernels read the vectors of that
  cl::Buffer VectorsInPlace;      // which lies over them

  VectorReading Reading;
  bool IsConverted = false; // the displacements of the field are made on the device
  mutable BoxBounds Bounds;
  mutable std::vector<DisplacementBounds> BoundsOfSubBricks; // of these; empty: not known
  bool LastSent = false; // the last displacements that were given are on the device
};

} // namespace deformvolume

#endif
