// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkDeformVolumeFilterInternals_h
#define vtkDeformVolumeFilterInternals_h

#include "ExecutionState.h"
#include "ImageGeometry.h"
#include "InputGeometry.h"
#include "MeshGathering.h"
#include "MeshGrids.h"
#include "PipelineExecution.h"
#include "Ranks.h"

#include "vtkDeformVolumeFilter.h"
#include "vtkInformation.h"
#include "vtkSmartPointer.h"
#include "vtkTimeStamp.h"

#include <exception>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

class vtkImageData;

/// State that vtkDeformVolumeFilter keeps from one execution to the next, and functions that the
/// requests of the pipeline share.
class vtkDeformVolumeFilter::vtkInternals
{
public:
  /// Only the grid of the reference image is read, while the ports before it are read with their
  /// data.
  static constexpr int ReferencePort = 3;

  explicit vtkInternals(vtkDeformVolumeFilter* self)
    : State(&this->States[1])
    , Self(self)
  {
  }

  /// Throws an Error on all ranks if these have different settings or connections. Collective.
  void CheckSettings(const deformvolume::Ranks& ranks) const;

  /// Sets State to the state of SamplingFactor. Throws an Error if SamplingFactor is not 1, 2 or 4.
  void SelectState();

  /// The device that Device requests, for ResolveDevice().
  std::string GetDeviceRequest() const
  {
    return this->Self->Device == "best" ? "" : this->Self->Device;
  }
  /// Selects the device for State and returns its name. The memory limit of State is MemoryLimit
  /// minus the device memory of the other states.
  std::string SelectDevice();

  /// Calls a function that throws an Error if the memory does not suffice. If it throws, frees the
  /// memory of the other states and calls it again.
  void CheckWithRoom(const std::function<void()>& check);

  /// Frees the memory of other states that hold volumes which are no longer connected. arrays: the
  /// arrays of the connected volume.
  void ReleaseOldVolumes(const std::vector<deformvolume::SourceArray>& arrays);

  /// Device memory of all states, in bytes.
  std::uint64_t GetDeviceMemory() const;

  /// Finds the grid of the reference image, if one is connected. Throws an Error if the grid is not
  /// valid, or not the same on all ranks. Collective.
  void ReadReference(const deformvolume::Ranks& ranks, vtkInformation* output);
  /// Warns of properties that have no effect because of the reference image, and of a reference
  /// image that varies in time.
  void WarnOfReference();
  /// Warns that the whole output is background.
  void WarnOfNothing() const;
  /// Whether the extent of the output follows from the deformed volume.
  bool EndsWithVolume() const
  {
    return this->Self->OutputBoundsMode == DEFORMED_BOUNDS && !this->Reference;
  }

  /// The output's origin, spacing and direction; with a reference image, its extent as well.
  deformvolume::ImageGeometry GetOutputGeometry(const deformvolume::ImageGeometry& volume) const;

  deformvolume::DeformationSource MakeSource(
    const deformvolume::ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest) const;

  /// The source if port 1 is not connected: displacements of zero. Throws an Error if port 2 is
  /// connected.
  deformvolume::DeformationSource MakeSourceAtRest(const deformvolume::ImageGeometry& volume);

  /// Updates the deformation of State from the data of ports 1 and 2 of all ranks. Collective.
  deformvolume::DeformationSource ReadDeformation(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkDataObject* shape, vtkDataObject* rest);

  /// How voxels outside the deformation move: OutsideMode and FadeDistance. Throws an Error if
  /// FadeDistance is used and not valid.
  deformvolume::OutsideVoxels GetOutside() const;
  /// Throws an Error if OutsideMode cannot be used with the deformation.
  void CheckOutside() const;

  /// The geometry of the whole coarse volume. Throws an Error if it has fewer than two voxels on an
  /// axis.
  deformvolume::ImageGeometry GetCoarseGeometry(const deformvolume::ImageGeometry& volume) const;

