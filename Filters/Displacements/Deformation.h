// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDeformation_h
#define DeformVolumeDeformation_h

#include "DeformationSource.h"
#include "FieldChecker.h"
#include "IndexBounds.h"
#include "IndexDeformation.h"
#include "RestMesh.h"
#include "VectorArray.h"

#include "vtkSmartPointer.h"

#include <glm/mat3x3.hpp>

#include <cstdint>
#include <optional>
#include <vector>

class vtkImageData;

namespace deformvolume
{

/// Returns the matrix that converts the vectors of a source to displacements.
glm::dmat3 GetToDisplacement(const DeformationSource& source);

/// A deformation that is read from VTK data. Only data that have changed are read again.
class Deformation : public IndexDeformation
{
public:
  /// Reads a source. Throws an Error if it cannot be used.
  void Read(const DeformationSource& source);

  const std::vector<Tetrahedron>& GetTetrahedra() const { return this->Mesh.GetTetrahedra(); }
  const std::vector<glm::dvec3>& GetRestPoints() const { return this->Mesh.GetPoints(); }
  MeshAtRest GetMeshAtRest() const override
  {
    return { this->GetTetrahedra(), this->GetRestPoints(), this, this->Mesh.GetShapeVersion(),
      this->Mesh.GetConnectivityVersion() };
  }
  std::optional<std::vector<TetrahedronChange>> GetConnectivityChanges(
    std::uint64_t version) const override
  {
    return this->Mesh.GetChanges(version);
  }

  ///@{
  /// The field, and the bounds of the deformed volume; null if they were not computed with the
  /// field. A large field with a point at each voxel is not copied (see DisplacementField::Owner).
  DisplacementField GetField(const OutsideVoxels& outside) const override;
  const IndexBounds* GetFieldBounds() const
  {
    return this->FieldInPlace.Owner ? &this->FieldBounds : nullptr;
  }
  ///@}

  /// Differs for forward fields with other undefined points, and is 0 for all other deformations.
  std::uint64_t GetUndefinedVersion() const
  {
    return this->UndefinedPoints.empty() || !this->Field || this->IsInverseField()
      ? 0
      : this->UndefinedVersion;
  }

  /// Reads vectors that are on a device. The displacements and the field are valid only after this
  /// call if GetDeviceVectors() is not null.
  void BringToHost();

  /// The mesh at rest, with its versions and the changes between them.
  const RestMesh& GetRestMesh() const { return this->Mesh; }

  PointRanges GetChanges(std::uint64_t version) const override;

private:
  void ReadMesh(const DeformationSource& source);
  void ReadField(vtkImageData* image, const DeformationSource& source);
  /// Returns false if the field cannot be used without a copy.
  bool UseFieldInPlace(vtkDataArray* array, const DeformationSource& source);
  /// Uses the vectors of an array in the memory of a device. Returns false if the array has none
  /// there.
  bool UseVectorsOnDevice(vtkDataArray* array, vtkIdType points, const DeformationSource& source);
  void ConvertField(vtkDataArray* array, const DeformationSource& source);
  void RememberVectors(const Stamp& stamp, const DeformationSource& source, bool field);
  bool VectorsAreCurrent(const Stamp& stamp, const DeformationSource& source, bool field) const;
  /// Whether the conversion from vectors to displacements is the same as at the last reading.
  bool HasSameUnits(const DeformationSource& source) const;
  /// Calls SetDisplacements() for vectors in world units.
  void ReplaceVectors(std::size_t count, const VectorSource& read, const DeformationSource& source,
    const DerivedNodes* derived = nullptr);

  /// Throws an Error if tetrahedra use a node with a faulty vector.
  void CheckFaults(const MeshParts& shape, const DeformationSource& source) const;

  RestMesh Mesh;
  std::uint64_t UndefinedVersion = 0;
  DisplacementField FieldInPlace; // no Owner: there is none
  IndexBounds FieldBounds;
  FieldChecker ScanInPlace;
  const void* ArrayInPlace = nullptr;
  vtkMTimeType TimeInPlace = 0; // modification time of the array
  PointRanges ChangesInPlace;   // changes from VersionBeforeChanges to VectorsVersion
  static constexpr std::uint64_t NoVersion = ~std::uint64_t{ 0 };
  std::uint64_t VersionBeforeChanges = NoVersion;

  vtkSmartPointer<vtkDataArray> ArrayOnDevice;
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
