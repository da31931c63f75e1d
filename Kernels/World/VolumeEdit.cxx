// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeEdit.h"

#include "SheetCut.h"
#include "SurfaceInterior.h"
#include "WorldTool.h"

#include <glm/ext/vector_int3_sized.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace deformvolume
{
namespace
{

// Returns a tool that contains the voxels with a label. distance: of all voxels from the boundary.
CarvingTool MakeLabelTool(
  const Extent& volume, const LabelReader& labels, double label, double distance)
{
  CarvingTool tool;
  tool.Bounds = GetUnlimitedBounds();
  tool.IsOfVertices = true;
  tool.Function = [=](const glm::dvec3* points, std::size_t count, double* values)
  {
    for (std::size_t first = 0; first < count;)
    {
      // Labels of neighboring voxels are read at once.
      std::size_t end = first + 1;
      while (end < count && points[end] == points[end - 1] + glm::dvec3(1.0, 0.0, 0.0))
      {
        ++end;
      }
      const glm::i64vec3 voxel =
        glm::i64vec3(points[first]) - glm::i64vec3(volume[0], volume[2], volume[4]);
      labels((voxel.z * GetSize(volume, 1) + voxel.y) * GetSize(volume, 0) + voxel.x,
        static_cast<std::int64_t>(end - first), values + first);
      first = end;
    }
    std::transform(values, values + count, values,
      [label](double value) { return value == label ? -1.0 : 1.0; });
  };
  tool.Distance = [distance](const glm::dvec3*, std::size_t count, double* distances)
  { std::fill_n(distances, count, distance); };
  return tool;
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

VolumeEdit EditFinder::CarveInIndices(
  const CarvingTool& tool, const VertexPositions& vertices) const
{
  if (!this->IsSmooth)
  {
    return { FindCarvedTetrahedra(vertices, tool, this->Rule, this->Progress), {}, {} };
  }
  SmoothCarving carving = FindSmoothCarving(vertices, tool, this->FarDistance, this->Progress);
  return { std::move(carving.Tetrahedra), std::move(carving.Distances), {} };
}

VolumeEdit EditFinder::Carve(const CarvingTool& tool) const
{
  return this->CarveInIndices(GetInIndices(tool, this->Volume), this->GetVertices());
}

VolumeEdit EditFinder::CarveSurface(const WorldSheet& surface) const
{
  CarvingTool tool =
    MakeSurfaceInterior(surface.GetSheet(this->Volume), this->GetVertices().GetBox());
  if (this->IsSmooth)
  {
    tool.Distance = GetInIndices(MakeSurfaceDistance(surface), this->Volume);
  }
  return this->CarveInIndices(tool, this->GetVertices());
}

VolumeEdit EditFinder::CarveSweptSphere(const std::vector<glm::dvec3>& centers, double radius) const
{
  return this->Carve(MakeSweptSphere(centers, glm::dvec3(radius)));
}

VolumeEdit EditFinder::CarveLabel(const LabelReader& labels, double label) const
{
  // All voxels have the same distance: the boundary lies halfway between voxels.
  const Extent& voxels = this->Volume.PointExtent;
  return this->CarveInIndices(
    MakeLabelTool(voxels, labels, label, 0.5 * GetSmallestSpacing(this->Volume)),
    RestPositions(voxels));
}

} // namespace deformvolume