  /// The whole extent of an output that holds the deformed volume and Padding. With
  /// BoundsGranularity, the extent of the last call is kept if possible. Collective.
  deformvolume::Extent GetDeformedExtent(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkInformation* output);
  /// Makes the next result of GetDeformedExtent() independent of the last one.
  void ForgetDeformedExtent() { this->State->KeyOfExtent = {}; }

  ///@{
  /// With DEFORMED_BOUNDS the bounds hold the deformed volume at all times requested so far. If the
  /// deformed volume leaves them at the requested time, the bounds grow, and the filter is out of
  /// date in the next update, in which its consumers get the new extent.
  /// IncludeRequestedTimeInBounds() is called in the pass for time-dependent information, before
  /// extents are requested, so that an update of this filter alone gives the whole new extent.
  /// IncludeDataInBounds() is called in RequestData(), for updates without that pass or without a
  /// time. Collective.
  void IncludeRequestedTimeInBounds(vtkInformation* output);
  void IncludeDataInBounds(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, const deformvolume::DeformationSource& source,
    vtkInformation* output);
  ///@}
  /// Marks the filter as modified if the bounds have grown, so that consumers get the new extent.
  /// Does nothing while a consumer collects several time steps.
  void MarkModifiedIfBoundsHaveGrown();
  /// Warns if the whole extent has grown in this update, but a consumer still requests the previous
  /// one.
  void WarnOfTooSmallExtent(vtkInformation* output);

  /// Whether a part of the output is requested, and whether the volume can be read in parts for it.
  bool WantsPart(vtkInformation* output) const;
  bool CanTakePart(vtkInformation* volumeInfo) const;
  /// The extent of the volume that the requested output needs. This is a part of the volume only if
  /// a part of the output is requested, or the output has custom bounds or a reference image, and
  /// the source of the volume can produce parts. Collective.
  deformvolume::Extent GetNeededExtent(
    const deformvolume::Ranks& ranks, vtkInformation* volumeInfo, vtkInformation* output);

  /// The extent of the data of the coarse volume, and the geometry of the whole coarse volume.
  /// Throws an Error if the data differ from what the source announced or from what was requested.
  deformvolume::MappedVolume GetMappedVolume(vtkImageData* volume, vtkInformation* info) const;

  /// Crops a volume that is larger than its whole extent, with a warning. Returns the cropped
  /// volume, or the volume itself.
  vtkImageData* CropToWholeExtent(vtkImageData* volume, vtkInformation* info);

  /// The inputs of an execution.
  struct Inputs
  {
    vtkImageData* Volume = nullptr;       // within its whole extent
    vtkImageData* MaskedVolume = nullptr; // the image whose masks are used, see ReadArrays()
    deformvolume::MappedVolume Mapped;
    deformvolume::DeformationSource Deformation;
    std::vector<deformvolume::SourceArray> Arrays; // to resample

    deformvolume::VoxelGrid GetVoxelGrid() const
    {
      return { this->Mapped.Part, this->Deformation.ToOutput, this->Mapped.Whole.PointExtent };
    }
  };
  /// The results of an execution besides the output.
  struct Results
  {
    deformvolume::DeformReport Report;
    deformvolume::ExtraArrays::Loss Loss;
  };

  ///@{
  /// The steps of an execution: forget the results of the last one; read the inputs; choose the
  /// device and the resampler (Method of the request); resample into an image. Resample() sets the
  /// members of the request except the extents and Method. ReadInputs() and ChooseMethod() are
  /// collective.
  void ResetResults();
  Inputs ReadInputs(
    const deformvolume::Ranks& ranks, vtkInformationVector** input, vtkInformation* output);
  void ChooseMethod(const deformvolume::Ranks& ranks, const Inputs& inputs,
    vtkInformation* volumeInfo, vtkInformation* output, deformvolume::DeformRequest& request);
  Results Resample(const Inputs& inputs, deformvolume::DeformRequest& request, vtkImageData* image);
  ///@}
  /// Sends the volume, its arrays and masks, as far as they have changed. Voxels with an undefined
  /// displacement are blanked.
  void SendVolume(const Inputs& inputs, deformvolume::Resampling method);
  /// If the memory does not suffice to resample into an extent, frees that of other states. Throws
  /// an Error if it still does not suffice. Call Outputs.Prepare() of State first.
  void CheckMemory(
    const Inputs& inputs, const deformvolume::Extent& output, deformvolume::Resampling method);

