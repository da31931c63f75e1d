// SPDX-License-Identifier: BSD-3-Clause
// Cells that cover much of the output. They are resampled row by row, divided into pieces.
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace deformvolume;

namespace
{

/// Copies a part of a result to a result of its own.
Deformed Extract(const Deformed& whole, const Extent& extent, const Extent& part,
  const std::vector<VolumeArray>& arrays)
{
  Deformed extracted;
  extracted.Method = whole.Method;
  extracted.Outputs.resize(arrays.size());
  for (int z = part[4]; z <= part[5]; ++z)
  {
    for (int y = part[2]; y <= part[3]; ++y)
    {
      const std::int64_t begin =
        ((std::int64_t{ z } - extent[4]) * GetSize(extent, 1) + y - extent[2]) *
          GetSize(extent, 0) +
        part[0] - extent[0];
      const std::int64_t size = GetSize(part, 0);
      extracted.Coverage.insert(extracted.Coverage.end(), whole.Coverage.begin() + begin,
        whole.Coverage.begin() + begin + size);
      for (std::size_t a = 0; a < arrays.size(); ++a)
      {
        const std::int64_t bytes =
          std::int64_t{ arrays[a].Components } * GetElementSize(arrays[a].Type);
        const auto first = whole.Outputs[a].begin() + begin * bytes;
        extracted.Outputs[a].insert(extracted.Outputs[a].end(), first, first + size * bytes);
      }
    }
  }
  return extracted;
}

/// Compares a part of the output with the reference. The whole would take too long.
void CheckPart(const DeformerCase& deformerCase, const Extent& part,
  const std::vector<VolumeArray>& arrays, const Deformed& deformed)
{
  DeformerCase smaller = deformerCase;
  smaller.Output = part;
  const reference::Result reference = ResampleByReference(smaller);
  Deformed extracted = Extract(deformed, deformerCase.Output, part, arrays);
  // Counters of the part. The counter of inverted tetrahedra is that of the whole volume.
  extracted.Report.NumberOfCoveredVoxels =
    std::count(extracted.Coverage.begin(), extracted.Coverage.end(), static_cast<signed char>(1));
  extracted.Report.NumberOfInvertedTetrahedra = deformed.Report.NumberOfInvertedTetrahedra;
  extracted.Report.Overlapping = reference.NumberOfOverlappedVoxels > 0;
  ExpectEqualsReference(smaller, reference, arrays, extracted);
}

/// Compares random rows along each axis, and a corner of the output, with the reference.
void CheckParts(const DeformerCase& deformerCase, const std::vector<VolumeArray>& arrays,
  const Deformed& deformed)
{
  std::mt19937 random(7);
  const Extent& whole = deformerCase.Output;
  for (int i = 0; i < 60; ++i)
  {
    Extent part = whole;
    for (int axis = 0; axis < 3; ++axis)
    {
      if (axis != i % 3)
      {
        const auto size = static_cast<unsigned int>(GetSize(whole, axis));
        part[2 * axis] = whole[2 * axis] + static_cast<int>(random() % size);
        part[2 * axis + 1] = part[2 * axis];
      }
    }
    CheckPart(deformerCase, part, arrays, deformed);
  }
  const Extent corner{ { whole[0], whole[0] + 9, whole[2], whole[2] + 9, whole[4], whole[4] + 9 } };
  CheckPart(deformerCase, corner, arrays, deformed);
}

/// One cell, whose vertices are moved by up to a fraction of its size.
DeformerCase MakeStretchedCell(int parity, double size, double part, unsigned int seed)
{
  const Extent extent{ { parity & 1, (parity & 1) + 1, parity >> 1 & 1, (parity >> 1 & 1) + 1,
    parity >> 2 & 1, (parity >> 2 & 1) + 1 } };
  return MakeCase(extent, NoScale,
    [size, jitter = MakeJitter(seed, size * part)](const glm::dvec3& index)
    { return jitter(size * index); });
}

} // namespace

TEST(LargeCells, OneCellLargerThanTheOutput)
{
  const UsualArrays usual(8);
  const std::vector<VolumeArray> arrays = usual.Get();
  // Slightly bent; strongly bent, but upright; with inverted tetrahedra.
  for (const double part : { 0.02, 0.25, 0.7 })
  {
    for (const int parity : { 0, 5 })
    {
      const DeformerCase cell = MakeStretchedCell(parity, 120.0, part, 4);
      for (const Resampling method : GetExactMethods())
      {
        SCOPED_TRACE(testing::Message() << part << ' ' << parity << ' ' << int(method));
        VolumeDeformer deformer;
        Load(deformer, cell, arrays, Route::Field);
        const Deformed deformed = RunDeformer(deformer, cell, arrays, method);
        CheckParts(cell, arrays, deformed);
      }
    }
  }
}

