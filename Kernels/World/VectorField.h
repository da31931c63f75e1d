// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVectorField_h
#define DeformVolumeVectorField_h

#include "DisplacementField.h"
#include "ImageGeometry.h"
#include "OutsideVoxels.h"
#include "VectorView.h"
#include "VoxelGrid.h"

#include <array>
#include <cstdint>
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

  /// Makes what follows from a volume and from where it lies in the output. Throws an Error where a
  /// vector is not finite, or too long.
  void Update(const ImageGeometry& volume, const OutputMap& toOutput);

  bool IsInverse() const { return this->Inverse; }
  const ImageGeometry& GetGrid() const { return this->Grid; }

  ///@{
  /// After Update.
  DisplacementField Get(const OutsideVoxels& outside) const;
  /// Changes with the field.
  std::uint64_t GetVersion() const { return this->Version; }
  ///@}

private:
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
};

} // namespace deformvolume

#endif
