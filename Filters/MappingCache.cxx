// SPDX-License-Identifier: BSD-3-Clause
#include "MappingCache.h"

#include "VertexRuns.h"

#include <chrono>
#include <utility>

namespace deformvolume
{

namespace
{

// Adds the seconds of its life to a sum.
class Stopwatch
{
public:
  explicit Stopwatch(double& sum)
    : Sum(sum)
  {
  }
  ~Stopwatch()
  {
    this->Sum +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - this->Start).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

private:
  double& Sum;
  const std::chrono::steady_clock::time_point Start = std::chrono::steady_clock::now();
};

} // namespace

bool MappingCache::IsCurrent(
  const Deformation& deformation, const ImageGeometry& volume, bool extrapolate) const
{
  return this->MappingKey == Key{ &deformation, deformation.GetRestVersion(), volume, extrapolate };
}

StaticMappingBuilder& MappingCache::GetBuilder(const Deformation& deformation, const Key& key)
{
  if (!this->Builder || !(this->BuilderKey == key))
  {
    this->Builder.reset();
    this->Builder =
      std::make_unique<StaticMappingBuilder>(key.Volume.PointExtent, key.Volume.Spacing,
        deformation.GetRestPoints(), deformation.GetTetrahedra(), key.Extrapolate);
    this->BuilderKey = key;
  }
  return *this->Builder;
}

std::uint64_t MappingCache::GetRunBytes(
  const Deformation& deformation, const ImageGeometry& volume, bool extrapolate)
{
  if (deformation.IsField())
  {
    return 0;
  }
  if (this->IsCurrent(deformation, volume, extrapolate))
  {
    return this->RunBytes;
  }
  const Stopwatch stopwatch(this->Time);
  return this
    ->GetBuilder(deformation, { &deformation, deformation.GetRestVersion(), volume, extrapolate })
    .GetRunBytes();
}

void MappingCache::Update(const Deformation& deformation, const ImageGeometry& volume,
  bool extrapolate, const std::function<bool(double)>& progress)
{
  if (this->HasVoxels() && this->IsCurrent(deformation, volume, extrapolate))
  {
    return;
  }
  const Stopwatch stopwatch(this->Time);
  const std::vector<Tetrahedron>& tetrahedra = deformation.GetTetrahedra();
  if (progress && !progress(0.0))
  {
    throw Aborted();
  }
  // The old links go first, so that two sets never stand in memory.
  this->Mapping = StaticMapping();
  this->MappingKey = Key();
  const Key key{ &deformation, deformation.GetRestVersion(), volume, extrapolate };
  StaticMapping mapping = this->GetBuilder(deformation, key).Build(progress);
  this->Builder.reset();
  if (mapping.NumberOfFlatTetrahedra == static_cast<std::int64_t>(tetrahedra.size()))
  {
    throw Error("All " + std::to_string(tetrahedra.size()) +
      " tetrahedra of the deformation mesh are flat at rest. Connect a mesh with volume.");
  }
  if (mapping.NumberOfInnerVoxels == 0)
  {
    throw Error("The deformation mesh at rest holds no voxel of the volume. Check that both are "
                "in the same world coordinates and overlap, and that input port 1 or, where it is "
                "connected, port 2 has the rest configuration.");
  }
  this->Mapping = std::move(mapping);
  this->RunBytes = GetBytes(this->Mapping.Runs);
  this->MappingKey = key;
  ++this->Version;
  ++this->NumberOfBuilds;
}

void MappingCache::ReleaseVoxels()
{
  std::vector<VertexLink>().swap(this->Mapping.Links);
  this->Mapping.Runs = VertexRuns();
}

double MappingCache::TakeTime()
{
  return std::exchange(this->Time, 0.0);
}

} // namespace deformvolume
