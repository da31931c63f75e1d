// SPDX-License-Identifier: BSD-3-Clause
// WorldDeformer: deforms the volume for a request.
#include "WorldDeformer.h"

#include "Background.h"
#include "Densities.h"
#include "Fading.h"
#include "FieldFolds.h"
#include "ParallelFor.h"
#include "ResamplerChoice.h"
#include "WorldBoxes.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <type_traits>

namespace deformvolume
{

namespace
{

// Returns a progress function that maps its fractions, 0 to 1, to fractions of `progress` between
// `from` and `to`. It calls `progress` in the calling thread only. In other threads it only returns
// whether the work was aborted.
std::function<bool(double)> GetPart(
  const std::function<bool(double)>& progress, double from, double to)
{
  if (!progress)
  {
    return {};
  }
  const std::thread::id thread = std::this_thread::get_id();
  const auto aborted = std::make_shared<std::atomic<bool>>(false);
  return [=](double done)
  {
    if (std::this_thread::get_id() == thread && !*aborted && !progress(from + (to - from) * done))
    {
      *aborted = true;
    }
    return !*aborted;
  };
}

// The array does not own its data.
VolumeArray MakeFloatArray(const std::vector<float>& values, double background)
{
  VolumeArray array;
  array.Data = values.data();
  array.Owner = std::shared_ptr<const void>(array.Data, [](const void*) {});
  array.Type = ElementType::Float32;
  array.Background = background;
  return array;
}

} // namespace

void WorldDeformer::UpdateRestPositions()
{
  if (this->PositionsVolume == this->Volume)
  {
    return;
  }
  std::array<float*, 3> positions;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    this->RestPositions[axis].resize(
      static_cast<std::size_t>(GetNumberOfPoints(this->Volume->PointExtent)));
    positions[axis] = this->RestPositions[axis].data();
  }
  ComputeWorldPositions(*this->Volume, GetPositionsOrigin(*this->Volume), positions);
  this->PositionsVolume = this->Volume;
}

void WorldDeformer::UpdateJacobians(const std::function<bool(double)>& progress)
{
  this->Jacobians.resize(static_cast<std::size_t>(GetNumberOfPoints(this->Volume->PointExtent)));
  const HiddenTetrahedra hidden{ this->Masks.Blanked, this->Masks.BlankedBits,
    this->Masks.ActiveTetrahedra, this->Masks.CutTetrahedra };
  if (!this->IsMesh())
  {
    ComputeFieldJacobians(this->GetVoxelGrid(), this->Field.GetField(this->Outside),
      this->Field.GetUndefinedPoints(), hidden, this->Jacobians.data());
    return;
  }
  this->Ratios.resize(this->HasDensities() ? this->Jacobians.size() : 0);
  float* const ratios = this->Ratios.empty() ? nullptr : this->Ratios.data();
  const MeshAtRest mesh = this->Mesh.GetMeshAtRest();
  const MappedVolume mapped = this->GetMapped();
  if (this->MeshJacobiansVersion != this->Mapping.GetVersion() ||
    !this->Mapping.IsCurrent(mesh, mapped))
  {
    this->Mapping.Update(mesh, mapped, progress);
    this->MeshJacobians.SetMapping(
      mapped.Part, mapped.Whole.Spacing, this->Mapping.GetMapping(), mesh.Points, mesh.Tetrahedra);
    this->MeshJacobiansVersion = this->Mapping.GetVersion();
  }
  this->MeshJacobians.Compute(this->ToOutput, mesh.Points, mesh.Tetrahedra,
    this->Mesh.GetNodeDisplacements(), hidden, this->Jacobians.data(), ratios);
}

bool WorldDeformer::HasDensities() const
{
  return std::any_of(this->Arrays.begin(), this->Arrays.end(),
    [](const WorldArray& array) { return array.IsDensity; });
}

