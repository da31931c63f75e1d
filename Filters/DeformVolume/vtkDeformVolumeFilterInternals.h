// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkDeformVolumeFilterInternals_h
#define vtkDeformVolumeFilterInternals_h

#include "ExecutionState.h"
#include "ImageGeometry.h"
#include "MeshGathering.h"
#include "MeshGrids.h"
#include "PipelineExecution.h"
#include "Ranks.h"

#include "vtkDeformVolumeFilter.h"
#include "vtkInformation.h"
#include "vtkSmartPointer.h"

#include <exception>
#include <functional>
#include <map>
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
    : State(&this->States[1])
    , Self(self)
  {
  }

  /// Makes State that of SamplingFactor. Throws an Error where it is none.
  void SelectState();

  /// Chooses the device for State, with what the other states leave of the memory limit, and
  /// returns its name.
  std::string SelectDevice();

  /// Calls a function that throws an Error where the memory does not suffice; then once more, after
  /// what other states hold has been freed.
  void CheckWithRoom(const std::function<void()>& check);

  /// Frees what other states hold of volumes that are no longer connected. arrays: those of the
  /// volume.
  void ReleaseOldVolumes(const std::vector<deformvolume::SourceArray>& arrays);

  /// Bytes that all states hold on the device.
  std::uint64_t GetDeviceMemory() const;

  /// Reads what the source of the reference image announces; null: there is none. Throws an Error
  /// where it has no grid.
  void ReadReference(vtkInformation* reference);
  /// Throws an Error where the ranks have different ones. Collective.
  void CheckReferenceOfRanks(const deformvolume::Ranks& ranks) const;
  /// Warns where settings are without effect beside the reference image.
  void WarnOfReference();
  /// Warns that all of the output is background.
  void WarnOfNothing() const;
  /// Whether the output ends where the deformed volume does.
  bool EndsWithVolume() const
  {
    return this->Self->OutputBoundsMode == DEFORMED_BOUNDS && !this->Reference;
  }

  /// The output's origin, spacing and direction; with a reference image, its extent as well.
  deformvolume::ImageGeometry GetOutputGeometry(const deformvolume::ImageGeometry& volume) const;

  deformvolume::DeformationSource MakeSource(
    const deformvolume::ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest) const;

  /// The same where port 1 is not connected: all of the volume stays where it is. Throws an Error
  /// where port 2 is connected.
  deformvolume::DeformationSource MakeSourceAtRest(const deformvolume::ImageGeometry& volume);

  /// Brings the deformation up to date with what ports 1 and 2 have, on all ranks together.
  /// Collective.
  deformvolume::DeformationSource ReadDeformation(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest);

  /// What becomes of voxels outside the deformation. Throws an Error where FadeDistance is none.
  deformvolume::OutsideVoxels GetOutside() const;
  /// Throws an Error where the deformation cannot do that.
  void CheckOutside() const;

  /// The whole volume as SamplingFactor leaves it. Throws an Error where too little is left.
  deformvolume::ImageGeometry GetCoarseGeometry(const deformvolume::ImageGeometry& volume) const;

  /// Where the voxels of the whole volume lie: as its source announces it, and what it does not
  /// announce as its data have it. Collective.
  deformvolume::ImageGeometry GetVolumeGeometry(
    const deformvolume::Ranks& ranks, vtkInformation* volumeInfo, vtkInformation* output);

  /// The whole extent of an output that is as large as the deformed volume, padded. It is that of
  /// the last call as far as BoundsGranularity has it kept. Collective.
  deformvolume::Extent GetDeformedExtent(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkInformation* output);
  /// The next such extent depends on no other.
  void ForgetDeformedExtent() { this->State->KeyOfExtent = {}; }

  ///@{
  /// The bounds that decided the extent of the output hold the times seen before. Where the
  /// deformation at the time asked for leaves them they grow, and the next pass finds the filter
  /// out of date, so that its consumers learn of the new extent. HoldTime: before extents are asked
  /// for, so that who updates this filter alone gets all of the new extent. KeepInBounds: where
  /// that pass did not come, or no time is asked for. Collective.
  void HoldTime(vtkInformation* volumeInfo, vtkInformation* output);
  void KeepInBounds(const deformvolume::Ranks& ranks, const deformvolume::ImageGeometry& volume,
    const deformvolume::DeformationSource& source, vtkInformation* output);
  ///@}
  /// Warns where a consumer that does not know of an extent that has grown asks for the one before.
  void WarnOfCut(vtkInformation* output);

  /// The extent of the volume that is needed for what is asked for: all of it, unless a part of the
  /// output or CUSTOM_BOUNDS asks for less, and all before the volume can give less. Collective.
  deformvolume::Extent GetNeededExtent(
    const deformvolume::Ranks& ranks, vtkInformation* volumeInfo, vtkInformation* output);

  /// The volume whose data are there, and what they are a part of, both as SamplingFactor leaves
  /// them. Throws an Error where they are not what the source announced or was asked for.
  deformvolume::MappedVolume GetMappedVolume(vtkImageData* volume, vtkInformation* info) const;

  /// The volume without what is outside its whole extent, about which it warns.
  vtkImageData* CutToWhole(vtkImageData* volume, vtkInformation* info);

  /// Runs a function on the ranks that have work. The first time that kernels of a kind are wanted
  /// one rank of each machine goes first, and leaves what it compiled to the others: two processes
  /// that fill one cache disturb each other. Collective.
  void RunInTurn(const deformvolume::Ranks& ranks, const std::string& kind, bool hasWork,
    const std::function<void()>& function) const;

  /// The resampler for the current deformation of a volume, which also becomes ResamplerInUse.
  /// checkMemory throws an Error where the memory does not suffice for one.
  deformvolume::Resampling ChooseResampler(
    vtkImageData* volume, const std::function<void(deformvolume::Resampling)>& checkMemory) const;
  void SetResamplerInUse(deformvolume::Resampling method) const;

  /// Sets what the filter tells of an execution.
  void TakeReport(const deformvolume::DeformReport& report, deformvolume::Resampling method);

  /// Makes what has been counted on this rank that of all ranks. Collective.
  void AddUpCounts(const deformvolume::Ranks& ranks);

  /// Warns where what is ignored changed since the last call.
  void WarnOfIgnored(vtkImageData* volume, const std::vector<std::string>& leftOut);

  /// What arrays are wanted besides those of the volume.
  deformvolume::ExtraArraysWish GetExtraArrays() const
  {
    return { this->Self->GenerateRestPositions, this->Self->GenerateJacobian,
      this->Self->GenerateFoldCount, this->DensityArrays };
  }
  /// Warns where densities lack a part of the volume, and that has changed.
  void WarnOfLoss(const deformvolume::ExtraArrays::Loss& loss);

  /// Warns where voxels that are kept are torn or folded for certain, when the deformation has
  /// changed. output: its whole extent.
  void WarnOfFading(const deformvolume::MappedVolume& mapped, const deformvolume::Extent& output);
  void WarnOfFadingField(
    const deformvolume::MappedVolume& mapped, const deformvolume::Extent& output);

  /// A progress callback for the part of the execution between two fractions.
  std::function<bool(double)> GetProgress(double from, double to) const;

  /// A callback that is told when the compilation of kernels begins and ends: while it lasts, the
  /// progress of the filter has a text that says so.
  std::function<void(bool)> GetCompilationReport() const;

  deformvolume::DeformReport Report; // of the last execution
  double StaticMappingTime = 0.0;    // of that

  std::set<std::string> CategoricalArrays;
  std::set<std::string> DensityArrays;
  deformvolume::DeformationGrids Grids;
  deformvolume::MeshGathering Gathering;

  // What is kept for each SamplingFactor, and for the one that is set.
  std::map<int, deformvolume::ExecutionState> States;
  deformvolume::ExecutionState* State;
  // That of the output; 0: there is no output that an execution could be compared with.
  int FactorOfOutput = 0;
  /// Whether the volume that was worked on last has a smooth cut.
  bool HadCut = false;

  deformvolume::PipelineExecution Execution;
  /// That of the reference image, while the executive must not find it.
  vtkSmartPointer<vtkInformation> ReferenceInfo;
  /// The grid of the reference image, with its whole extent.
  std::optional<deformvolume::ImageGeometry> Reference;
  /// What the last request for information has thrown.
  std::exception_ptr InformationFailure;
  /// Whether the output was too small, so that the next update has to execute the filter.
  bool BoundsHaveGrown = false;
  /// The whole extent that consumers know, after it has grown in this update.
  std::optional<deformvolume::Extent> ExtentBefore;

