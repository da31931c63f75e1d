// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformation_h
#define DeformVolumeDeformation_h

#include "DeformationSource.h"
#include "DeviceVectors.h"
#include "DisplacementField.h"
#include "FieldChecker.h"
#include "IndexBounds.h"
#include "MeshAtRest.h"
#include "OutsideVoxels.h"
#include "RestMesh.h"
#include "Tetrahedron.h"
#include "VectorArray.h"

#include "vtkSmartPointer.h"

#include <glm/mat3x3.hpp>

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

class vtkImageData;

namespace deformvolume
{

/// See VectorConversion.h.
glm::dmat3 GetToDisplacement(const DeformationSource& source, double factor);

/// The deformation in the units of the kernels. Only data that have changed are read again, and
/// versions change with the data.
class Deformation
{
public:
  /// Reads a source. Throws an Error if it cannot be used.
  void Read(const DeformationSource& source);

  bool IsField() const { return this->Field; }
  /// Whether the deformation is a field from the output to the volume at rest.
  bool IsInverseField() const { return this->Field && this->VectorsSource.FieldIsInverse; }

  ///@{
  /// The mesh, if the deformation is one: its tetrahedra, its nodes at rest in continuous indices
  /// of the volume, and their displacements in output voxels, of at most LargestDisplacement.
  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Mesh.GetTetrahedra(); }
  const std::vector<glm::dvec3>& GetRestPoints() const { return this->Mesh.GetPoints(); }
  const float* GetNodeDisplacements() const { return this->Vectors.data(); }
  MeshAtRest GetMeshAtRest() const
  {
    return { this->GetTetrahedra(), this->GetRestPoints(), this, this->Mesh.GetShapeVersion() };
  }
  ///@}

  ///@{
  /// The field, if the deformation is one, and the bounds of the deformed volume; null if they were
  /// not computed with the field. An inverse field takes indices of the output. A large field with
  /// a point at each voxel is not copied (see DisplacementField::Owner).
  DisplacementField GetField(const OutsideVoxels& outside) const;
  const IndexBounds* GetFieldBounds() const
  {
    return this->FieldInPlace.Owner ? &this->FieldBounds : nullptr;
  }
  ///@}

  ///@{
  /// The voxels of a part of the volume whose displacements depend on undefined points of a forward
  /// field, one byte each. GetUndefinedVersion() differs for fields with other undefined points,
  /// and is 0 for all other deformations. Vectors of undefined points of an inverse field are NaN
  /// instead.
  std::vector<unsigned char> FindUndefinedVoxels(
    const Extent& part, const OutsideVoxels& outside) const;
  /// The undefined points of a field, one byte each; empty if there are none.
  const std::vector<unsigned char>& GetUndefinedPoints() const { return this->UndefinedPoints; }
  std::uint64_t GetUndefinedVersion() const
  {
    return this->UndefinedPoints.empty() || !this->Field || this->IsInverseField()
      ? 0
      : this->UndefinedVersion;
  }
  ///@}

  ///@{
  /// The vectors on the device, and the matrix that converts them to displacements. Null if the
  /// vectors are read on the host. Otherwise the displacements above are valid only after
  /// BringToHost().
  const std::shared_ptr<DeviceVectors>& GetDeviceVectors() const { return this->OnDevice; }
  const std::array<double, 9>& GetDeviceMatrix() const { return this->MatrixOnDevice; }
  void BringToHost();
  ///@}

  /// The mesh at rest, with its versions and the changes between them.
  const RestMesh& GetRestMesh() const { return this->Mesh; }
  /// Changes if the displacements, the connectivity of the mesh or the kind of the deformation
  /// change.
  std::uint64_t GetVectorsVersion() const { return this->VectorsVersion; }

