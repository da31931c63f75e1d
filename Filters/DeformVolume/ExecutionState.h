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
  void Release();
  /// The values of the volume may have changed, although its arrays have not been modified.
  void ForgetValues();
  bool HoldsMemory() const { return !this->ArraysInUse.empty(); }

  // What the member Bounds was computed for.
  struct BoundsKey
  {
    Stamp Inputs;
    ImageGeometry Volume;
    OutputMap ToOutput;
    double DisplacementScale = 0.0;
    std::string Choice;
    int OutsideMode = -1;
    double FadeDistance = 0.0;
    bool operator==(const BoundsKey& other) const;
  };
  BoundsKey KeyOfBounds;
  IndexBounds Bounds;
  std::set<double> TimesInBounds;

  // The last extent that was computed from Bounds, and what it depends on besides Bounds.
  struct ExtentKey
  {
    BoundsKey Settings; // without Inputs
    int Padding = 0;
    int Granularity = 0; // 0: LastExtent is not valid
    bool operator==(const ExtentKey& other) const;
  };
  ExtentKey KeyOfExtent;
  Extent LastExtent{ { 0, -1, 0, -1, 0, -1 } };

  // Versions of the deformation that was included in Bounds last: of the shape and of the vectors.
  std::pair<std::uint64_t, std::uint64_t> VersionsInBounds;

  // Bounds of the deformation mesh, and the versions of the mesh that they were computed for.
  MeshBounds BoundsOfMesh;
  std::uint64_t BoundsShapeVersion = 0;
  std::uint64_t BoundsConnectivityVersion = 0;
  std::uint64_t BoundsVectorsVersion = 0;
  VoxelGrid BoundsGrid;

  // The regions of the volume with their deformed bounds, and what they were computed for.
  struct RegionsKey
  {
    std::uint64_t ShapeVersion = 0;
    std::uint64_t VectorsVersion = 0;
    ImageGeometry Volume;
    OutputMap ToOutput;
    OutsideVoxels Outside;
    bool operator==(const RegionsKey& other) const;
  };
  RegionsKey KeyOfRegions;
  std::unique_ptr<RestRegions> Regions;

  // The extent of the volume that was needed last. A Share identifies the part of the output and
  // the volume that the extent belongs to.
  struct Share
  {
    Extent Asked{ { 0, -1, 0, -1, 0, -1 } }; // empty: all
    int Piece = 0;
    int Pieces = 0;
    ImageGeometry Volume;
    bool operator==(const Share& other) const;
  };
  Share LastShare;
  Extent LastNeeded{ { 0, -1, 0, -1, 0, -1 } };

  deformvolume::SplitNodes Splits;
  std::uint64_t WarnedOfSplitsOf = 0; // the version of the shape; 0: not warned
  // Versions of the mapping and of the vectors for which WarnOfFading() was called last.
  std::pair<std::uint64_t, std::uint64_t> VersionsOfFading;
  // The last warning about the fading of a field.
  std::string FaultOfFading;

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