VolumeArray WorldDeformer::GetSource(std::size_t array)
{
  VolumeArray source = this->Arrays[array];
  if (!this->Arrays[array].IsDensity)
  {
    return source;
  }
  const std::int64_t voxels = GetNumberOfPoints(this->Volume->PointExtent);
  this->DensityCopies.resize(this->Arrays.size());
  std::vector<unsigned char>& copy = this->DensityCopies[array];
  DispatchElementType(source.Type,
    [&](auto zero)
    {
      using Source = decltype(zero);
      using Value = std::conditional_t<std::is_same_v<Source, double>, double, float>;
      const auto count = static_cast<std::size_t>(voxels * source.Components);
      copy.resize(count * sizeof(Value));
      auto* values = reinterpret_cast<Value*>(copy.data());
      const auto* first = static_cast<const Source*>(source.Data);
      std::transform(
        first, first + count, values, [](Source value) { return static_cast<Value>(value); });
      if (!this->IsInverse())
      {
        const std::vector<float>& divisors = this->IsMesh() ? this->Ratios : this->Jacobians;
        DivideByJacobian(values, source.Components, divisors.data(), nullptr, voxels);
      }
      source.Type = std::is_same_v<Value, double> ? ElementType::Float64 : ElementType::Float32;
    });
  source.Data = copy.data();
  return source;
}

std::vector<VolumeArray> WorldDeformer::MakeArrays(
  const WorldRequest& request, const std::function<bool(double)>& progress)
{
  if (this->ResamplesJacobians(request))
  {
    this->UpdateJacobians(progress);
  }
  std::vector<VolumeArray> arrays;
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    arrays.push_back(this->GetSource(i));
  }
  if (request.RestPositions)
  {
    this->UpdateRestPositions();
    for (const std::vector<float>& positions : this->RestPositions)
    {
      arrays.push_back(MakeFloatArray(positions, request.Background));
    }
  }
  if (this->ResamplesJacobians(request))
  {
    arrays.push_back(MakeFloatArray(this->Jacobians, request.Background));
  }
  if (this->ResamplesJacobians(request) || this->HasDensities())
  {
    ++this->ArraysVersion; // the values have changed
  }
  for (VolumeArray& array : arrays)
  {
    // Additional arrays are never categorical.
    const auto index = static_cast<std::size_t>(&array - arrays.data());
    array.Categorical |= request.IsNearest && index < this->Arrays.size();
  }
  return arrays;
}

void WorldDeformer::CheckMemory(
  const std::vector<VolumeArray>& arrays, const Extent& extent, Resampling method)
{
  // The caller has already allocated the output.
  std::uint64_t heldBytes = 0;
  for (const VolumeArray& array : arrays)
  {
    heldBytes += GetTupleSize(array);
  }
  heldBytes = (heldBytes + 1) * static_cast<std::uint64_t>(GetNumberOfPoints(extent));
  this->Session.CheckMemory(this->GetVoxelGrid(), arrays, extent, heldBytes, this->GetDeformation(),
    this->Mapping, this->GetMapped(), method);
}

Resampling WorldDeformer::ChooseMethod(
  const WorldRequest& request, const std::vector<VolumeArray>& arrays, const Extent& whole)
{
  ResamplerRequest choice;
  choice.Outside = this->Outside;
  choice.HasSmoothCut = this->Masks.CutTetrahedra != nullptr;
  choice.NeedsJacobian = request.Jacobians != nullptr || this->HasDensities();
  choice.CountsFolds = request.FoldCounts != nullptr;
  return ChooseResampler(this->GetDeformation(), choice,
    [&](Resampling method) { this->CheckMemory(arrays, whole, method); });
}

void WorldDeformer::SendMasks()
{
  WorldMasks masks = this->Masks;
  Stamp stamp{ { nullptr, this->MasksVersion } };
  std::vector<unsigned char> blanked;
  if (!this->IsMesh() && !this->IsInverse() && !this->Field.GetUndefinedPoints().empty())
  {
    stamp.emplace_back(nullptr, this->Field.GetVectorsVersion());
    if (stamp != this->Session.GetMasksStamp())
    {
      blanked = this->Field.FindUndefinedVoxels(
        this->Volume->PointExtent, this->Outside, masks.Blanked, masks.BlankedBits);
      masks.Blanked = blanked.data();
      masks.BlankedBits = 1;
    }
  }
  this->Session.SetMasks(masks, stamp);
}