TEST(LargeCells, MaskedCellsThatOverlap)
{
  // Large cells overlap each other and small cells. Some tetrahedra are inactive.
  const Extent volume{ { 0, 3, 0, 2, 0, 2 } };
  DeformerCase cells = MakeCase(volume, NoScale,
    [jitter = MakeJitter(6, 60.0)](const glm::dvec3& index)
    { return index.x < 1.5 ? jitter(20.0 * index) : 20.0 * index; });
  std::mt19937 random(5);
  for (std::int64_t cell = 0; cell < GetNumberOfCells(volume); ++cell)
  {
    cells.Active.push_back(static_cast<unsigned char>(random() % 3 ? 31 : random() % 32));
  }
  const UsualArrays usual(cells.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const reference::Result reference = ResampleByReference(cells);
  EXPECT_GT(reference.NumberOfOverlappedVoxels, 0);
  ExpectEqualsReference(cells, reference, arrays, LoadAndRun(cells, arrays));
}

TEST(LargeCells, InChunksAndSlabs)
{
  // Two vertices are moved far out of the volume. The eight cells around each of them are large in
  // every slab.
  const DeformerCase cells = MakeCase({ { 0, 34, 0, 34, 0, 40 } }, NoScale,
    [](const glm::dvec3& index)
    {
      const bool pulled = index == glm::dvec3(5, 6, 3) || index == glm::dvec3(8, 4, 25);
      return 1.25 * index + (pulled ? glm::dvec3(55.5, 60.25, 48.0) : glm::dvec3(0.0));
    });
  const UsualArrays usual(cells.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  const reference::Result reference = ResampleByReference(cells);
  VolumeDeformer deformer;
  deformer.SetDevice("");
  // A link has 16 bytes, and a chunk has three planes more than layers. A winner has four bytes per
  // voxel.
  constexpr int layers = 20;
  deformer.SetAllocationLimit(16 * 35 * 35 * (layers + 3));
  Load(deformer, cells, arrays, Route::Mesh);
  for (const Resampling method : GetExactMethods())
  {
    SCOPED_TRACE(int(method));
    ExpectEqualsReference(cells, reference, arrays, RunDeformer(deformer, cells, arrays, method));
  }
}

TEST(LargeCells, TimeIsThatOfTheirSamples)
{
  // One cell fills its bounding box. The other one lies along the diagonal of its box.
  const Extent cell{ { 0, 1, 0, 1, 0, 1 } };
  const DeformerCase full =
    MakeCase(cell, NoScale, [](const glm::dvec3& index) { return 300.0 * index; });
  const DeformerCase thin = MakeCase(cell, NoScale,
    [](const glm::dvec3& index)
    {
      return index.x * glm::dvec3(290, 290, 290) + index.y * glm::dvec3(-10, 10, 0) +
        index.z * glm::dvec3(0, -10, 10);
    });
  // Writing the background values takes time, too.
  DeformerCase nothing = thin;
  nothing.Blanked.assign(8, 1);
  const UsualArrays usual(8);
  const std::vector<VolumeArray> arrays = usual.Get();
  for (const Resampling method : GetExactMethods())
  {
    SCOPED_TRACE(int(method));
    const auto measure = [&](const DeformerCase& deformerCase, bool isCovered = true)
    {
      VolumeDeformer deformer;
      Load(deformer, deformerCase, arrays, Route::Field);
      double least = RunDeformer(deformer, deformerCase, arrays, method).Report.ResamplingTime;
      for (int i = 0; i < 2; ++i)
      {
        const Deformed again = RunDeformer(deformer, deformerCase, arrays, method);
        EXPECT_EQ(again.Report.NumberOfCoveredVoxels > 80000, isCovered);
        least = std::min(least, again.Report.ResamplingTime);
      }
      return least;
    };
    const double ofThin = measure(thin) - measure(nothing, false);
    // The thin cell has one in three hundred of the samples of the full cell, and a sixth of its
    // rows.
    EXPECT_LT(ofThin, 0.25 * measure(full));
  }
}
