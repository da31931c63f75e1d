// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeIndexDeformation_h
#define DeformVolumeIndexDeformation_h

#include "DeformVolumeExport.h"
#include "DerivedNodes.h"
#include "DeviceVectors.h"
#include "DisplacementField.h"
#include "MeshAtRest.h"
#include "NodeFaults.h"
#include "OutsideVoxels.h"
#include "PointRanges.h"
#include "Tetrahedron.h"
#include "VectorConversion.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace deformvolume
{

/// A deformation mesh or a displacement field in the units of the kernels: indices of the volume,
/// and output voxels. Subclasses read the data.
class DEFORMVOLUME_EXPORT IndexDeformation
{
public:
  virtual ~IndexDeformation() = default;

  /// Whether the deformation is a field, and not a mesh.
  bool IsField() const { return this->Field; }
  /// Whether the deformation is a field from the output to the volume at rest.
  bool IsInverseField() const { return this->Field && this->Inverse; }

  ///@{
  /// The mesh at rest, and the displacements of its nodes, of at most LargestDisplacement. Only for
  /// meshes.
  virtual MeshAtRest GetMeshAtRest() const;
  const float* GetNodeDisplacements() const { return this->Vectors.data(); }
  /// The tetrahedra that have other nodes than at a version of the connectivity, each once. Empty:
  /// unknown.
  virtual std::optional<std::vector<TetrahedronChange>> GetConnectivityChanges(
    std::uint64_t version) const;
  ///@}

  ///@{
  /// The field. An inverse field takes indices of the output. GetFieldShape() returns the field
  /// without its vectors, with the matrix for GetDeviceVectors(). Only for fields.
  virtual DisplacementField GetField(const OutsideVoxels& outside) const;
  DisplacementField GetFieldShape(const OutsideVoxels& outside) const;
  ///@}

  ///@{
  /// The undefined points of a field, one byte each; empty if there are none. Their vectors are 0
  /// in a forward field, and NaN in an inverse field.
  const std::vector<unsigned char>& GetUndefinedPoints() const { return this->UndefinedPoints; }
  /// Returns a mask of the voxels of a part of the volume, one byte each: 1 if the displacement
  /// depends on undefined points of a forward field, or if the voxel is blanked. blanked: the
  /// blanked voxels; null: there are none. blankedBits: the bits of its values that blank a voxel.
  std::vector<unsigned char> FindUndefinedVoxels(const Extent& part, const OutsideVoxels& outside,
    const unsigned char* blanked, unsigned char blankedBits) const;
  ///@}

  ///@{
  /// The vectors that a device can read without a copy, and the matrix that converts them to
  /// displacements. Null: there are none.
  const std::shared_ptr<DeviceVectors>& GetDeviceVectors() const { return this->OnDevice; }
  const std::array<double, 9>& GetDeviceMatrix() const { return this->MatrixOnDevice; }
  ///@}

  /// Changes with the displacements, the connectivity of the mesh and the kind of the deformation.
  std::uint64_t GetVectorsVersion() const { return this->VectorsVersion; }
  /// The blocks of points whose displacements on the host have changed since a version. Some points
  /// of a block may be unchanged.
  virtual PointRanges GetChanges(std::uint64_t version) const;

protected:
  /// Calls its argument with all vectors.
  using VectorSource = std::function<void(const VectorTaker&)>;
  /// Sets the displacements. read: throws an Error if vectors cannot be used; Faults then marks
  /// those that are too long. count: number of vectors that `read` gives. derived: the derived
  /// nodes, whose displacements are computed from these vectors; null: there are none. Increase
  /// VectorsVersion before.
  void SetDisplacements(std::size_t count, const VectorSource& read,
    const glm::dmat3& toDisplacement, const DerivedNodes* derived = nullptr);

  /// Sets the vectors of undefined points to NaN.
  void EraseUndefinedVectors();

  bool Field = false;
  bool Inverse = false;
  std::vector<float> Vectors; // in output voxels
  std::vector<unsigned char> UndefinedPoints;
  bool VectorsAreWhole = false; // false: the last reading failed
  NodeFaults Faults;            // of the vectors of a mesh
  std::array<int, 3> FieldDimensions{ { 0, 0, 0 } };
  std::array<double, 12> IndexToField{};
  glm::dvec3 FieldSpacing{ 1.0 }; // in world units
  std::shared_ptr<DeviceVectors> OnDevice;
  std::array<double, 9> MatrixOnDevice{};
  std::uint64_t VectorsVersion = 0;
  std::vector<std::uint64_t> BlockVersions; // VectorsVersion at the last change of each block

private:
  static constexpr std::size_t PointsPerBlock = 512;

  /// Sets the number of vectors and of blocks.
  void ResizeVectors(std::size_t count, std::size_t blocks);
  /// Computes the displacements of derived nodes, which follow `count` other displacements.
  /// changed: set for blocks whose displacements have changed.
  void UpdateDerived(
    const DerivedNodes& derived, std::size_t count, std::vector<std::atomic<bool>>& changed);
};

} // namespace deformvolume

#endif
