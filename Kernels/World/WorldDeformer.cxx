// SPDX-License-Identifier: BSD-3-Clause
#include "WorldDeformer.h"

#include "DeformedBounds.h"
#include "Error.h"
#include "FieldGeometry.h"
#include "LookupBounds.h"
#include "MeshBounds.h"
#include "OutputExtent.h"
#include "WorldBoxes.h"

#include <algorithm>
#include <cmath>

namespace deformvolume
{

WorldDeformer::WorldDeformer() = default;
WorldDeformer::~WorldDeformer() = default;

std::string WorldDeformer::SetDevice(const std::string& request)
{
  const std::string name = this->Session.SetDevice(request, this->MemoryLimit);
  this->DeviceRequest = request;
  return name;
}

void WorldDeformer::SetMemoryLimit(std::uint64_t bytes)
{
  this->MemoryLimit = bytes;
}

void WorldDeformer::SetVolume(const ImageGeometry& volume)
{
  CheckVolume(volume);
  GetPadded(volume.PointExtent, 0); // checks the size
  if (this->Volume != volume)
  {
    this->Volume = volume;
    this->SetArrays({});
    this->SetMasks({});
  }
}

void WorldDeformer::SetArrays(const std::vector<WorldArray>& arrays)
{
  for (const WorldArray& array : arrays)
  {
    if (array.IsDensity && array.Categorical)
    {
      throw Error("Array " + std::to_string(&array - arrays.data()) +
        " is a density and categorical, and labels cannot be divided by the Jacobian. Give it as "
        "one of both.");
    }
  }
  this->Arrays = arrays;
  ++this->ArraysVersion;
}

void WorldDeformer::SetMasks(const WorldMasks& masks)
{
  this->Masks = masks;
  ++this->MasksVersion;
}

void WorldDeformer::SetMesh(const VectorView& points, MeshCells&& cells)
{
  this->Mesh.Set(points, std::move(cells));
  this->Deformation = Deformations::Mesh;
}

void WorldDeformer::SetNodeVectors(const VectorView& vectors)
{
  if (this->Deformation != Deformations::Mesh)
  {
    throw Error("There is no deformation mesh. Set one before its displacements.");
  }
  this->Mesh.SetVectors(vectors);
}

void WorldDeformer::SetField(const ImageGeometry& grid, const VectorView& vectors, bool isInverse,
  const unsigned char* undefined)
{
  this->Field.Set(grid, vectors, isInverse, undefined);
  this->Deformation = Deformations::Field;
}

void WorldDeformer::SetField(
  const ImageGeometry& grid, const std::shared_ptr<DeviceVectors>& vectors)
{
  this->Field.Set(grid, vectors);
  this->Deformation = Deformations::Field;
}

void WorldDeformer::SetOutside(const OutsideVoxels& outside)
{
  if (!(this->Outside == outside) && !this->Field.GetUndefinedPoints().empty())
  {
    ++this->MasksVersion; // which voxels depend on undefined points has changed
  }
  this->Outside = outside;
}

void WorldDeformer::SetReference(const std::optional<ImageGeometry>& reference)
{
  if (reference)
  {
    if (GetNumberOfPoints(reference->PointExtent) == 0)
    {
      throw Error("The reference grid is empty: its extent is " +
        DescribeExtent(reference->PointExtent) + ". Give one with voxels.");
    }
    CheckTransform(*reference, "the reference grid");
    GetPadded(reference->PointExtent, 0); // checks the size
  }
  this->Reference = reference;
}

void WorldDeformer::SetOutput(const OutputSettings& settings)
{
  for (int axis = 0; axis < 3 && settings.Spacing; ++axis)
  {
    const double spacing = (*settings.Spacing)[axis];
    if (!std::isfinite(spacing) || spacing <= 0.0)
    {
      throw Error(std::string("The output spacing is ") + FormatNumber(spacing) + " on axis " +
        "xyz"[axis] + ". Set a spacing greater than 0.");
    }
  }
  constexpr int mostPadding = 1 << 20;
  if (settings.Padding < -mostPadding || settings.Padding > mostPadding)
  {
    throw Error("The padding is " + std::to_string(settings.Padding) +
      " voxels. Set one between -2^20 and 2^20.");
  }
  this->Settings = settings;
}

ImageGeometry WorldDeformer::FindOutput()
{
  this->UpdateDeformation();
  ImageGeometry output = this->GetOutputGrid();
  output.PointExtent = this->FindWholeExtent();
  return output;
}

std::uint64_t WorldDeformer::GetDeviceMemory() const
{
  return this->Session.GetDeviceMemory();
}

void WorldDeformer::ReleaseMemory()
{
  this->Session.ReleaseMemory();
}

ImageGeometry WorldDeformer::GetOutputGrid() const
{
  if (this->Reference)
  {
    return *this->Reference;
  }
  ImageGeometry output = *this->Volume;
  output.PointExtent = ImageGeometry().PointExtent;
  for (int axis = 0; axis < 3 && this->Settings.Spacing; ++axis)
  {
    // The sign of the volume's spacing is kept.
    output.Spacing[axis] =
      std::copysign((*this->Settings.Spacing)[axis], this->Volume->Spacing[axis]);
  }
  return output;
}

void WorldDeformer::UpdateDeformation()
{
  if (!this->Volume)
  {
    throw Error("There is no volume. Set one first.");
  }
  if (this->Deformation == Deformations::None && this->VolumeAtRest != this->Volume)
  {
    static const std::array<float, 24> zeros{};
    this->Field.Set(GetGridAtRest(*this->Volume), { zeros.data(), false, 8 }, false);
    this->VolumeAtRest = this->Volume;
  }
  this->ToOutput = GetOutputMap(*this->Volume, this->GetOutputGrid());
  if (this->Reference)
  {
    CheckReferenceIndices(this->GetVoxelGrid(), *this->Reference);
  }
  if (!this->IsMesh())
  {
    this->Field.Update(*this->Volume, this->ToOutput);
    return;
  }
  this->Mesh.Update(*this->Volume, this->ToOutput);
}

IndexBounds WorldDeformer::FindBounds()
{
  const VoxelGrid voxelGrid{ this->Volume->PointExtent, this->ToOutput, {} };
  if (!this->IsMesh())
  {
    const std::optional<IndexBounds> known = this->Field.FindSharedBounds(this->Outside);
    if (known && !known->IsEmpty())
    {
      return *known;
    }
    const DisplacementField field = this->Field.GetField(this->Outside);
    IndexBounds bounds = this->Field.IsInverseField() ? ComputeLookupBounds(voxelGrid, field)
                                                      : ComputeDeformedBounds(voxelGrid, field);
    if (bounds.IsEmpty())
    {
      throw Error("The displacement field holds no voxel of the volume. " +
        DescribeBoxes(this->Field.GetGrid(), *this->Volume));
    }
    return bounds;
  }
  const MeshAtRest mesh = this->Mesh.GetMeshAtRest();
  const float* displacements = this->Mesh.GetNodeDisplacements();
  const MappedVolume mapped = this->GetMapped();
  if (this->Outside.AreExtrapolated())
  {
    this->Mapping.Update(mesh, mapped, {});
    return ComputeDeformedBounds(
      voxelGrid, this->Mapping.GetLinks(), mesh.Tetrahedra, displacements);
  }
  if (this->Outside.AreKept() && !this->Mapping.IsCurrent(mesh, mapped))
  {
    this->Mapping.Update(mesh, mapped, {});
  }
  IndexBounds bounds =
    ComputeDeformedBounds(voxelGrid, mesh.Points, mesh.Tetrahedra, displacements);
  if (this->Outside.AreKept())
  {
    bounds.Add(
      this->Mapping.GetMapping().Faded.ComputeBounds(voxelGrid, mesh.Tetrahedra, displacements));
  }
  if (bounds.IsEmpty())
  {
    this->Mapping.Update(mesh, mapped, {}); // throws a more exact error
    throw Error("The deformed volume has no bounds. Check the deformation mesh.");
  }
  return bounds;
}

Extent WorldDeformer::FindWholeExtent()
{
  if (this->Reference)
  {
    return this->Reference->PointExtent;
  }
  const ImageGeometry grid = this->GetOutputGrid();
  switch (this->Settings.Bounds)
  {
    case OutputSettings::BoundsModes::Volume:
      return GetPadded(
        GetExtentAround(GetVolumeBounds(*this->Volume, this->Volume->Spacing / grid.Spacing)),
        this->Settings.Padding);
    case OutputSettings::BoundsModes::Custom:
      return GetPadded(GetExtentAround(GetWorldBoxBounds(this->Settings.CustomBounds.data(), grid)),
        this->Settings.Padding);
    default:
      return GetPadded(GetExtentInside(this->FindBounds()), this->Settings.Padding);
  }
}

} // namespace deformvolume
