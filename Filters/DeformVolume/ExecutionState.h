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

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>

namespace deformvolume
{

/// What vtkDeformVolumeFilter keeps of a volume at one resolution from one execution to the next:
/// for each SamplingFactor that is in use there is one. All of it is as if the voxels that are left
/// were the volume.
struct ExecutionState
{
  CoarseVolume Volume;
  deformvolume::Deformation Deformation;
  MappingCache Mapping;
  DeviceSession Device;
  OutputArrays Outputs;
  ExtraArrays Extra;

  /// Frees the memory of the device and all that is as large as a volume.
  void Release();
  bool HoldsMemory() const { return !this->ArraysInUse.empty(); }

  // What the cached bounds were computed for.
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

  // The last extent that was made of the bounds, and what it depends on besides these.
  struct ExtentKey
  {
    BoundsKey Settings; // without inputs
    int Padding = 0;
    int Granularity = 0; // 0: there is no extent
    bool operator==(const ExtentKey& other) const;
  };
  ExtentKey KeyOfExtent;
  Extent LastExtent{ { 0, -1, 0, -1, 0, -1 } };

  // Of the deformation whose bounds were computed last.
  std::pair<std::uint64_t, std::uint64_t> VersionsInBounds;

  // Of the mesh, and which that is.
  MeshBounds BoundsOfMesh;
  std::uint64_t BoundsShapeVersion = 0;
  std::uint64_t BoundsConnectivityVersion = 0;
  std::uint64_t BoundsVectorsVersion = 0;
  VoxelGrid BoundsGrid;

  // Where the voxels of the volume go, and what that is of.
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

  // What was needed last, and for which share of the output of which volume.
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

  // Mapping and displacements that were looked at for warnings of kept voxels.
  std::pair<std::uint64_t, std::uint64_t> VersionsOfFading;
  // What was wrong with how a field fades.
  std::string FaultOfFading;

  // For which displacements inverted tetrahedra of an inverse field were counted, and their number.
  std::uint64_t FoldsVersion = 0;
  std::int64_t NumberOfFolds = 0;

  // The arrays of the volume that the last execution had, and the state of its source.
  std::vector<const void*> ArraysInUse;
  std::pair<const void*, vtkMTimeType> SourceInUse;
};

} // namespace deformvolume

#endif
