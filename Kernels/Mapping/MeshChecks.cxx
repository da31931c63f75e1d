// SPDX-License-Identifier: BSD-3-Clause
#include "MeshChecks.h"

#include "Error.h"
#include "VertexRuns.h"

#include <algorithm>
#include <string>

namespace deformvolume
{

void CheckMesh(
  const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra, std::size_t numberOfNodes)
{
  if (!numberOfTetrahedra || !numberOfNodes || !tetrahedra)
  {
    throw Error("The deformation mesh is empty.");
  }
  CheckTetrahedra(tetrahedra, 0, numberOfTetrahedra, numberOfNodes);
}

void CheckTetrahedra(
  const Tetrahedron* tetrahedra, std::size_t begin, std::size_t end, std::size_t numberOfNodes)
{
  for (std::size_t t = begin; t < end; ++t)
  {
    for (const std::int32_t node : tetrahedra[t])
    {
      if (node < 0 || static_cast<std::size_t>(node) >= numberOfNodes)
      {
        throw Error("Tetrahedron " + std::to_string(t) + " of the deformation mesh has the node " +
          std::to_string(node) + ", but there are " + std::to_string(numberOfNodes) + ".");
      }
    }
  }
}

void CheckLinks(const VertexLink* links, std::int64_t count, std::size_t numberOfTetrahedra)
{
  for (std::int64_t i = 0; i < count; ++i)
  {
    if (links[i].Tetrahedron >= 0 &&
      static_cast<std::size_t>(links[i].Tetrahedron) >= numberOfTetrahedra)
    {
      throw Error("Voxel " + std::to_string(i) + " is linked to the tetrahedron " +
        std::to_string(links[i].Tetrahedron) + ", but there are " +
        std::to_string(numberOfTetrahedra) + ".");
    }
  }
}

void CheckMappingUpdate(const MappingUpdate& update, const VoxelGrid& voxelGrid,
  std::size_t numberBefore, std::size_t numberAfter, bool byRuns)
{
  ForEachReplaced(update.Kept, static_cast<std::int32_t>(numberBefore),
    static_cast<std::int32_t>(numberAfter),
    [&](std::int32_t begin, std::int32_t end, std::int32_t newBegin, std::int32_t newEnd)
    {
      if (begin > end || newBegin > newEnd)
      {
        throw Error("The tetrahedra that are kept do not ascend from one to the next, of " +
          std::to_string(numberBefore) + " that there were and " + std::to_string(numberAfter) +
          " that there are.");
      }
    });
  const auto hasNone = [](const KeptTetrahedra& kept) { return kept.Count < 1; };
  if (std::any_of(update.Kept.begin(), update.Kept.end(), hasNone))
  {
    throw Error("No tetrahedra are kept where some are said to be.");
  }
  const Extent& extent = voxelGrid.VertexExtent;
  std::int64_t voxels = 0;
  std::int64_t rows = 0;
  for (const Extent& box : update.Boxes)
  {
    bool isInside = box[0] == extent[0] && box[1] == extent[1];
    for (int axis = 1; axis < 3; ++axis)
    {
      isInside &= box[2 * axis] >= extent[2 * axis] && box[2 * axis] <= box[2 * axis + 1] &&
        box[2 * axis + 1] <= extent[2 * axis + 1];
    }
    if (!isInside)
    {
      throw Error("Voxels are to be mapped anew that are no whole rows of the volume.");
    }
    voxels += GetNumberOfPoints(box);
    rows += GetSize(box, 1) * GetSize(box, 2);
  }
  if (byRuns && (rows > 0 || !update.Runs.Runs.empty()))
  {
    CheckRuns(update.Runs, static_cast<std::size_t>(rows), GetSize(extent, 0), numberAfter);
    return;
  }
  if (!byRuns && static_cast<std::int64_t>(update.Links.size()) != voxels)
  {
    throw Error("There are links of " + std::to_string(update.Links.size()) + " voxels for " +
      std::to_string(voxels) + ". A mapping by links stays one.");
  }
  CheckLinks(update.Links.data(), byRuns ? 0 : voxels, numberAfter);
}

} // namespace deformvolume