void WorldDeformer::Send(const std::vector<VolumeArray>& arrays, Resampling method,
  const std::function<bool(double)>& progress)
{
  Stamp stamp{ { nullptr, this->ArraysVersion } };
  for (const VolumeArray& array : arrays)
  {
    stamp.emplace_back(array.Data, static_cast<std::uint64_t>(array.Type));
    stamp.emplace_back(nullptr, static_cast<std::uint64_t>(array.Components));
  }
  this->Session.SetVoxelGrid(this->GetVoxelGrid(), arrays, method);
  this->Session.SetArrays(arrays, stamp);
  this->SendMasks();
  this->Session.SetDeformation(
    this->GetDeformation(), this->Mapping, this->GetMapped(), method, false, progress);
}

DeformRequest WorldDeformer::MakeRequest(
  const WorldRequest& request, const Extent& whole, Resampling method)
{
  DeformRequest made = static_cast<const DeformRequest&>(request);
  made.Method = method;
  made.OutputExtent = GetNumberOfPoints(request.OutputExtent) > 0 ? request.OutputExtent : whole;
  made.WholeOutputExtent = whole;
  if (!Contains(whole, made.OutputExtent))
  {
    throw Error("The extent " + DescribeExtent(made.OutputExtent) +
      " was asked for, which is not within that of the output, " + DescribeExtent(whole) + ".");
  }
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(made.OutputExtent));
  for (std::size_t axis = 0; axis < 3 && request.RestPositions; ++axis)
  {
    this->PositionsOutput[axis].resize(voxels);
    made.Outputs.push_back(this->PositionsOutput[axis].data());
  }
  if (this->HasDensities() && !request.Jacobians)
  {
    this->JacobiansOutput.resize(voxels);
  }
  if (this->ResamplesJacobians(request))
  {
    made.Outputs.push_back(request.Jacobians ? request.Jacobians : this->JacobiansOutput.data());
  }
  if (request.FoldCounts)
  {
    std::fill_n(request.FoldCounts, voxels, 0U);
  }
  if (request.Incremental && this->LastOutputs == request.Outputs &&
    this->LastCoverage == request.Coverage && this->LastExtent == made.OutputExtent)
  {
    made.LastOutputs.assign(request.Outputs.begin(), request.Outputs.end());
    made.LastCoverage = request.Coverage;
  }
  made.Progress = GetPart(request.Progress, 0.3, 1.0);
  return made;
}

WorldReport WorldDeformer::Deform(const WorldRequest& request)
{
  if (this->Arrays.empty() && !request.RestPositions && !request.Jacobians)
  {
    throw Error("The volume has no arrays. Set at least one.");
  }
  if (request.Outputs.size() != this->Arrays.size())
  {
    throw Error("There is room for " + std::to_string(request.Outputs.size()) +
      " arrays of the output, but the volume has " + std::to_string(this->Arrays.size()) +
      ". Give room for each.");
  }
  const bool hasDensities = this->HasDensities();
  if (request.Incremental &&
    (request.RestPositions || request.Jacobians || request.FoldCounts || hasDensities))
  {
    throw Error("Rest positions, Jacobians, fold counts and densities are made of the whole "
                "output. Ask for them, or for an incremental update.");
  }
  if (request.IsNearest && hasDensities)
  {
    throw Error("With the nearest voxel's value all arrays count as categorical, and labels cannot "
                "be divided by the Jacobian. Choose another interpolation, or give no densities.");
  }
  WorldReport report;
  report.Device = this->Session.SetDevice(this->DeviceRequest, this->MemoryLimit);
  this->UpdateDeformation();
  const Extent whole = this->FindWholeExtent();
  const auto progress = GetPart(request.Progress, 0.0, 0.3);
  const std::vector<VolumeArray> arrays = this->MakeArrays(request, progress);
  report.Method = this->ChooseMethod(request, arrays, whole);
  DeformRequest made = this->MakeRequest(request, whole, report.Method);
  this->CheckMemory(arrays, made.OutputExtent, report.Method);
  this->Send(arrays, report.Method, progress);
  if (made.Progress && !made.Progress(0.0))
  {
    throw Aborted();
  }
  this->LastOutputs.clear();
  static_cast<DeformReport&>(report) = this->Session.Deform(made);
  if (request.Incremental)
  {
    this->LastOutputs = request.Outputs;
    this->LastCoverage = request.Coverage;
    this->LastExtent = made.OutputExtent;
  }
  this->Finish(request, made.OutputExtent);
  this->Describe(request, whole, report);
  return report;
}

