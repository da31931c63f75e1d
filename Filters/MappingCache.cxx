// SPDX-License-Identifier: BSD-3-Clause
#include "MappingCache.h"

#include <chrono>
#include <utility>

namespace deformvolume
{

bool MappingCache::IsCurrent(
  const Deformation& deformation, const ImageGeometry& volume, bool extrapolate) const
{
  return this->Valid && this->RestVersion == deformation.GetRestVersion() &&
    this->Volume == volume && this->Extrapolate == extrapolate;
}

void MappingCache::Update(const Deformation& deformation, const ImageGeometry& volume,
  bool extrapolate, const std::function<bool(double)>& progress)
{
  if (this->HasLinks() && this->IsCurrent(deformation, volume, extrapolate))
  {
    return;
  }
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Tetrahedron>& tetrahedra = deformation.GetTetrahedra();
  // The old links go first, so that two sets never stand in memory.
  this->Mapping = StaticMapping();
  this->Valid = false;
  StaticMapping mapping = BuildStaticMapping(volume.PointExtent, volume.Spacing,
    deformation.GetRestPoints(), tetrahedra, extrapolate, progress);
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
  this->RestVersion = deformation.GetRestVersion();
  this->Volume = volume;
  this->Extrapolate = extrapolate;
  this->Valid = true;
  ++this->Version;
  ++this->NumberOfBuilds;
  this->Time += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double MappingCache::TakeTime()
{
  return std::exchange(this->Time, 0.0);
}

} // namespace deformvolume
