// SPDX-License-Identifier: BSD-3-Clause
#include "MappingCache.h"

#include "Error.h"
#include "Stopwatch.h"
#include "VertexRuns.h"
#include "WorldBoxes.h"

#include <algorithm>
#include <utility>

namespace deformvolume
{

namespace
{

std::uint64_t EstimateRunBytes(const StaticMappingBuilder& builder, const MappedVolume& volume)
{
  const std::uint64_t bytes = builder.GetRunBytes();
  if (bytes == 0 || volume.IsWhole())
  {
    return bytes;
  }
  const double share = static_cast<double>(GetNumberOfPoints(volume.Part)) /
    static_cast<double>(GetNumberOfPoints(volume.Whole.PointExtent));
  return 1 + static_cast<std::uint64_t>(share * static_cast<double>(bytes));
}

// Whether a mesh ends within the volume.
bool EndsWithin(const MeshAtRest& mesh, const MappedVolume& volume)
{
  return HasMeshBoundary(volume.Whole.PointExtent, mesh.Points, mesh.Tetrahedra);
}

} // namespace

bool MappingCache::IsCurrent(const MeshAtRest& mesh, const MappedVolume& volume) const
{
  return this->MappingKey == Key{ mesh.Owner, mesh.ShapeVersion, volume };
}

StaticMappingBuilder& MappingCache::GetBuilder(const MeshAtRest& mesh, const Key& key)
{
  Key wholeKey = key;
  wholeKey.Volume.Part = key.Volume.Whole.PointExtent;
  if (!this->Builder || !(this->BuilderKey == wholeKey))
  {
    this->Builder.reset();
    const ImageGeometry& whole = key.Volume.Whole;
    this->Builder = std::make_unique<StaticMappingBuilder>(
      whole.PointExtent, whole.Spacing, mesh.Points, mesh.Tetrahedra, key.Volume.Outside);
    this->BuilderKey = wholeKey;
  }
  return *this->Builder;
}

std::uint64_t MappingCache::GetRunBytes(const MeshAtRest& mesh, const MappedVolume& volume)
{
  if (this->IsCurrent(mesh, volume))
  {
    return this->RunBytes;
  }
  const Stopwatch watch;
  const Key key{ mesh.Owner, mesh.ShapeVersion, volume };
  const std::uint64_t bytes = EstimateRunBytes(this->GetBuilder(mesh, key), volume);
  this->Time += watch.GetSeconds();
  return bytes;
}

void MappingCache::Update(
  const MeshAtRest& mesh, const MappedVolume& volume, const std::function<bool(double)>& progress)
{
  if (this->HasLinksOrRuns() && this->IsCurrent(mesh, volume))
  {
    return;
  }
  const Stopwatch watch;
  const std::vector<Tetrahedron>& tetrahedra = mesh.Tetrahedra;
  if (progress && !progress(0.0))
  {
    throw Aborted();
  }
  // Free the old links first, so that memory never holds two mappings.
  this->Mapping = StaticMapping();
  this->MappingKey = Key();
  const Key key{ mesh.Owner, mesh.ShapeVersion, volume };
  const StaticMappingBuilder& builder = this->GetBuilder(mesh, key);
  StaticMapping mapping = builder.Build(volume.Part, progress);
  const std::uint64_t runBytes = EstimateRunBytes(builder, volume);
  // The result must not depend on the part of the volume that is mapped.
  const bool holdsVoxels = mapping.NumberOfInnerVoxels > 0 || !mapping.Boundary.IsEmpty() ||
    (!volume.IsWhole() && (builder.HoldsVoxels() || EndsWithin(mesh, volume))) ||
    (volume.Outside.AreKept() && volume.Outside.FadeDistance > 0.0 && EndsWithin(mesh, volume));
  if (volume.IsWhole())
  {
    this->Builder.reset();
  }
  if (mapping.NumberOfFlatTetrahedra == static_cast<std::int64_t>(tetrahedra.size()))
  {
    throw Error("All " + std::to_string(tetrahedra.size()) +
      " tetrahedra of the deformation mesh are flat at rest. Use a mesh with volume.");
  }
  if (!holdsVoxels)
  {
    throw Error(DescribeMissedVolume(mesh, volume.Whole));
  }
  this->Mapping = std::move(mapping);
  this->RunBytes = runBytes;
  this->MappingKey = key;
  ++this->Version;
  ++this->NumberOfBuilds;
  this->Time += watch.GetSeconds();
}

void MappingCache::ReleaseVoxels()
{
  std::vector<VertexLink>().swap(this->Mapping.Links);
  this->Mapping.Runs = VertexRuns();
  this->Mapping.Boundary = MeshBoundary();
}

double MappingCache::TakeTime()
{
  return std::exchange(this->Time, 0.0);
}

} // namespace deformvolume
