// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeExtraArrays_h
#define DeformVolumeExtraArrays_h

#include "Deformation.h"
#include "ImageGeometry.h"
#include "MappingCache.h"
#include "VolumeArrays.h"
#include "VoxelJacobians.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <array>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

class vtkDataArray;
class vtkFloatArray;
class vtkImageData;
class vtkUnsignedIntArray;

namespace deformvolume
{

/// What arrays are wanted in an output besides those of the volume.
struct ExtraArraysWish
{
  bool RestPositions = false;
  bool Jacobian = false;
  bool FoldCount = false;
  /// Arrays whose values are divided by the Jacobian.
  std::set<std::string> Densities;

  bool NeedsJacobian() const { return this->Jacobian || !this->Densities.empty(); }
};

/// Arrays of an output that are not those of the volume: rest positions and Jacobians are arrays of
/// the volume at rest that are made here, and resampled as all others; densities are divided in the
/// output. What was made is kept for as long as it serves.
class ExtraArrays
{
public:
  /// Adds arrays to those that are resampled, and puts arrays of floating point in the place of
  /// densities. volume: the geometry of the voxels of the arrays. Throws an Error where a density
  /// is not there, or is categorical, and where the volume has an array of the name of another one.
  void Select(const ExtraArraysWish& wish, const ImageGeometry& volume,
    const Deformation& deformation, std::vector<SourceArray>& arrays);

  /// Finds the Jacobians of the voxels that have been selected. mapping: is made where it is
  /// needed.
  void Compute(const Deformation& deformation, MappingCache& mapping, const MappedVolume& volume,
    const OutputMap& toOutput, const std::function<bool(double)>& progress);

  /// Room for the counts of an output of so many voxels; null where they are not wanted.
  std::uint32_t* MakeFoldCounts(vtkIdType numberOfPoints);

  /// What is left out of the sums of densities.
  struct Loss
  {
    std::int64_t NumberOfVoxels = 0; // whose Jacobian is not greater than 0
  };
  /// Completes the point arrays of the output of the arrays that were selected.
  Loss Finish(const Deformation& deformation, const OutsideVoxels& outside, double background,
    vtkImageData* output);

  void Forget();

private:
  void UpdateRestPositions(const ImageGeometry& volume);
  void FinishRestPositions(vtkImageData* output) const;
  void FinishFoldCounts(vtkImageData* output);
  Loss FinishDensities(const Deformation& deformation, const OutsideVoxels& outside,
    double background, vtkImageData* output);
  vtkDataArray* FindFloats(vtkDataArray* density);

  ExtraArraysWish Wish;
  ImageGeometry PositionsGeometry;
  // By axes: kernels are faster with arrays of one component.
  std::array<vtkSmartPointer<vtkFloatArray>, 3> Positions;
  VoxelJacobians OfMesh;
  std::uint64_t MappingVersion = 0;
  vtkSmartPointer<vtkFloatArray> Jacobians; // null: those of an inverse field, or none
  struct JacobiansKey
  {
    std::uint64_t Mapping = 0;
    std::uint64_t Vectors = 0;
    std::uint64_t Undefined = 0;
    ImageGeometry Volume;
    OutputMap ToOutput;
    OutsideVoxels Outside;
    bool operator==(const JacobiansKey& other) const
    {
      return this->Mapping == other.Mapping && this->Vectors == other.Vectors &&
        this->Undefined == other.Undefined && this->Volume == other.Volume &&
        this->ToOutput == other.ToOutput && this->Outside == other.Outside;
    }
  };
  JacobiansKey KeyOfJacobians;
  vtkSmartPointer<vtkUnsignedIntArray> FoldCounts;
  // Copies of densities of integers, and what they are of.
  struct Copy
  {
    std::pair<const void*, vtkMTimeType> Stamp;
    vtkSmartPointer<vtkDataArray> Floats;
  };
  std::vector<Copy> Copies;
};

} // namespace deformvolume

#endif
