// SPDX-License-Identifier: BSD-3-Clause
// WorldDeformer: deforms the volume for a request.
#include "WorldDeformer.h"

#include "Background.h"
#include "Densities.h"
#include "Fading.h"
#include "FieldFolds.h"
#include "MemoryError.h"
#include "MemoryNeeds.h"
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

bool AreSame(const std::vector<VolumeArray>& first, const std::vector<VolumeArray>& second)
{
  return std::equal(first.begin(), first.end(), second.begin(), second.end(),
    [](const VolumeArray& a, const VolumeArray& b)
    { return a.Data == b.Data && a.Type == b.Type && a.Components == b.Components; });
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

void WorldDeformer::Forget()
{
  this->Sent = SentData();
  this->LastOutputs.clear();
  this->LastCoverage = nullptr;
}

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
  if (!this->IsMesh())
  {
    ComputeFieldJacobians(
      this->GetVoxelGrid(), this->Field.GetField(this->Outside), {}, this->Jacobians.data());
    return;
  }
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
    this->Mesh.GetNodeDisplacements(), this->Jacobians.data());
}

bool WorldDeformer::HasDensities() const
{
  return std::any_of(this->Arrays.begin(), this->Arrays.end(),
    [](const WorldArray& array) { return array.IsDensity; });
}

VolumeArray WorldDeformer::GetSource(std::size_t array)
{
  VolumeArray source = this->Arrays[array];
  if (!this->Arrays[array].IsDensity || source.Type == ElementType::Float32 ||
    source.Type == ElementType::Float64)
  {
    return source;
  }
  this->DensityCopies.resize(this->Arrays.size());
  std::vector<float>& copy = this->DensityCopies[array];
  if (copy.empty())
  {
    const auto values = static_cast<std::size_t>(GetNumberOfPoints(this->Volume->PointExtent)) *
      static_cast<std::size_t>(source.Components);
    copy.resize(values);
    switch (source.Type)
    {
#define DEFORMVOLUME_CASE(name, type, cl)                                                          \
  case ElementType::name:                                                                          \
    std::transform(static_cast<const type*>(source.Data),                                          \
      static_cast<const type*>(source.Data) + values, copy.begin(),                                \
      [](type value) { return static_cast<float>(value); });                                       \
    break;
      DEFORMVOLUME_ELEMENT_TYPES(DEFORMVOLUME_CASE)
#undef DEFORMVOLUME_CASE
    }
  }
  VolumeArray floats = MakeFloatArray(copy, source.Background);
  floats.Components = source.Components;
  return floats;
}

std::vector<VolumeArray> WorldDeformer::MakeArrays(
  const WorldRequest& request, const std::function<bool(double)>& progress)
{
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
    this->UpdateJacobians(progress);
    arrays.push_back(MakeFloatArray(this->Jacobians, request.Background));
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
  const VoxelGrid voxelGrid = this->GetVoxelGrid();
  const bool isMesh = this->IsMesh();
  const std::size_t tetrahedra = isMesh ? this->Mesh.GetMeshAtRest().Tetrahedra.size() : 0;
  const std::size_t nodes = isMesh
    ? this->Mesh.GetMeshAtRest().Points.size()
    : static_cast<std::size_t>(GetNumberOfPoints(this->Field.GetFieldShape(this->Outside)));
  // The caller has already allocated the output.
  std::uint64_t heldBytes = 0;
  for (const VolumeArray& array : arrays)
  {
    heldBytes += GetTupleSize(array);
  }
  heldBytes = (heldBytes + 1) * static_cast<std::uint64_t>(GetNumberOfPoints(extent));
  const bool isRasterized = method == Resampling::MeshRasterization;
  const std::uint64_t runBytes = isMesh && !isRasterized
    ? this->Mapping.GetRunBytes(this->Mesh.GetMeshAtRest(), this->GetMapped())
    : 0;
  const std::uint64_t mapping = isRasterized ? 0 : GetMappingBytes(voxelGrid, !isMesh, runBytes);
  this->Deformer.CheckMemory(
    { voxelGrid, arrays, extent, nodes, tetrahedra, mapping, isRasterized }, heldBytes);
}