  /// Chooses the resampler for a volume and the current deformation, and sets ResamplerInUse.
  /// checkMemory: throws an Error if the memory does not suffice for a resampler.
  deformvolume::Resampling ChooseResampler(
    vtkImageData* volume, const std::function<void(deformvolume::Resampling)>& checkMemory) const;
  void SetResamplerInUse(deformvolume::Resampling method) const;

  /// Sets Report, and the results of the execution that the filter has as properties.
  void TakeReport(const deformvolume::DeformReport& report, deformvolume::Resampling method);

  /// Sums the counters over all ranks. Collective.
  void AddUpCounts(const deformvolume::Ranks& ranks);

  /// Keeps the arrays of the output for incremental updates, unless they are to be released.
  void KeepOutputs(const deformvolume::DeformReport& report, vtkInformation* output);

  /// Selects the arrays to resample, and warns of inputs that are ignored. Returns the image whose
  /// masks are used: the coarse volume, or the volume itself.
  vtkImageData* ReadArrays(vtkImageData* volume, const deformvolume::MappedVolume& mapped,
    const deformvolume::DeformationSource& source, std::vector<deformvolume::SourceArray>& arrays);
  /// Warns of inputs that are ignored or dubious, if they were not in the last call. leftOut: names
  /// of arrays whose types cannot be resampled.
  void WarnOfInputs(vtkImageData* volume, const std::vector<std::string>& leftOut,
    const deformvolume::MappedVolume& mapped, const deformvolume::DeformationSource& source);

  /// The requested arrays besides those of the volume.
  deformvolume::ExtraArraysRequest GetExtraArrays() const
  {
    return { this->Self->GenerateRestPositions, this->Self->GenerateJacobian,
      this->Self->GenerateFoldCount, this->DensityArrays };
  }
  /// Announces the type of the active scalars of the output if they are a density of integers.
  void AnnounceScalars(vtkInformation* output) const;

  /// Warns if density arrays lack a part of the volume, unless the last warning was the same.
  void WarnOfLoss(const deformvolume::ExtraArrays::Loss& loss);

  /// Warns if the volume is stretched over the gap of a split mesh, once for a shape of the mesh.
  /// volume: with its masks.
  void WarnOfSplits(vtkImageData* volume);
  /// Warns if bodies of the mesh overlap at rest, once for a shape of the mesh.
  void WarnOfOverlap(const deformvolume::MappedVolume& mapped);
  /// Warns if kept voxels are certainly torn or folded, once for each change of the deformation.
  /// volume: with its masks. output: the whole extent of the output.
  void WarnOfFading(vtkImageData* volume, const deformvolume::MappedVolume& mapped,
    const deformvolume::Extent& output);
  void WarnOfFadingField(
    const deformvolume::MappedVolume& mapped, const deformvolume::Extent& output);

  /// A progress callback for the part of the execution between two fractions.
  std::function<bool(double)> GetProgress(double from, double to) const;

  /// A callback for the begin and the end of the compilation of kernels. It sets the progress text
  /// of the filter meanwhile.
  std::function<void(bool)> GetCompilationReport() const;

  deformvolume::DeformReport Report; // of the last execution
  double StaticMappingTime = 0.0;    // of the last execution

  std::set<std::string> CategoricalArrays;
  std::set<std::string> DensityArrays;
  deformvolume::DeformationGrids Grids;
  deformvolume::MeshGathering Gathering;

  // The state of each SamplingFactor that was used, and that of the current one.
  std::map<int, deformvolume::ExecutionState> States;
  deformvolume::ExecutionState* State;
  // SamplingFactor of the last output; 0: there is no output with which the next one can be
  // compared.
  int FactorOfOutput = 0;
  /// Whether the volume of the last execution has a smooth cut.
  bool HadCut = false;