void WorldDeformer::Finish(const WorldRequest& request, const Extent& extent)
{
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(extent));
  const glm::dvec3 origin =
    request.RestPositions ? GetPositionsOrigin(*this->Volume) : glm::dvec3(0.0);
  for (std::size_t axis = 0; axis < 3 && request.RestPositions; ++axis)
  {
    std::vector<float>& values = this->PositionsOutput[axis];
    const double first = origin[static_cast<int>(axis)];
    for (std::size_t i = 0; i < voxels; ++i)
    {
      request.RestPositions[3 * i + axis] = first == 0.0 || !request.Coverage[i]
        ? values[i]
        : static_cast<float>(first + static_cast<double>(values[i]));
    }
    std::vector<float>().swap(values);
  }
  const bool hasDensities = this->HasDensities();
  float* const jacobians = request.Jacobians ? request.Jacobians : this->JacobiansOutput.data();
  if ((request.Jacobians || hasDensities) && this->IsInverse())
  {
    ComputeInverseFieldJacobians(extent, this->Field.GetField(this->Outside), jacobians);
    for (std::size_t i = 0; i < voxels; ++i)
    {
      jacobians[i] = request.Coverage[i] ? jacobians[i] : ClampTo<float>(request.Background);
    }
  }
  this->NumberOfLostVoxels = 0;
  if (hasDensities)
  {
    this->FinishDensities(request, jacobians, static_cast<std::int64_t>(voxels));
    std::vector<float>().swap(this->JacobiansOutput);
  }
  for (std::size_t i = 0; i < voxels && request.FoldCounts; ++i)
  {
    // If nothing overlaps, the resampler does not count.
    request.FoldCounts[i] = std::max(request.FoldCounts[i], request.Coverage[i] ? 1U : 0U);
  }
}

void WorldDeformer::FinishDensities(
  const WorldRequest& request, const float* jacobians, std::int64_t voxels)
{
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    const WorldArray& array = this->Arrays[i];
    const auto finish = [&](auto* values)
    {
      using Value = std::remove_pointer_t<decltype(values)>;
      if (this->IsInverse())
      {
        DivideByJacobian(values, array.Components, jacobians, request.Coverage, voxels);
      }
      this->NumberOfLostVoxels = ClearInverted(values, array.Components, jacobians,
        request.Coverage, voxels, ClampTo<Value>(array.Background));
    };
    if (array.IsDensity && array.Type == ElementType::Float64)
    {
      finish(static_cast<double*>(request.Outputs[i]));
    }
    else if (array.IsDensity)
    {
      finish(static_cast<float*>(request.Outputs[i]));
    }
  }
}

