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

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

class vtkDataArray;
class vtkFloatArray;
class vtkImageData;
class vtkUnsignedIntArray;

namespace deformvolume
{

/// The requested arrays of an output besides those of the volume.
struct ExtraArraysRequest
{
  bool RestPositions = false;
  bool Jacobian = false;
  bool FoldCount = false;
  /// Arrays whose values are divided by the Jacobian.
  std::set<std::string> Densities;

  bool NeedsJacobian() const { return this->Jacobian || !this->Densities.empty(); }
};

/// Makes the arrays of an output that the volume does not have. Rest positions and Jacobians are
/// computed for the voxels of the volume at rest, and resampled like all arrays. Densities are
/// divided by the Jacobian at the voxels of the volume at rest, or with an inverse field at those
/// of the output. Computed arrays are kept as long as they are valid.
class ExtraArrays
{
public:
  /// Adds arrays to those that are resampled, and replaces densities by arrays of floating-point
  /// numbers that Compute() fills. whole: the geometry of the volume. part: its voxels that the
  /// arrays have. Throws an Error if a density array does not exist or is categorical, or if an
  /// array of the volume has the name of an array that is made here.
  void Select(const ExtraArraysRequest& request, const ImageGeometry& whole, const Extent& part,
    const Deformation& deformation, std::vector<SourceArray>& arrays);

  /// Computes the Jacobians of the voxels and the densities if they were selected. mapping: is
  /// updated if it is needed. maskedVolume: has the masks of the volume. openSplits: whether gaps
  /// open where the mesh is split.
  void Compute(const Deformation& deformation, MappingCache& mapping, const MappedVolume& volume,
    vtkImageData* maskedVolume, bool openSplits, const OutputMap& toOutput,
    const std::function<bool(double)>& progress);

  /// Allocates the fold counts of an output. Returns null if they are not requested.
  std::uint32_t* MakeFoldCounts(vtkIdType numberOfPoints);

  /// The part of the volume that is missing in the sums of densities.
  struct Loss
  {
    std::int64_t NumberOfVoxels = 0; // whose Jacobian is not greater than 0
  };
  /// Completes the point arrays of the output after it was resampled.
  Loss Finish(const Deformation& deformation, const OutsideVoxels& outside, double background,
    vtkImageData* output);

  void Forget();

private:
  void UpdateRestPositions(const ImageGeometry& whole, const Extent& part);
  void FinishRestPositions(double background, vtkImageData* output) const;
  void FinishFoldCounts(vtkImageData* output);
  Loss FinishDensities(const Deformation& deformation, const OutsideVoxels& outside,
    double background, vtkImageData* output);
  vtkDataArray* FindCopy(vtkDataArray* density, bool isInverse);
  void UpdateCopies();
  void UpdateJacobians(const Deformation& deformation, MappingCache& mapping,
    const MappedVolume& volume, vtkImageData* maskedVolume, bool openSplits,
    const OutputMap& toOutput, const std::function<bool(double)>& progress);

  ExtraArraysRequest Request;
  ImageGeometry PositionsGeometry;
  glm::dvec3 PositionsOrigin{ 0.0 }; // see GetPositionsOrigin()
  // One array for each axis: kernels are faster with arrays of one component.
  std::array<vtkSmartPointer<vtkFloatArray>, 3> Positions;
  VoxelJacobians MeshJacobians;
  std::uint64_t MappingVersion = 0;
  vtkSmartPointer<vtkFloatArray>
    Jacobians;               // null for inverse fields, or if Jacobians are not needed
  std::vector<float> Ratios; // by which densities are divided; empty for fields
  // What Jacobians were computed for: the versions of the mapping, of the vectors and of the
  // undefined points, the volume, the output, the voxels outside, the masks, whether splits are
  // open, and whether there are volume ratios.
  using JacobiansKey = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t, ImageGeometry,
    OutputMap, OutsideVoxels, Stamp, bool, bool>;
  JacobiansKey KeyOfJacobians;
  vtkSmartPointer<vtkUnsignedIntArray> FoldCounts;
  // A density, and the values that are resampled: floating-point numbers, divided by the volume
  // ratio.
  // The stamps are those of the density and of the Jacobians; empty: there are no values yet.
  struct Copy
  {
    vtkSmartPointer<vtkDataArray> Density;
    vtkSmartPointer<vtkDataArray> Values;
    Stamp ValuesStamp;
  };
  std::vector<Copy> Copies;
};

} // namespace deformvolume

#endif
