// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorField_h
#define DeformVolumeVectorField_h

#include "DeviceVectors.h"
#include "DisplacementField.h"
#include "FieldScan.h"
#include "ImageGeometry.h"
#include "IndexBounds.h"
#include "OutsideVoxels.h"
#include "VectorView.h"
#include "VoxelGrid.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace deformvolume
{

/// A displacement field, given in world coordinates, in the units of the kernels.
class VectorField
{
public:
  /// isInverse: it leads from the output to the volume at rest. vectors: one for each point, x
  /// varying fastest; they are borrowed until others are set. Throws an Error where the grid cannot
  /// be used, and where it has another number of points.
  void Set(const ImageGeometry& grid, const VectorView& vectors, bool isInverse);
  /// A field that is not inverse, of vectors that somebody else changes: Update() follows. They are
  /// used where they lie, but for fields whose every second point, or third, ..., is a voxel.
  void Set(const ImageGeometry& grid, const std::shared_ptr<DeviceVectors>& vectors);

  /// Makes what follows from a volume and from where it lies in the output. Throws an Error where a
  /// vector is not finite, or too long.
  void Update(const ImageGeometry& volume, const OutputMap& toOutput);

  bool IsInverse() const { return this->Inverse; }
  const ImageGeometry& GetGrid() const { return this->Grid; }

  ///@{
  /// After Update. Vectors that lie on a device come to the host.
  DisplacementField Get(const OutsideVoxels& outside) const;
  /// The vectors that are used where they lie, or null, and the field without them.
  const std::shared_ptr<DeviceVectors>& GetShared() const { return this->InPlace; }
  DisplacementField GetShape(const OutsideVoxels& outside) const;
  /// The bounds of the deformed volume, where they can be found at less cost than from all vectors.
  std::optional<IndexBounds> FindSharedBounds(const OutsideVoxels& outside);
  /// Changes with the field.
  std::uint64_t GetVersion() const { return this->Version; }
  ///@}

private:
  void Replace(const ImageGeometry& grid, const VectorView& vectors, bool isInverse,
    const std::shared_ptr<DeviceVectors>& shared);
  void Locate(const ImageGeometry& volume, const OutputMap& toOutput);
  void Convert(const ImageGeometry& volume, const OutputMap& toOutput);
  /// Where all voxels are points of the field and there are others between them, makes the field
  /// one of the former, and returns which points these are; else nothing.
  std::vector<std::size_t> TakeVoxels(const Extent& voxels);

  ImageGeometry Grid;
  VectorView Vectors;
  bool Inverse = false;

  std::array<int, 3> Dimensions{ { 0, 0, 0 } };
  std::array<double, 12> IndexToField{};
  std::vector<float> Displacements; // in output voxels
  bool IsOld = true;
  ImageGeometry Volume;
  OutputMap ToOutput;
  std::uint64_t Version = 0;

  // Vectors that somebody else changes.
  std::shared_ptr<DeviceVectors> Shared;
  std::uint64_t Revision = 0; // in this version
  std::shared_ptr<DeviceVectors> InPlace;
  std::array<double, 9> ToDisplacement{}; // of those
  FieldScan Scan;
  std::uint64_t ScannedRevision = 0; // 0: of other units
};

} // namespace deformvolume

#endif
