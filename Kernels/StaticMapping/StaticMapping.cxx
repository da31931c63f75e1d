// SPDX-License-Identifier: BSD-3-Clause
#include "StaticMapping.h"

#include "BarycentricMap.h"
#include "Error.h"
#include "LinkExtrapolation.h"
#include "ParallelFor.h"
#include "RunBuilder.h"
#include "VertexRuns.h"
#include "VoxelLinker.h"

#include <algorithm>
#include <atomic>
#include <string>

namespace deformvolume
{

namespace
{

// Fraction of the work that is done when the tetrahedra are sorted into tiles.
constexpr double SortedFraction = 0.25;

bool FitsRuns(const Extent& voxels)
{
  return std::max({ GetSize(voxels, 0), GetSize(voxels, 1), GetSize(voxels, 2) }) <= LargestRunSize;
}

} // namespace

StaticMappingBuilder::StaticMappingBuilder(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  const OutsideVoxels& outside, StaticMappingForm form)
  : Voxels(voxels)
  , Spacing(spacing)
  , Outside(outside)
  , RestPoints(restPoints)
  , Tetrahedra(tetrahedra)
{
  if (form == StaticMappingForm::Runs && !outside.AreDiscarded())
  {
    throw Error(
      std::string("A static mapping by runs cannot have voxels outside the mesh that are ") +
      (outside.AreKept() ? "kept" : "extrapolated") +
      ". Use StaticMappingForm::Links or StaticMappingForm::Automatic.");
  }
  if (GetNumberOfPoints(voxels) > 0)
  {
    this->Linker = std::make_unique<VoxelLinker>(this->Voxels, restPoints, tetrahedra);
    this->RunBytes = this->EstimateRunBytes(form);
  }
}

StaticMappingBuilder::~StaticMappingBuilder() = default;

std::uint64_t StaticMappingBuilder::EstimateRunBytes(StaticMappingForm form) const
{
  if (form == StaticMappingForm::Links || !this->Outside.AreDiscarded() || !FitsRuns(this->Voxels))
  {
    return 0;
  }
  const RunBuilder::Sample sample =
    RunBuilder(*this->Linker, this->Voxels, this->RestPoints, this->Tetrahedra).SampleTiles();
  const std::int64_t allRows = GetSize(this->Voxels, 1) * GetSize(this->Voxels, 2);
  const double factor = static_cast<double>(allRows) / sample.Rows;
  const std::int64_t records = std::min(static_cast<std::int64_t>(this->Tetrahedra.size()),
    this->Linker->GetTiles().GetNumberOfEntries());
  const double meanLength =
    sample.Rows * static_cast<double>(GetSize(this->Voxels, 0)) / sample.Runs;
  const std::uint64_t bytes = deformvolume::GetRunBytes(
    static_cast<std::uint64_t>(factor * sample.Runs), static_cast<std::uint64_t>(allRows),
    static_cast<std::uint64_t>(records) +
      static_cast<std::uint64_t>(factor * sample.RunsOfSlivers));
  const bool worthwhile = meanLength >= LeastMeanRunLength &&
    bytes < static_cast<std::uint64_t>(GetNumberOfPoints(this->Voxels)) * sizeof(VertexLink);
  return worthwhile || form == StaticMappingForm::Runs ? bytes : 0;
}

bool StaticMappingBuilder::HoldsVoxels() const
{
  if (!this->Linker)
  {
    return false;
  }
  BarycentricMap map;
  glm::i64vec3 voxel;
  for (std::size_t id = 0; id < this->Tetrahedra.size(); ++id)
  {
    if (map.SetTetrahedron(this->Tetrahedra[id], this->RestPoints) &&
      this->Linker->FindVoxel(static_cast<std::int32_t>(id), voxel))
    {
      return true;
    }
  }
  return false;
}

StaticMapping StaticMappingBuilder::Build(
  const Extent& part, const std::function<bool(double)>& progress) const
{
  const auto report = [&](double done)
  {
    if (progress && !progress(done))
    {
      throw Aborted();
    }
  };
  StaticMapping mapping;
  if (!this->Linker)
  {
    return mapping;
  }
  report(SortedFraction);
  if (this->RunBytes > 0)
  {
    const RunBuilder builder(*this->Linker, this->Voxels, this->RestPoints, this->Tetrahedra);
    mapping.Runs = builder.Build(part, mapping.NumberOfInnerVoxels,
      [&](double done) { report(SortedFraction + (1.0 - SortedFraction) * done); });
  }
  else
  {
    this->BuildLinks(part, report, mapping);
  }
  if (this->Outside.AreDiscarded())
  {
    mapping.Boundary = FindMeshBoundary(part, this->Voxels, this->RestPoints, this->Tetrahedra);
  }
  mapping.SharedVoxel = this->Linker->GetSharedVoxel();
  mapping.NumberOfFlatTetrahedra = this->Linker->GetTiles().GetNumberOfFlatTetrahedra();
  return mapping;
}

void StaticMappingBuilder::BuildLinks(
  const Extent& part, const std::function<void(double)>& report, StaticMapping& mapping) const
{
  const double linkingDone = this->Outside.AreDiscarded() ? 1.0
    : this->Outside.AreKept()                             ? 0.4
                                                          : 0.6;
  const auto reportOutside = [&](double done) { report(linkingDone + (1.0 - linkingDone) * done); };
  mapping.Links.resize(GetNumberOfPoints(part));
  VoxelTarget<VertexLink> target;
  target.Data = mapping.Links.data();
  for (int axis = 0; axis < 3; ++axis)
  {
    target.First[axis] = part[2 * axis];
  }
  target.Size[0] = GetSize(part, 0);
  target.Size[1] = GetSize(part, 1);
  constexpr int steps = 16;
  const TetrahedronTiles& all = this->Linker->GetTiles();
  const TetrahedronTiles::Rectangle wanted = all.GetTiles(MakeVoxelBox(part));
  const std::int64_t across = wanted.End[0] - wanted.Begin[0];
  const std::int64_t tiles = across * (wanted.End[1] - wanted.Begin[1]);
  std::atomic<std::int64_t> inner{ 0 };
  for (int step = 0; step < steps; ++step)
  {
    const std::int64_t first = tiles * step / steps;
    ParallelForItems(tiles * (step + 1) / steps - first, 1,
      [&](std::int64_t i)
      {
        const std::int64_t row = wanted.Begin[1] + (first + i) / across;
        const std::int64_t tile =
          row * all.GetNumberOfTiles(0) + wanted.Begin[0] + (first + i) % across;
        inner +=
          this->Linker->LinkTile(tile, Intersect(all.GetVoxels(tile), MakeVoxelBox(part)), target);
      });
    report(SortedFraction + (linkingDone - SortedFraction) * (step + 1) / steps);
  }
  mapping.NumberOfInnerVoxels = inner;
  if (this->Outside.AreExtrapolated() && inner > 0 && inner < GetNumberOfPoints(this->Voxels))
  {
    ExtrapolateLinks(this->Voxels, this->Spacing, this->RestPoints, this->Tetrahedra, mapping.Links,
      reportOutside);
  }
  if (this->Outside.AreKept())
  {
    mapping.Faded.Link(this->Voxels, this->Spacing, this->RestPoints, this->Tetrahedra,
      this->Outside.FadeDistance, mapping.Links, reportOutside);
  }
}

StaticMapping BuildStaticMapping(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  const OutsideVoxels& outside, StaticMappingForm form, const std::function<bool(double)>& progress)
{
  return StaticMappingBuilder(voxels, spacing, restPoints, tetrahedra, outside, form)
    .Build(progress);
}

} // namespace deformvolume
