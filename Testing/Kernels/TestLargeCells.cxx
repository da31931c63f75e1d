// SPDX-License-Identifier: BSD-3-Clause
// Cells that are stretched over much of the output. They are resampled row by row and in pieces.
#include "DeformerCase.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace deformvolume;

namespace
{

const std::array<double, 3> NoScale{ { 1, 1, 1 } };

/// A part of an output, with its values, as one of its own.
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

/// A part of the output against the reference, which would take too long for the whole.
void CheckPart(const DeformerCase& deformerCase, const Extent& part,
  const std::vector<VolumeArray>& arrays, const Deformed& deformed)
{
  DeformerCase smaller = deformerCase;
  smaller.Output = part;
  const reference::Result reference = ResampleByReference(smaller);
  Deformed extracted = Extract(deformed, deformerCase.Output, part, arrays);
  // What the report says of the whole.
  extracted.Report.NumberOfCoveredVoxels = std::count(
    extracted.Coverage.begin(), extracted.Coverage.end(), static_cast<signed char>(1));
  extracted.Report.NumberOfInvertedTetrahedra = deformed.Report.NumberOfInvertedTetrahedra;
  extracted.Report.Overlapping = reference.NumberOfOverlappedVoxels > 0;
  ExpectEqualsReference(smaller, reference, arrays, extracted);
}

/// Some rows along each axis, one of them on the border, and a slanted plane's worth of boxes.
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
  const Extent corner{ { whole[0], whole[0] + 9, whole[2], whole[2] + 9, whole[4],
    whole[4] + 9 } };
  CheckPart(deformerCase, corner, arrays, deformed);
}

/// One cell of eight voxels, whose vertices are moved to other places by up to a part of its size.
DeformerCase MakeStretchedCell(int parity, double size, double part, unsigned int seed)
{
  const Extent extent{ { parity & 1, (parity & 1) + 1, parity >> 1 & 1, (parity >> 1 & 1) + 1,
    parity >> 2 & 1, (parity >> 2 & 1) + 1 } };
  return MakeCase(extent, NoScale,
    [size, jitter = MakeJitter(seed, size * part)](const glm::dvec3& index)
    { return jitter(size * index); });
}

} // namespace

TEST(LargeCells, OneCellOverTheOutput)
{
  const auto values = MakeRandomValues<std::uint16_t>(8, 2);
  const auto labels = MakeRandomValues<std::uint8_t>(8, 3);
  const std::vector<VolumeArray> arrays{ MakeArray(values), MakeArray(labels, 1, true, 12.0) };
  // Hardly bent; much, but upright; with inverted tetrahedra.
  for (const double part : { 0.02, 0.25, 0.7 })
  {
    for (const int parity : { 0, 5 })
    {
      const DeformerCase cell = MakeStretchedCell(parity, 300.0, part, 4);
      for (const Resampling method : { Resampling::ExactByLanes, Resampling::ExactByCell })
      {
        SCOPED_TRACE(testing::Message() << part << ' ' << parity << ' ' << int(method));
        VolumeDeformer deformer;
        Load(deformer, cell, arrays, Route::Field);
        const Deformed deformed = RunDeformer(deformer, cell, arrays, method);
        std::printf("%g %d: %lld covered, %g s\n", part, int(method),
          (long long)deformed.Report.NumberOfCoveredVoxels, deformed.Report.ResamplingTime);
        CheckParts(cell, arrays, deformed);
      }
    }
  }
}
