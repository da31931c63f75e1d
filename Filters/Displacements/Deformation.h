// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformation_h
#define DeformVolumeDeformation_h

#include "DeformationSource.h"
#include "DeviceVectors.h"
#include "DisplacementField.h"
#include "FieldScan.h"
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

/// The deformation in the units of the kernels. Keeps what it has read, and reads again only what
/// changed; versions tell what did.
class Deformation
{
public:
  /// Throws an Error where the source cannot be used.
  void Read(const DeformationSource& source);

  bool IsField() const { return this->Field; }
  /// Whether it is a field from the output to the volume at rest.
  bool IsInverseField() const { return this->Field && this->VectorsSource.FieldIsInverse; }

  ///@{
  /// A mesh: its tetrahedra, its nodes at rest in continuous indices of the volume, and their
  /// displacements in output voxels, none of which is over LargestDisplacement.
  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Mesh.GetTetrahedra(); }
  const std::vector<glm::dvec3>& GetRestPoints() const { return this->Mesh.GetPoints(); }
  const float* GetNodeDisplacements() const { return this->Vectors.data(); }
  MeshAtRest GetMeshAtRest() const
  {
    return { this->GetTetrahedra(), this->GetRestPoints(), this, this->Mesh.GetShapeVersion() };
  }
  ///@}

  ///@{
  /// A field (that of an inverse one takes indices of the output), and the bounds of the deformed
  /// volume where they were found with it, else null. Large fields over the voxels themselves are
  /// not copied (see DisplacementField::Owner).
  DisplacementField GetField(const OutsideVoxels& outside) const;
  const IndexBounds* GetFieldBounds() const
  {
    return this->FieldInPlace.Owner ? &this->FieldBounds : nullptr;
  }
  ///@}

  ///@{
  /// The voxels of a part of the volume, one byte each, whose displacement would need a point of a
  /// forward field that is undefined; and a version that differs between two such fields, which is
  /// 0 for all other deformations. (Vectors of undefined points of an inverse field are
  /// not-a-number.)
  std::vector<unsigned char> FindUndefinedVoxels(
    const Extent& part, const OutsideVoxels& outside) const;
  /// The undefined points of a field, one byte each; empty where there are none.
  const std::vector<unsigned char>& GetUndefinedPoints() const { return this->UndefinedPoints; }
  std::uint64_t GetUndefinedVersion() const
  {
    return this->UndefinedPoints.empty() || !this->Field || this->IsInverseField()
      ? 0
      : this->UndefinedVersion;
  }
  ///@}

  ///@{
  /// The vectors on the device, where they are read there, and the matrix that takes them to
  /// displacements; else null. The displacements above are then those of before, or none, until
  /// they are brought to the host.
  const std::shared_ptr<DeviceVectors>& GetDeviceVectors() const { return this->OnDevice; }
  const std::array<double, 9>& GetDeviceMatrix() const { return this->MatrixOnDevice; }
  void BringToHost();
  ///@}

  /// The mesh at rest, with its versions and what has changed between them.
  const RestMesh& GetRestMesh() const { return this->Mesh; }
  /// Changes with the displacements, with the connectivity of the mesh and with the kind of the
  /// deformation.
  std::uint64_t GetVectorsVersion() const { return this->VectorsVersion; }

  /// What changed of the displacements after a version of them: blocks of points, some of which may
  /// be as they were.
  PointRanges GetChanges(std::uint64_t version) const;

private:
  void ReadMesh(const DeformationSource& source);
  void ReadField(vtkImageData* image, const DeformationSource& source);
  /// False where the field is not one that can be used in place.
  bool UseFieldInPlace(vtkDataArray* array, const DeformationSource& source);
  /// Has vectors be read where they lie on a device. False where an array has none there.
  bool UseVectorsOnDevice(
    vtkDataArray* array, vtkIdType points, double factor, const DeformationSource& source);
  void ForgetVectorsOnDevice();
  void RememberVectors(const Stamp& stamp, const DeformationSource& source, bool field);
  bool VectorsAreCurrent(const Stamp& stamp, const DeformationSource& source, bool field) const;
  /// Whether equal vectors are equal displacements, now and when they were read last.
  bool HasSameUnits(const DeformationSource& source) const;
  /// Calls its argument for all displacements in world units.
  using VectorSource = std::function<void(const VectorTaker&)>;
  /// read: of so many displacements; it throws an Error where some cannot be used. derived: of
  /// which those of others follow; null: of none.
  void SetVectors(std::size_t count, const VectorSource& read, double factor,
    const DeformationSource& source, const DerivedNodes* derived = nullptr);
  /// The same without a new version.
  void ReplaceVectors(std::size_t count, const VectorSource& read, double factor,
    const DeformationSource& source, const DerivedNodes* derived = nullptr);
  /// Makes the displacements of derived nodes, which stand behind count others, those that follow
  /// from these. changed: set for blocks where some are other ones now.
  void UpdateDerived(
    const DerivedNodes& derived, std::size_t count, std::vector<std::atomic<bool>>& changed);

  /// Throws an Error where tetrahedra use a vector that cannot be used.
  void CheckFaults(const MeshParts& shape, const DeformationSource& source) const;
  /// There are so many vectors now, in so many blocks.
  void ResizeVectors(std::size_t count, std::size_t blocks);

  bool Field = false;
  RestMesh Mesh;
  std::vector<float> Vectors;
  static constexpr std::size_t PointsPerBlock = 512;
  std::vector<std::uint64_t> BlockVersions; // that with which each block of the vectors came
  bool VectorsAreWhole = false;             // else the last reading of them failed
  NodeFaults Faults;                        // of the vectors, where they are read from a mesh
  std::array<int, 3> FieldDimensions{ { 0, 0, 0 } };
  std::array<double, 12> IndexToField{};
  glm::dvec3 FieldSpacing{ 1.0 };             // in world units
  std::vector<unsigned char> UndefinedPoints; // of the field; empty: all are defined
  std::uint64_t UndefinedVersion = 0;
  DisplacementField FieldInPlace; // with an owner, or there is none
  IndexBounds FieldBounds;
  FieldScan ScanInPlace;
  const void* ArrayInPlace = nullptr;
  vtkMTimeType TimeInPlace = 0; // of the array
  PointRanges ChangesInPlace;   // those that led from one version of the vectors to this one
  static constexpr std::uint64_t NoVersion = ~std::uint64_t{ 0 };
  std::uint64_t VersionBeforeChanges = NoVersion;
  std::uint64_t VectorsVersion = 0;

  std::shared_ptr<DeviceVectors> OnDevice;
  std::array<double, 9> MatrixOnDevice{};
  vtkSmartPointer<vtkDataArray> ArrayOnDevice;
  double FactorOnDevice = 1.0;
  bool IsOnHost = true; // what the device has

  // What the above was read from.
  Stamp VectorsStamp;
  std::uint64_t ConnectivityOfVectors = 0;
  DeformationSource VectorsSource;
  std::vector<VectorMemory> Memories; // of each part of a mesh
  bool MemoriesAreOfPoints = false;   // and not of vectors
};

} // namespace deformvolume

#endif