  /// The blocks of points whose displacements have changed since a version. Some points of a block
  /// may be unchanged.
  PointRanges GetChanges(std::uint64_t version) const;

private:
  void ReadMesh(const DeformationSource& source);
  void ReadField(vtkImageData* image, const DeformationSource& source);
  /// Returns false if the field cannot be used without a copy.
  bool UseFieldInPlace(vtkDataArray* array, const DeformationSource& source);
  /// Uses the vectors of an array in the memory of a device. Returns false if the array has none
  /// there.
  bool UseVectorsOnDevice(
    vtkDataArray* array, vtkIdType points, double factor, const DeformationSource& source);
  void ForgetVectorsOnDevice();
  void RememberVectors(const Stamp& stamp, const DeformationSource& source, bool field);
  bool VectorsAreCurrent(const Stamp& stamp, const DeformationSource& source, bool field) const;
  /// Whether the conversion from vectors to displacements is the same as at the last reading.
  bool HasSameUnits(const DeformationSource& source) const;
  /// Calls its argument with all displacements in world units.
  using VectorSource = std::function<void(const VectorTaker&)>;
  /// Sets the displacements. read: throws an Error if vectors cannot be used. count: number of
  /// vectors that `read` gives. derived: the derived nodes, whose displacements are computed from
  /// these vectors; null: there are none.
  void SetVectors(std::size_t count, const VectorSource& read, double factor,
    const DeformationSource& source, const DerivedNodes* derived = nullptr);
  /// Like SetVectors(), but VectorsVersion does not change.
  void ReplaceVectors(std::size_t count, const VectorSource& read, double factor,
    const DeformationSource& source, const DerivedNodes* derived = nullptr);
  /// Computes the displacements of derived nodes, which follow `count` other displacements.
  /// changed: set for blocks whose displacements have changed.
  void UpdateDerived(
    const DerivedNodes& derived, std::size_t count, std::vector<std::atomic<bool>>& changed);

  /// Throws an Error if tetrahedra use a node with a faulty vector.
  void CheckFaults(const MeshParts& shape, const DeformationSource& source) const;
  /// Sets the number of vectors and of blocks.
  void ResizeVectors(std::size_t count, std::size_t blocks);

  bool Field = false;
  RestMesh Mesh;
  std::vector<float> Vectors;
  static constexpr std::size_t PointsPerBlock = 512;
  std::vector<std::uint64_t> BlockVersions; // VectorsVersion at the last change of each block
  bool VectorsAreWhole = false;             // false: the last reading failed
  NodeFaults Faults;                        // of the vectors of a mesh
  std::array<int, 3> FieldDimensions{ { 0, 0, 0 } };
  std::array<double, 12> IndexToField{};
  glm::dvec3 FieldSpacing{ 1.0 };             // in world units
  std::vector<unsigned char> UndefinedPoints; // of the field; empty: all are defined
  std::uint64_t UndefinedVersion = 0;
  DisplacementField FieldInPlace; // no Owner: there is none
  IndexBounds FieldBounds;
  FieldChecker ScanInPlace;
  const void* ArrayInPlace = nullptr;
  vtkMTimeType TimeInPlace = 0; // modification time of the array
  PointRanges ChangesInPlace;   // changes from VersionBeforeChanges to VectorsVersion
  static constexpr std::uint64_t NoVersion = ~std::uint64_t{ 0 };
  std::uint64_t VersionBeforeChanges = NoVersion;
  std::uint64_t VectorsVersion = 0;

  std::shared_ptr<DeviceVectors> OnDevice;
  std::array<double, 9> MatrixOnDevice{};
  vtkSmartPointer<vtkDataArray> ArrayOnDevice;
  double FactorOnDevice = 1.0;
  bool IsOnHost = true; // whether Vectors are those of OnDevice

  // The source that the members above were read from.
  Stamp VectorsStamp;
  std::uint64_t ConnectivityOfVectors = 0;
  DeformationSource VectorsSource;
  std::vector<VectorMemory> Memories; // of each part of a mesh
  bool MemoriesAreOfPoints = false;   // false: of vectors
};

} // namespace deformvolume

#endif