  deformvolume::PipelineExecution Execution;
  /// Information of the reference image, while it is hidden from the executive; see
  /// ModifyRequest().
  vtkSmartPointer<vtkInformation> ReferenceInfo;
  /// The whole volume.
  deformvolume::InputGeometry VolumeGeometry;
  /// The grid of the reference image, with its whole extent.
  std::optional<deformvolume::ImageGeometry> Reference;
  /// Makes the filter read an image in memory again that has been modified. Programs write the
  /// values of an image, and call Modified() of the image only.
  void ForgetModifiedImage();
  /// The exception that the last request for information has thrown.
  std::exception_ptr InformationFailure;
  /// Whether the extent of the output was too small, so that the next update has to execute the
  /// filter.
  bool BoundsHaveGrown = false;
  /// The last request for data since the bounds grew. Consumers write to it after the filter.
  vtkSmartPointer<vtkInformation> DataRequest;
  /// The whole extent before it grew, until data are requested or consumers get the new extent.
  std::optional<deformvolume::Extent> ExtentBeforeGrowth;

private:
  /// Returns false if there was nothing to free.
  bool ReleaseOtherStates();
  /// Whether the deformation announces times.
  bool DeformationHasTimes() const;
  /// The time of inputs that have chosen one. Empty if they have none, or different ones.
  std::optional<double> FindTimeOfData() const;
  /// The bounds of the deformed volume, united over the times seen so far. Collective.
  deformvolume::IndexBounds GetDeformedBounds(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkInformation* output);
  void WarnOfGrowth();
  deformvolume::IndexBounds ReadBounds(const deformvolume::Ranks& ranks,
    const deformvolume::ImageGeometry& volume, vtkInformation* output, const double* time);
  /// Computes an extent from bounds, Padding, BoundsGranularity and the last extent.
  deformvolume::Extent FindExtent(const deformvolume::IndexBounds& bounds) const;
  deformvolume::IndexBounds ComputeBounds(
    const deformvolume::ImageGeometry& volume, const deformvolume::DeformationSource& source);
  /// Updates the mapping of the whole volume. For meshes, if voxels outside are not discarded.
  void MakeLinks(
    const deformvolume::VoxelGrid& voxelGrid, const deformvolume::MappedVolume& mapped);
  /// Updates BoundsOfMesh for the mesh at rest.
  void UpdateBoundsOfMesh(const deformvolume::VoxelGrid& voxelGrid);
  /// Versions of the deformation: of the shape and of the vectors.
  std::pair<std::uint64_t, std::uint64_t> GetVersions() const;
  /// Adds the extent that was needed before for the same part of the output. If the deformation
  /// moves to and fro, the volume is then not read, uploaded and mapped again at each step.
  deformvolume::Extent KeepNeeded(const deformvolume::Extent& needed,
    const deformvolume::ImageGeometry& volume, vtkInformation* output);
  /// Number of inverted tetrahedra of an inverse field.
  vtkIdType GetNumberOfFolds();
  /// Updates and returns the regions of the volume in State.
  const deformvolume::RestRegions& GetRegions(
    const deformvolume::ImageGeometry& volume, const deformvolume::DeformationSource& source);

  vtkDeformVolumeFilter* Self;

  // The field of zeros that is used if no deformation is connected, and the volume that it was made
  // for.
  vtkSmartPointer<vtkImageData> FieldAtRest;
  deformvolume::ImageGeometry VolumeAtRest;

  deformvolume::InputGeometry ReferenceGeometry;
  vtkTimeStamp ImageRead; // when the volume was read last
  // The volume that CropToWholeExtent() has cropped, and the stamp of the volume that it was
  // cropped from.
  vtkSmartPointer<vtkImageData> CroppedVolume;
  std::pair<const void*, vtkMTimeType> CroppedStamp;

  std::set<std::string> WarnedOf;
  std::string WarnedOfSettings;
  bool WarnedOfTimes = false;
  std::string WarnedOfLoss;
};

#endif
