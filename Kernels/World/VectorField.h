// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorField_h
#define DeformVolumeVectorField_h

#include "FieldChecker.h"
#include "FieldPointMap.h"
#include "ImageGeometry.h"
#include "IndexBounds.h"
#include "IndexDeformation.h"
#include "VectorView.h"
#include "VoxelGrid.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace deformvolume
{

/// A displacement field that is given in world coordinates.
class VectorField : public IndexDeformation
{
public:
  VectorField() { this->Field = true; }

  /// Set a field. vectors: one for each point, x varying fastest; their memory must stay valid
  /// until another field is set. isInverse: the field leads from the output to the volume at rest.
  /// undefined: one byte for each point, not 0 if its vector is undefined; null: all vectors are
  /// defined. Must stay valid, too.
  /// Throws an Error if the grid is empty or its transform is not invertible, or if the number of
  /// vectors is not the number of points.
  void Set(const ImageGeometry& grid, const VectorView& vectors, bool isInverse,
    const unsigned char* undefined = nullptr);
  /// Set a forward field of vectors that their owner may change. Update() takes such changes into
  /// account. The vectors are not copied, unless the field has several points per voxel
  /// (GetFieldStride()).
  void Set(const ImageGeometry& grid, const std::shared_ptr<DeviceVectors>& vectors);

  /// Updates the field for a volume and its map to the output. Throws an Error if a vector is not
  /// finite or too long.
  void Update(const ImageGeometry& volume, const OutputMap& toOutput);

  /// Returns the field in world coordinates. Throws an Error if a vector is not finite.
  WorldField GetWorldField();

  const ImageGeometry& GetGrid() const { return this->Grid; }

  /// Returns the bounds of the deformed volume, if they can be found without reading all vectors.
  /// Call Update() first.
  std::optional<IndexBounds> FindSharedBounds(const OutsideVoxels& outside);

private:
  void Replace(const ImageGeometry& grid, const VectorView& vectors, bool isInverse,
    const std::shared_ptr<DeviceVectors>& shared);
  bool IsUndefined(std::size_t point) const { return this->Undefined && this->Undefined[point]; }
  void Locate(const ImageGeometry& volume, const OutputMap& toOutput);
  void Convert(const ImageGeometry& volume, const OutputMap& toOutput);
  /// If GetFieldStride() is greater than 1, reduces the field to the points that are voxels, and
  /// returns the indices of these points; otherwise returns an empty list.
  std::vector<std::size_t> TakeVoxels(const Extent& voxels);

  ImageGeometry Grid;
  VectorView WorldVectors;
  const unsigned char* Undefined = nullptr; // of WorldVectors
  bool IsOld = true;
  ImageGeometry Volume;
  OutputMap ToOutput;

  // Vectors that their owner may change. OnDevice are these vectors if they are not copied.
  std::shared_ptr<DeviceVectors> Shared;
  std::uint64_t Revision = 0; // the revision of Shared in this version
  FieldChecker Scan;
  std::uint64_t ScannedRevision = 0; // 0: the last scan was for another volume or output
};

} // namespace deformvolume

#endif