Resampling WorldDeformer::ChooseMethod(
  const WorldRequest& request, const std::vector<VolumeArray>& arrays, const Extent& whole)
{
  ResamplerRequest choice;
  using Kinds = ResamplerRequest::Kinds;
  choice.Deformation = this->IsMesh() ? Kinds::Mesh
    : this->Field.IsInverseField()    ? Kinds::InverseField
                                      : Kinds::ForwardField;
  choice.Outside = this->Outside;
  choice.HasSmoothCut = this->Masks.CutTetrahedra != nullptr;
  choice.NeedsJacobian = request.Jacobians != nullptr || this->HasDensities();
  choice.CountsFolds = request.FoldCounts != nullptr;
  return ChooseResampler(choice,
    [&](Resampling method)
    {
      try
      {
        this->CheckMemory(arrays, whole, method);
        return true;
      }
      catch (const MemoryError&)
      {
        return false;
      }
    });
}

void WorldDeformer::SendVolume(const std::vector<VolumeArray>& arrays, Resampling method)
{
  const bool links = method != Resampling::MeshRasterization;
  std::size_t widest = 0;
  for (const VolumeArray& array : arrays)
  {
    widest = std::max(widest, GetTupleSize(array));
  }
  const VoxelGrid voxelGrid = this->GetVoxelGrid();
  if (this->Sent.Grid.VertexExtent != voxelGrid.VertexExtent ||
    this->Sent.Grid.ToOutput != voxelGrid.ToOutput || this->Sent.Width < widest ||
    this->Sent.ForLinks != links)
  {
    this->Forget();
    this->Deformer.SetVoxelGrid(voxelGrid, widest, links);
    this->Sent.Grid = voxelGrid;
    this->Sent.Width = widest;
    this->Sent.ForLinks = links;
  }
  if (this->Sent.ArraysVersion != this->ArraysVersion || !AreSame(this->Sent.Arrays, arrays))
  {
    this->Deformer.SetArrays(arrays);
    this->Sent.Arrays = arrays;
    this->Sent.ArraysVersion = this->ArraysVersion;
    this->LastOutputs.clear();
  }
  this->Deformer.SetArrayOptions(arrays);
  if (this->Sent.MasksVersion != this->MasksVersion)
  {
    this->Deformer.SetBlanked(this->Masks.Blanked);
    this->Deformer.SetActiveTetrahedra(this->Masks.ActiveTetrahedra);
    this->Deformer.SetBoundaryDistances(this->Masks.BoundaryDistances);
    this->Deformer.SetCut(this->Masks.CutTetrahedra, this->Masks.CutDistances);
    this->Sent.MasksVersion = this->MasksVersion;
  }
}