void WorldDeformer::Describe(const WorldRequest& request, const Extent& whole, WorldReport& report)
{
  const bool isRasterized = report.Method == Resampling::MeshRasterization;
  if (this->IsInverse())
  {
    report.NumberOfInvertedTetrahedra = CountInvertedTetrahedra(this->Field.GetField(false));
  }
  if (!isRasterized)
  {
    report.NumberOfFlatTetrahedra = this->IsMesh() ? this->Mapping.GetNumberOfFlatTetrahedra() : 0;
  }
  const auto warn = [&](const std::string& warning)
  {
    if (!warning.empty())
    {
      report.Warnings += (report.Warnings.empty() ? "" : " ") + warning;
    }
  };
  if (report.NumberOfOverstretchedCells > 0)
  {
    warn(std::to_string(report.NumberOfOverstretchedCells) +
      " cells of the volume have a tetrahedron that is stretched over more than 4,000 output "
      "voxels; these tetrahedra are skipped. Check the deformation, or set a greater output "
      "spacing.");
  }
  if (request.RestPositions)
  {
    warn(GetRoundingWarning(*this->Volume));
  }
  if (this->IsMesh() && !this->Outside.AreExtrapolated())
  {
    warn(GetSizeWarning(this->Mesh.GetMeshAtRest(), *this->Volume));
  }
  else if (!this->IsMesh() && this->Deformation != Deformations::None)
  {
    warn(GetSizeWarning(this->Field.GetGrid(), *this->Volume, this->Outside,
      [&] { return this->Field.GetField(this->Outside); }));
  }
  if (this->IsMesh())
  {
    const MeshCells& cells = this->Mesh.GetCells();
    for (const std::string& warning : GetCellWarnings(cells.Ignored, cells.WrongOrder))
    {
      warn(warning);
    }
    const MeshAtRest mesh = this->Mesh.GetMeshAtRest();
    if (this->Mesh.ArePointsFloats() && !this->Outside.AreExtrapolated())
    {
      warn(GetRoundingWarning(mesh, *this->Volume));
    }
    const WorldMasks& masks = this->Masks;
    if (!isRasterized && !masks.Blanked && !masks.ActiveTetrahedra && !masks.CutTetrahedra)
    {
      this->Splits.Update(mesh, this->Outside.AreDiscarded());
      const std::string split =
        this->Splits.Describe(this->Mesh.GetNodeDisplacements(), this->Volume->PointExtent);
      warn(split.empty() ? "" : split + " Cut the volume along the split, or merge these nodes.");
    }
    if (!isRasterized && this->Mapping.IsCurrent(mesh, this->GetMapped()))
    {
      warn(DescribeOverlap(this->Mapping.GetMapping()));
    }
    const FadedLinks& links = this->Mapping.GetMapping().Faded;
    if (!links.IsEmpty() && this->Mapping.IsCurrent(mesh, this->GetMapped()))
    {
      warn(GetFadingWarning(links, mesh.Tetrahedra, this->Mesh.GetNodeDisplacements(),
        this->GetOutputGrid().Spacing, this->Outside.FadeDistance, masks));
    }
  }
  else if (this->Outside.AreKept())
  {
    const Extent& moved = this->Field.IsInverseField() ? whole : this->Volume->PointExtent;
    warn(GetFadingWarning(this->Field.GetField(this->Outside), GetBox(moved),
      glm::abs(this->GetOutputGrid().Spacing), this->Outside.FadeDistance));
  }
  if (this->HasDensities())
  {
    warn(DescribeLoss(report.NumberOfHiddenSamples, report.NumberOfCoveredVoxels,
      this->NumberOfLostVoxels, "their background"));
  }
  const bool isWhole =
    GetNumberOfPoints(request.OutputExtent) == 0 || request.OutputExtent == whole;
  if (report.NumberOfCoveredVoxels == 0 && isWhole)
  {
    warn(this->IsInverse()
        ? "The inverse displacement field leads from no voxel of the output to the volume: all of "
          "the output is background. Check that the field holds points of the output, that its "
          "vectors lead from there to the volume, and that all are in the same world coordinates."
        : std::string("The deformed volume covers no voxel of the output: all of it is background. "
                      "Check the grid of the output") +
          (this->Deformation == Deformations::None ? "."
              : this->IsMesh()
              ? ", and that the deformation mesh holds neighboring voxels of the volume."
              : ", and that the displacement field holds neighboring voxels of the volume on each "
                "axis. A field of one slice does not."));
  }
}

} // namespace deformvolume
