// SPDX-License-Identifier: BSD-3-Clause
#include "DeformerCase.h"

using namespace deformvolume;

VertexRuns MakeRuns(const DeformerCase& deformerCase)
{
  const Extent& extent = deformerCase.VoxelGrid.VertexExtent;
  const std::int64_t size = GetSize(extent, 0);
  VertexRuns runs;
  for (std::int64_t voxel = 0; voxel < deformerCase.GetNumberOfVoxels(); ++voxel)
  {
    const std::int64_t x = voxel % size;
    const bool unlinked = !deformerCase.Unlinked.empty() && deformerCase.Unlinked[voxel];
    if (x == 0)
    {
      runs.RowBegins.push_back(static_cast<std::uint32_t>(runs.Runs.size()));
    }
    else
    {
      const bool wasUnlinked = !deformerCase.Unlinked.empty() && deformerCase.Unlinked[voxel - 1];
      if (unlinked == wasUnlinked &&
        (unlinked || deformerCase.Displacements[voxel] == deformerCase.Displacements[voxel - 1]))
      {
        continue;
      }
    }
    VertexRun run;
    run.Begin = static_cast<std::int32_t>(x);
    if (!unlinked)
    {
      run.Tetrahedron = static_cast<std::int32_t>(runs.Tetrahedra.size());
      RestTetrahedron rest;
      rest.Tetrahedron = static_cast<std::int32_t>(voxel);
      const std::int64_t row = voxel / size;
      rest.Origin = { { static_cast<double>(x), static_cast<double>(row % GetSize(extent, 1)),
        static_cast<double>(row / GetSize(extent, 1)) } };
      if (GetCorner(voxel) < 3)
      {
        rest.Weights[GetCorner(voxel)] = 1.0;
      }
      runs.Tetrahedra.push_back(rest);
    }
    runs.Runs.push_back(run);
  }
  runs.RowBegins.push_back(static_cast<std::uint32_t>(runs.Runs.size()));
  return runs;
}

void ExpectEqualsReference(const DeformerCase& deformerCase, Route route)
{
  const UsualArrays usual(deformerCase.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  ExpectEqualsReference(deformerCase, ResampleByReference(deformerCase), arrays,
    LoadAndRun(deformerCase, arrays, route));
}