private:
  /// False where there was nothing to free.
  bool ReleaseOtherStates();
  /// The time of the first look at a deformation: the one asked for, or the first that the inputs
  /// announce; nothing where it does not vary.
  std::optional<double> FindTime(vtkInformation* output) const;
  /// The bounds of the deformed volume, united over the times seen so far. Collective.
  deformvolume::IndexBounds GetDeformedBounds(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkInformation* output);
  void WarnOfGrowth();
  deformvolume::IndexBounds ReadBounds(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkInformation* output, const double* time);
  /// The extent that BoundsGranularity, Padding and the extent before make of bounds.
  deformvolume::Extent FindExtent(const deformvolume::IndexBounds& bounds) const;
  deformvolume::IndexBounds ComputeBounds(
    const deformvolume::ImageGeometry& volume, const deformvolume::DeformationSource& source);
  /// Makes the links of a whole volume, of a mesh whose voxels outside are not discarded.
  void MakeLinks(
    const deformvolume::VoxelGrid& voxelGrid, const deformvolume::MappedVolume& mapped);
  /// Makes the bounds those of the mesh, whatever its displacements are.
  void UpdateBoundsOfMesh(const deformvolume::VoxelGrid& voxelGrid);
  /// Of the deformation at rest and of its displacements.
  std::pair<std::uint64_t, std::uint64_t> GetVersions() const;
  bool WantsPart(vtkInformation* output) const;
  bool CanTakePart(vtkInformation* volumeInfo) const;
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

  // What stands in for a deformation where none is connected, and the volume that it is made for.
  vtkSmartPointer<vtkImageData> FieldAtRest;
  deformvolume::ImageGeometry VolumeAtRest;

  // What the source of the volume announced, and of which state of it that is.
  deformvolume::ImageGeometry VolumeGeometry;
  std::pair<const void*, vtkMTimeType> VolumeStamp;
  // What is left of a volume beyond its whole extent, and of which volume.
  vtkSmartPointer<vtkImageData> CutVolume;
  std::pair<const void*, vtkMTimeType> CutStamp;

  std::set<std::string> WarnedOf;
  std::string WarnedOfSettings;
  std::string WarnedOfLoss;
};

#endif
