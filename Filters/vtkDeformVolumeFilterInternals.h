// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkDeformVolumeFilterInternals_h
#define vtkDeformVolumeFilterInternals_h

#include "Deformation.h"
#include "DeformedBounds.h"
#include "DeviceSession.h"
#include "ImageGeometry.h"
#include "MappingCache.h"
#include "MeshBounds.h"
#include "MeshGathering.h"
#include "OutputArrays.h"
#include "Ranks.h"
#include "RestRegions.h"

#include "vtkDeformVolumeFilter.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkTimeStamp.h"

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

class vtkImageData;

/// What vtkDeformVolumeFilter keeps from one execution to the next, and what it computes from its
/// settings.
class vtkDeformVolumeFilter::vtkInternals
{
public:
  explicit vtkInternals(vtkDeformVolumeFilter* self)
    : Self(self)
  {
  }

  /// The output's spacing and whole extent, as far as settings and volume decide them.
  deformvolume::ImageGeometry GetOutputGeometry(const deformvolume::ImageGeometry& volume) const;

  deformvolume::DeformationSource MakeSource(
    const deformvolume::ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest) const;

  /// Brings the deformation up to date with what ports 1 and 2 have, on all ranks together.
  /// Collective.
  deformvolume::DeformationSource ReadDeformation(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest);

  /// Where the voxels of the whole volume lie: as its source announces it, and what it does not
  /// announce as its data have it. Collective.
  deformvolume::ImageGeometry GetVolumeGeometry(
    const deformvolume::Ranks& ranks, vtkInformation* volumeInfo, vtkInformation* output);

  /// The bounds of the deformed volume, united over the time steps of the deformation. Collective.
  deformvolume::IndexBounds GetDeformedBounds(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkInformation* output);

  /// Warns where the deformation at the time asked for leaves the bounds that decided the extent of
  /// the output, as can happen between the times that were looked at. These bounds then grow, and
  /// the next pass finds the filter out of date. Collective.
  void KeepInBounds(const deformvolume::Ranks& ranks, const deformvolume::ImageGeometry& volume,
    const deformvolume::DeformationSource& source, vtkInformation* output);

  /// The extent of the volume that is needed for what is asked for: all of it, unless a part of the
  /// output or StreamInput asks for less, and all before the volume can give less. Collective.
  deformvolume::Extent GetNeededExtent(
    const deformvolume::Ranks& ranks, vtkInformation* volumeInfo, vtkInformation* output);

  /// The volume whose data are there, and what they are a part of. Throws an Error where they are
  /// not what the source announced or was asked for.
  deformvolume::MappedVolume GetMappedVolume(vtkImageData* volume, vtkInformation* info) const;

  /// The volume without what is outside its whole extent, about which it warns.
  vtkImageData* CutToWhole(vtkImageData* volume, vtkInformation* info);

  /// Runs a function on the ranks that have work. The first time that kernels of a kind are wanted
  /// one rank of each machine goes first, and leaves what it compiled to the others: two processes
  /// that fill one cache disturb each other. Collective.
  void RunInTurn(const deformvolume::Ranks& ranks, const std::string& kind, bool hasWork,
    const std::function<void()>& function) const;

  /// The resampler for the current deformation, which also becomes ResamplerInUse. checkMemory
  /// throws an Error where the memory does not suffice for one.
  deformvolume::Resampling ChooseResampler(
    const std::function<void(deformvolume::Resampling)>& checkMemory) const;
  void SetResamplerInUse(deformvolume::Resampling method) const;

  /// Sets what the filter tells of an execution.
  void TakeReport(const deformvolume::DeformReport& report, deformvolume::Resampling method);

  /// Makes what has been counted on this rank that of all ranks. Collective.
  void AddUpCounts(const deformvolume::Ranks& ranks) const;

  /// The executive unites the extents asked for until an execution succeeds: after a failure the
  /// next one must start anew.
  static void ForgetRequestedExtent(vtkInformation* output);

  /// Whether the output is given up as soon as those after it have used it.
  static bool IsReleased(vtkInformation* output);

  /// Whether an error has to be told: not where one update failed in the same way as the last, and
  /// nothing has changed in between. Interfaces update several times what they show.
  bool IsNews(const std::string& message);

  /// Warns where what is ignored changed since the last call.
  void WarnOfIgnored(vtkImageData* volume, const std::vector<std::string>& leftOut);

  /// A progress callback for the part of the execution between two fractions.
  std::function<bool(double)> GetProgress(double from, double to) const;

  /// A callback that is told when the compilation of kernels begins and ends: while it lasts, the
  /// progress of the filter has a text that says so.
  std::function<void(bool)> GetCompilationReport() const;

  std::set<std::string> CategoricalArrays;
  vtkNew<vtkStringArray> DeviceChoices;
  deformvolume::MeshGathering Gathering;
  deformvolume::Deformation Deformation;
  deformvolume::MappingCache Mapping;
  deformvolume::DeviceSession Device;
  deformvolume::OutputArrays Outputs;

