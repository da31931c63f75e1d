// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeMaterials.h"

#include "MaskArray.h"
#include "StaticMapping.h"

#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace deformvolume
{
namespace
{

// Number of voxels whose links, of 16 bytes each, are in memory at a time.
constexpr std::int64_t VoxelsAtOnce = 1 << 24;

class MeanFinder
{
public:
  MeanFinder(const VolumeMaterials& volume, const std::vector<glm::dvec3>& points,
    const std::vector<Tetrahedron>& tetrahedra)
    : Volume(volume)
    , Points(points)
    , Tetrahedra(tetrahedra)
    , Sums(tetrahedra.size(), { 0.0, 0.0, 0.0 })
    , Numbers(tetrahedra.size())
  {
    const glm::dmat4 toIndex = volume.Volume.GetWorldToIndex();
    for (glm::dvec3& point : this->Points)
    {
      point = glm::dvec3(toIndex * glm::dvec4(point, 1.0));
    }
  }

  void AddVoxels(const std::function<bool(double)>& progress)
  {
    const Extent& whole = this->Volume.Volume.PointExtent;
    const StaticMappingBuilder builder(whole, this->Volume.Volume.Spacing, this->Points,
      this->Tetrahedra, false, StaticMappingForm::Links);
    const std::int64_t layer = GetSize(whole, 0) * GetSize(whole, 1);
    const std::int64_t layers = std::max<std::int64_t>(VoxelsAtOnce / layer, 1);
    std::size_t first = 0;
    for (std::int64_t z = whole[4]; z <= whole[5]; z += layers)
    {
      Extent part = whole;
      part[4] = static_cast<int>(z);
      part[5] = static_cast<int>(std::min<std::int64_t>(z + layers - 1, whole[5]));
      const double share = double(part[5] - part[4] + 1) / double(GetSize(whole, 2));
      const double before = double(z - whole[4]) / double(GetSize(whole, 2));
      const StaticMapping mapping = builder.Build(
        part, [&](double done) { return !progress || progress(before + share * done); });
      this->Add(first, mapping.Links);
      first += mapping.Links.size();
    }
  }

  MaterialMeans GetMeans()
  {
    MaterialMeans means;
    means.Materials = std::move(this->Sums);
    for (std::size_t t = 0; t < this->Tetrahedra.size(); ++t)
    {
      ElasticMaterial& material = means.Materials[t];
      if (this->Numbers[t] > 0)
      {
        const auto number = static_cast<double>(this->Numbers[t]);
        material = { material.YoungModulus / number, material.PoissonRatio / number,
          material.Density / number };
        continue;
      }
      const std::optional<std::size_t> nearest = this->FindNearest(this->Tetrahedra[t]);
      material =
        nearest ? this->Volume.Table[this->Volume.Indices[*nearest]] : this->Volume.Default;
      ++(nearest ? means.NumberWithNearest : means.NumberWithDefault);
    }
    return means;
  }

private:
  bool IsHidden(std::size_t voxel) const
  {
    return this->Volume.Ghosts && (this->Volume.Ghosts[voxel] & IgnoredPointBits) != 0;
  }

  // Adds voxels in their order, because sums of doubles depend on it.
  void Add(std::size_t first, const std::vector<VertexLink>& links)
  {
    for (std::size_t i = 0; i < links.size(); ++i)
    {
      if (links[i].Tetrahedron < 0 || this->IsHidden(first + i))
      {
        continue;
      }
      const ElasticMaterial& material = this->Volume.Table[this->Volume.Indices[first + i]];
      const auto t = static_cast<std::size_t>(links[i].Tetrahedron);
      this->Sums[t].YoungModulus += material.YoungModulus;
      this->Sums[t].PoissonRatio += material.PoissonRatio;
      this->Sums[t].Density += material.Density;
      ++this->Numbers[t];
    }
  }

  // The voxel nearest to the centroid; nothing if it is hidden or outside the volume.
  std::optional<std::size_t> FindNearest(const Tetrahedron& tetrahedron) const
  {
    glm::dvec3 centroid{ 0.0 };
    for (const std::int32_t node : tetrahedron)
    {
      centroid += 0.25 * this->Points[static_cast<std::size_t>(node)];
    }
    const Extent& whole = this->Volume.Volume.PointExtent;
    std::size_t voxel = 0;
    for (int axis = 2; axis >= 0; --axis)
    {
      const double rounded = std::floor(centroid[axis] + 0.5);
      if (!(rounded >= whole[2 * axis] && rounded <= whole[2 * axis + 1]))
      {
        return std::nullopt;
      }
      voxel = voxel * static_cast<std::size_t>(GetSize(whole, axis)) +
        static_cast<std::size_t>(rounded - whole[2 * axis]);
    }
    return this->IsHidden(voxel) ? std::nullopt : std::optional<std::size_t>(voxel);
  }

  const VolumeMaterials& Volume;
  std::vector<glm::dvec3> Points; // in continuous indices of the volume
  const std::vector<Tetrahedron>& Tetrahedra;
  std::vector<ElasticMaterial> Sums;
  std::vector<std::int64_t> Numbers; // of voxels
};

} // namespace

MaterialMeans FindMaterialMeans(const VolumeMaterials& volume,
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra,
  const std::function<bool(double)>& progress)
{
  MeanFinder finder(volume, points, tetrahedra);
  finder.AddVoxels(progress);
  return finder.GetMeans();
}

} // namespace deformvolume
