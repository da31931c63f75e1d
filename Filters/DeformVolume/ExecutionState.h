// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeExecutionState_h
#define DeformVolumeExecutionState_h

#include "CoarseVolume.h"
#include "Deformation.h"
#include "DeviceSession.h"
#include "ExtraArrays.h"
#include "ImageGeometry.h"
#include "IndexBounds.h"
#include "MappingCache.h"
#include "MeshBounds.h"
#include "OutputArrays.h"
#include "RestRegions.h"
#include "SplitNodes.h"

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>

namespace deformvolume
{

/// State that vtkDeformVolumeFilter keeps from one execution to the next for one SamplingFactor.
/// All members refer to the coarse volume.
struct ExecutionState
{
  CoarseVolume Volume;
  deformvolume::Deformation Deformation;
  MappingCache Mapping;
  DeviceSession Device;
  OutputArrays Outputs;
  ExtraArrays Extra;

  /// Frees the memory on the device, and all host memory with the size of a volume.
  void Release()
  {
    this->Device.ReleaseMemory();
    this->Outputs.Forget();
    this->Extra.Forget();
    this->Mapping.ReleaseVoxels();
    this->Volume.Forget();
    this->ArraysInUse.clear();
  }
  /// The values of the volume may have changed, although its arrays have not been modified.
  void ForgetValues()
  {
    this->Device.ForgetValues();
    this->Extra.Forget();
    this->Volume.Forget();
  }
  bool HoldsMemory() const { return !this->ArraysInUse.empty(); }

  // What the member Bounds was computed for: the stamps of the inputs; and the volume, the output,
  // DisplacementScale, the choice of the vectors, OutsideMode and FadeDistance.
  using BoundsSettings = std::tuple<ImageGeometry, OutputMap, double, std::string, int, double>;
  using BoundsKey = std::pair<Stamp, BoundsSettings>;
  BoundsKey KeyOfBounds;
  IndexBounds Bounds;
  std::set<double> TimesInBounds;

  // The last extent that was computed from Bounds, and what it depends on besides Bounds: also on
  // Padding and on BoundsGranularity. If the latter is 0, LastExtent is not valid.
  using ExtentKey = std::tuple<BoundsSettings, int, int>;
  ExtentKey KeyOfExtent;
  Extent LastExtent = EmptyExtent;

  // Versions of the deformation that was included in Bounds last: of the shape and of the vectors.
  std::pair<std::uint64_t, std::uint64_t> VersionsInBounds;

  // Bounds of the deformation mesh, and the versions of the mesh that they were computed for.
  MeshBounds BoundsOfMesh;
  std::uint64_t BoundsShapeVersion = 0;
  std::uint64_t BoundsConnectivityVersion = 0;
  std::uint64_t BoundsVectorsVersion = 0;
  VoxelGrid BoundsGrid;

  // The regions of the volume with their deformed bounds, and what they were computed for: the
  // versions of the shape and of the vectors, the volume, the output, and the voxels outside.
  using RegionsKey =
    std::tuple<std::uint64_t, std::uint64_t, ImageGeometry, OutputMap, OutsideVoxels>;
  RegionsKey KeyOfRegions;
  std::unique_ptr<RestRegions> Regions;

  // The extent of the volume that was needed last, and what it was needed for: the extent of the
  // output (empty: all), the piece, the number of pieces, and the geometry of the volume.
  using OutputPart = std::tuple<Extent, int, int, ImageGeometry>;
  OutputPart LastPart;
  Extent LastNeeded = EmptyExtent;

  deformvolume::SplitNodes Splits;
  std::uint64_t WarnedOfSplitsOf = 0;  // the version of the shape; 0: not warned
  std::uint64_t WarnedOfOverlapOf = 0; // the version of the shape; 0: not warned
  // Versions of the mapping and of the vectors of the last warning of WarnOfFading().
  std::pair<std::uint64_t, std::uint64_t> VersionsOfFading;
  // The last warning about the fading of a field.
  std::string FadingWarning;

  // Version of the vectors for which inverted tetrahedra of an inverse field were counted, and
  // their number.
  std::uint64_t FoldsVersion = 0;
  std::int64_t NumberOfFolds = 0;

  // The arrays of the volume in the last execution with this state, and the stamp of its source.
  std::vector<const void*> ArraysInUse;
  std::pair<const void*, vtkMTimeType> SourceInUse;
};

} // namespace deformvolume

#endif