  // What is wrong with a failed information pass is told when data are asked for.
  bool InformationFailed = false;
  std::string PostponedError;
  // Whether the last request for extents failed.
  bool RequestFailed = false;
  // The last error, until an execution succeeds.
  std::string ToldMessage;
  // An aborted execution leaves the filter out of date, and the next pass has to see that.
  bool Aborted = false;
  // So does one whose output was too small.
  bool BoundsHaveGrown = false;
  vtkTimeStamp AbortTime;

private:
  deformvolume::IndexBounds ReadBounds(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkInformation* output, const double* time);
  deformvolume::IndexBounds ComputeBounds(
    const deformvolume::ImageGeometry& volume, const deformvolume::DeformationSource& source);
  /// Of the deformation at rest and of its displacements.
  std::pair<std::uint64_t, std::uint64_t> GetVersions() const;
  bool WantsPart(vtkInformation* output) const;
  bool CanTakePart() const;
  /// An extent that is needed, and what was needed before for the same share of the output: where
  /// the deformation moves to and fro, the volume is not read, sent and mapped at each step.
  deformvolume::Extent KeepNeeded(const deformvolume::Extent& needed,
    const deformvolume::ImageGeometry& volume, vtkInformation* output);
  /// Inverted tetrahedra of an inverse field.
  vtkIdType GetNumberOfFolds();
  /// Where the voxels of the volume go.
  const deformvolume::RestRegions& GetRegions(
    const deformvolume::ImageGeometry& volume, const deformvolume::DeformationSource& source);

  vtkDeformVolumeFilter* Self;

  // What the cached bounds were computed for.
  struct BoundsKey
  {
    deformvolume::Stamp Inputs;
    deformvolume::ImageGeometry Volume;
    glm::dvec3 Scale{ 0.0 };
    double DisplacementScale = 0.0;
    std::string Choice;
    int OutsideMode = -1;
    int NumberOfTimeSamples = 0;
    bool operator==(const BoundsKey& other) const
    {
      return this->Inputs == other.Inputs && this->Volume == other.Volume &&
        this->Scale == other.Scale && this->DisplacementScale == other.DisplacementScale &&
        this->Choice == other.Choice && this->OutsideMode == other.OutsideMode &&
        this->NumberOfTimeSamples == other.NumberOfTimeSamples;
    }
  };
  BoundsKey Key;
  deformvolume::IndexBounds Bounds;
  std::set<double> TimesInBounds;
  // Of the deformation whose bounds were computed last.
  std::pair<std::uint64_t, std::uint64_t> VersionsInBounds;

  // What the source of the volume announced, and of which state of it that is.
  deformvolume::ImageGeometry VolumeGeometry;
  std::pair<const void*, vtkMTimeType> VolumeStamp;
  // What is left of a volume beyond its whole extent, and of which volume.
  vtkSmartPointer<vtkImageData> CutVolume;
  std::pair<const void*, vtkMTimeType> CutStamp;

  // Of the mesh, and which that is.
  deformvolume::MeshBounds BoundsOfMesh;
  std::uint64_t BoundsRestVersion = 0;
  std::uint64_t BoundsVectorsVersion = 0;
  deformvolume::VoxelGrid BoundsGrid;

  // And what these are of.
  struct RegionsKey
  {
    std::uint64_t RestVersion = 0;
    std::uint64_t VectorsVersion = 0;
    deformvolume::ImageGeometry Volume;
    glm::dvec3 Scale{ 0.0 };
    bool Extrapolate = false;
    bool operator==(const RegionsKey& other) const
    {
      return this->RestVersion == other.RestVersion &&
        this->VectorsVersion == other.VectorsVersion && this->Volume == other.Volume &&
        this->Scale == other.Scale && this->Extrapolate == other.Extrapolate;
    }
  };
  // What was needed last, and for which share of the output of which volume.
  struct Share
  {
    deformvolume::Extent Asked{ { 0, -1, 0, -1, 0, -1 } }; // empty: all
    int Piece = 0;
    int Pieces = 0;
    deformvolume::ImageGeometry Volume;
    bool operator==(const Share& other) const
    {
      return this->Asked == other.Asked && this->Piece == other.Piece &&
        this->Pieces == other.Pieces && this->Volume == other.Volume;
    }
  };
  Share LastShare;
  deformvolume::Extent LastNeeded{ { 0, -1, 0, -1, 0, -1 } };

  RegionsKey KeyOfRegions;
  std::unique_ptr<deformvolume::RestRegions> Regions;

  // And for which displacements this was counted.
  std::uint64_t FoldsVersion = 0;
  std::int64_t NumberOfFolds = 0;

  std::string WarnedOf;
  // When what the last error was about had been changed.
  vtkMTimeType ToldTime = 0;
};

#endif