void WorldDeformer::SendMesh(const std::function<bool(double)>& progress)
{
  const MeshAtRest mesh = this->Mesh.GetMeshAtRest();
  const MappedVolume mapped = this->GetMapped();
  const bool isSent = this->Sent.Deformation == Deformations::Mesh &&
    !this->Sent.ForRasterization && this->Sent.Shape == this->Mapping.GetVersion() &&
    this->Mapping.IsCurrent(mesh, mapped);
  if (!isSent)
  {
    this->Mapping.Update(mesh, mapped, progress);
    const StaticMapping& mapping = this->Mapping.GetMapping();
    const std::vector<Tetrahedron>* tetrahedra = &mesh.Tetrahedra;
    std::size_t nodes = mesh.Points.size();
    this->HasFadedMesh = !mapping.Faded.IsEmpty();
    if (this->HasFadedMesh)
    {
      this->Faded.Set(mapping.Faded, *tetrahedra, nodes);
      tetrahedra = &this->Faded.GetTetrahedra();
      nodes = this->Faded.GetNumberOfNodes();
    }
    if (this->Mapping.IsByRuns())
    {
      this->Deformer.SetMesh(
        tetrahedra->data(), tetrahedra->size(), nodes, mapping.Runs, &mapping.Boundary);
    }
    else
    {
      this->Deformer.SetMesh(
        tetrahedra->data(), tetrahedra->size(), nodes, mapping.Links.data(), &mapping.Boundary);
    }
    this->Sent.Shape = this->Mapping.GetVersion();
  }
  if (!this->Outside.AreExtrapolated())
  {
    // Links or runs are needed again only for the bounds of an extrapolated deformation.
    this->Mapping.ReleaseVoxels();
  }
  if (!isSent || this->Sent.Vectors != this->Mesh.GetVectorsVersion())
  {
    const float* displacements = this->Mesh.GetNodeDisplacements();
    if (this->HasFadedMesh)
    {
      this->Faded.Move(displacements, mesh.Points.size(), nullptr);
      displacements = this->Faded.GetDisplacements().data();
    }
    this->Deformer.SetNodeDisplacements(displacements, nullptr, true);
  }
  this->Sent.Vectors = this->Mesh.GetVectorsVersion();
  this->Sent.Deformation = Deformations::Mesh;
  this->Sent.ForRasterization = false;
}

void WorldDeformer::SendRestMesh()
{
  const MeshAtRest mesh = this->Mesh.GetMeshAtRest();
  CheckBoxes(mesh, *this->Volume);
  const bool isSent = this->Sent.Deformation == Deformations::Mesh && this->Sent.ForRasterization &&
    this->Sent.Shape == mesh.ShapeVersion;
  if (!isSent)
  {
    this->Deformer.SetRestMesh(
      mesh.Tetrahedra.data(), mesh.Tetrahedra.size(), mesh.Points.size(), &mesh.Points.front().x);
  }
  if (!isSent || this->Sent.Vectors != this->Mesh.GetVectorsVersion())
  {
    this->Deformer.SetNodeDisplacements(this->Mesh.GetNodeDisplacements(), nullptr, true);
  }
  this->Sent.Shape = mesh.ShapeVersion;
  this->Sent.Vectors = this->Mesh.GetVectorsVersion();
  this->Sent.Deformation = Deformations::Mesh;
  this->Sent.ForRasterization = true;
}

void WorldDeformer::SendField()
{
  if (this->Sent.Deformation == Deformations::Field &&
    this->Sent.Vectors == this->Field.GetVectorsVersion() && this->Sent.Outside == this->Outside)
  {
    return;
  }
  const std::shared_ptr<DeviceVectors>& shared = this->Field.GetDeviceVectors();
  if (shared && shared->GetDevice() == this->Device)
  {
    this->Deformer.SetDisplacementField(this->Field.GetFieldShape(this->Outside), shared);
  }
  else if (this->Field.IsInverseField())
  {
    this->Deformer.SetInverseField(this->Field.GetField(this->Outside));
  }
  else
  {
    this->Deformer.SetDisplacementField(this->Field.GetField(this->Outside));
  }
  this->Sent.Deformation = Deformations::Field;
  this->Sent.Vectors = this->Field.GetVectorsVersion();
  this->Sent.Outside = this->Outside;
}

