// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeEdit.h"

#include "SheetCut.h"
#include "SurfaceInterior.h"
#include "WorldTool.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace deformvolume
{
namespace
{

VolumeEdit MakeEdit(SmoothCarving&& carving)
{
  return { std::move(carving.Tetrahedra), std::move(carving.Distances), {} };
}

} // namespace

float GetFarDistance(const Extent& volume, const glm::dvec3& spacing)
{
  glm::dvec3 size;
  for (int axis = 0; axis < 3; ++axis)
  {
    size[axis] = static_cast<double>(GetSize(volume, axis)) * spacing[axis];
  }
  return static_cast<float>(glm::length(size));
}

bool HasLabel(const Extent& volume, const LabelReader& labels, double label)
{
  const std::int64_t width = GetSize(volume, 0);
  const std::int64_t voxels = GetNumberOfPoints(volume);
  std::vector<double> row(static_cast<std::size_t>(width));
  for (std::int64_t voxel = 0; voxel < voxels; voxel += width)
  {
    labels(voxel, width, row.data());
    if (std::find(row.begin(), row.end(), label) != row.end())
    {
      return true;
    }
  }
  return false;
}

VolumeEdit EditFinder::Cut(const WorldSheet& sheet) const
{
  const Sheet triangles = sheet.GetSheet(this->Volume);
  const VertexPositions& vertices = this->GetVertices();
  VolumeEdit edit;
  if (this->IsSmooth)
  {
    edit.Crossings = FindSheetCrossings(vertices, triangles, this->Progress);
  }
  else
  {
    edit.Tetrahedra = FindCrossedTetrahedra(vertices, triangles, this->Progress);
  }
  return edit;
}

VolumeEdit EditFinder::CarveInIndices(const CarvingTool& tool) const
{
  const VertexPositions& vertices = this->GetVertices();
  if (this->IsSmooth)
  {
    return MakeEdit(FindSmoothCarving(vertices, tool, this->FarDistance, this->Progress));
  }
  return { FindCarvedTetrahedra(vertices, tool, this->Rule, this->Progress), {}, {} };
}

VolumeEdit EditFinder::Carve(const CarvingTool& tool) const
{
  return this->CarveInIndices(GetInIndices(tool, this->Volume));
}

VolumeEdit EditFinder::CarveSurface(const WorldSheet& surface) const
{
  CarvingTool tool =
    MakeSurfaceInterior(surface.GetSheet(this->Volume), this->GetVertices().GetBox());
  if (this->IsSmooth)
  {
    tool.Distance = GetInIndices(MakeSurfaceDistance(surface), this->Volume);
  }
  return this->CarveInIndices(tool);
}

VolumeEdit EditFinder::CarveSweptSphere(const std::vector<glm::dvec3>& centers, double radius) const
{
  return this->Carve(MakeSweptSphere(centers, glm::dvec3(radius)));
}

VolumeEdit EditFinder::CarveLabel(const LabelReader& labels, double label) const
{
  const Extent& all = this->Volume.PointExtent;
  const auto find = [&](const Extent& vertices, double* found)
  {
    const std::int64_t width = GetSize(vertices, 0);
    for (int z = vertices[4]; z <= vertices[5]; ++z)
    {
      for (int y = vertices[2]; y <= vertices[3]; ++y)
      {
        const std::int64_t voxel =
          ((z - all[4]) * GetSize(all, 1) + y - all[2]) * GetSize(all, 0) + vertices[0] - all[0];
        labels(voxel, width, found);
        std::transform(found, found + width, found,
          [label](double value) { return value == label ? -1.0 : 1.0; });
        found += width;
      }
    }
  };
  const CellBricks bricks(all);
  if (!this->IsSmooth)
  {
    return { FindCarvedTetrahedra(bricks, find, this->Rule, this->Progress), {}, {} };
  }
  // All voxels have the same distance: the boundary lies halfway between voxels.
  const glm::dvec3& spacing = this->Volume.Spacing;
  const double half =
    0.5 * std::min({ std::abs(spacing.x), std::abs(spacing.y), std::abs(spacing.z) });
  return MakeEdit(FindSmoothCarving(bricks, find, half, this->FarDistance, this->Progress));
}

} // namespace deformvolume