DeformRequest WorldDeformer::MakeRequest(
  const WorldRequest& request, const Extent& whole, Resampling method)
{
  DeformRequest made;
  made.Method = method;
  made.Interpolation = request.Interpolation;
  made.OutputExtent = GetNumberOfPoints(request.OutputExtent) > 0 ? request.OutputExtent : whole;
  made.WholeOutputExtent = whole;
  if (!Contains(whole, made.OutputExtent))
  {
    throw Error("The extent " + DescribeExtent(made.OutputExtent) +
      " was asked for, which is not within that of the output, " + DescribeExtent(whole) + ".");
  }
  made.Outputs = request.Outputs;
  made.Coverage = request.Coverage;
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
    made.FoldCounts = request.FoldCounts;
  }
  made.Incremental = request.IsIncremental;
  if (request.IsIncremental && this->LastOutputs == request.Outputs &&
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
  if (request.IsIncremental &&
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
  report.Device = this->Deformer.SetDevice(this->DeviceRequest);
  if (!this->Known || report.Device != this->Device)
  {
    this->Forget();
  }
  this->Device = report.Device;
  this->Known = false; // until this call has succeeded
  this->UpdateDeformation();
  const Extent whole = this->FindWholeExtent();
  const auto progress = GetPart(request.Progress, 0.0, 0.3);
  const std::vector<VolumeArray> arrays = this->MakeArrays(request, progress);
  report.Method = this->ChooseMethod(request, arrays, whole);
  DeformRequest made = this->MakeRequest(request, whole, report.Method);
  this->CheckMemory(arrays, made.OutputExtent, report.Method);
  this->SendVolume(arrays, report.Method);
  if (!this->IsMesh())
  {
    this->SendField();
  }
  else if (report.Method == Resampling::MeshRasterization)
  {
    this->SendRestMesh();
  }
  else
  {
    this->SendMesh(progress);
  }
  if (made.Progress && !made.Progress(0.0))
  {
    this->Known = true; // all data were sent
    throw Aborted();
  }
  this->LastOutputs.clear();
  static_cast<DeformReport&>(report) = this->Deformer.Deform(made);
  this->Known = true;
  if (request.IsIncremental)
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
    this->DivideDensities(request, jacobians, static_cast<std::int64_t>(voxels));
    std::vector<float>().swap(this->JacobiansOutput);
  }
  for (std::size_t i = 0; i < voxels && request.FoldCounts; ++i)
  {
    // If nothing overlaps, the resampler does not count.
    request.FoldCounts[i] = std::max(request.FoldCounts[i], request.Coverage[i] ? 1U : 0U);
  }
}

void WorldDeformer::DivideDensities(
  const WorldRequest& request, const float* jacobians, std::int64_t voxels)
{
  for (std::size_t i = 0; i < this->Arrays.size(); ++i)
  {
    const WorldArray& array = this->Arrays[i];
    const auto divide = [&](auto* values)
    {
      using Value = std::remove_pointer_t<decltype(values)>;
      this->NumberOfLostVoxels = DivideByJacobian(values, array.Components, jacobians,
        request.Coverage, voxels, ClampTo<Value>(array.Background), values);
    };
    if (array.IsDensity && array.Type == ElementType::Float64)
    {
      divide(static_cast<double*>(request.Outputs[i]));
    }
    else if (array.IsDensity)
    {
      divide(static_cast<float*>(request.Outputs[i]));
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
  if (this->Deformation != Deformations::None && !this->Outside.AreExtrapolated())
  {
    warn(this->IsMesh() ? GetSizeWarning(this->Mesh.GetMeshAtRest(), *this->Volume)
                        : GetSizeWarning(this->Field.GetGrid(), *this->Volume));
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
      this->Splits.Update(mesh);
      const std::string split =
        this->Splits.Describe(this->Mesh.GetNodeDisplacements(), this->Volume->PointExtent);
      warn(split.empty() ? "" : split + " Cut the volume along the split, or merge these nodes.");
    }
    const FadedLinks& links = this->Mapping.GetMapping().Faded;
    if (!links.IsEmpty() && this->Mapping.IsCurrent(mesh, this->GetMapped()))
    {
      warn(GetFadingWarning(links, mesh.Tetrahedra, this->Mesh.GetNodeDisplacements(),
        this->GetOutputGrid().Spacing, this->Outside.FadeDistance));
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
        : "The deformed volume covers no voxel of the output: all of it is background. Check the "
          "grid of the output, and that the deformation mesh holds neighboring voxels of the "
          "volume.");
  }
}

} // namespace deformvolume
