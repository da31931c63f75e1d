// SPDX-License-Identifier: BSD-3-Clause
// Incremental updates in memory of several kinds, against whole outputs, bit by bit.
#include "EditedVolume.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <random>

using namespace deformvolume;

namespace
{

class IncrementalOutputs : public WayTest
{
};

} // namespace

// Two memories take turns, as a pipeline has them: only what is different is copied.
TEST_P(IncrementalOutputs, TakeTurns)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  EditedVolume volume = MakeVolume();
  VolumeDeformer whole;
  VolumeDeformer updated;
  volume.SendAll(whole, GetRoute());
  volume.SendAll(updated, GetRoute());
  std::array<EditedOutputs, 2> outputs{ { EditedOutputs(volume), EditedOutputs(volume) } };
  std::array<std::uint64_t, 2> revisions{ { 0, 0 } };
  std::mt19937 random(5);
  int parts = 0;
  for (int i = 0; i < 20; ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    volume.Move(random, i % 7 == 6 ? 100 : 0, 1.5F); // of which all are too many for a part
    volume.SendDisplacements(whole, GetRoute());
    volume.SendDisplacements(updated, GetRoute());
    EditedOutputs expected(volume);
    whole.Deform(expected.MakeRequest(volume));
    // Now and then the same memory twice.
    const int turn = i % 5 == 4 ? (i - 1) % 2 : i % 2;
    const int last = i == 0 ? 1 : (i - 1) % 5 == 4 ? (i - 2) % 2 : (i - 1) % 2;
    DeformRequest request = outputs[turn].MakeRequest(volume);
    request.Incremental = true;
    if (i > 0)
    {
      outputs[last].SetLast(request);
    }
    request.OutputRevision = turn != last ? revisions[turn] : 0;
    const DeformReport report = updated.Deform(request);
    revisions[turn] = report.Revision;
    ASSERT_TRUE(outputs[turn] == expected);
    parts += report.NumberOfResampledBricks < report.NumberOfBricks;
  }
  EXPECT_GT(parts, 10);
}

// A processor writes into the memory of an output only where that is aligned for its type. Where
// what it holds itself is not the last output, it makes all.
TEST_P(IncrementalOutputs, AreNotAligned)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  EditedVolume volume = MakeVolume();
  VolumeDeformer whole;
  VolumeDeformer updated;
  volume.SendAll(whole, GetRoute());
  volume.SendAll(updated, GetRoute());
  EditedOutputs aligned(volume);
  const std::size_t bytes = aligned.First.size() * sizeof(std::uint16_t);
  std::vector<char> shifted(bytes + 1);
  std::mt19937 random(11);
  int parts = 0;
  bool wasAligned = false;
  for (int i = 0; i < 20; ++i)
  {
    SCOPED_TRACE("edit " + std::to_string(i));
    if (i % 3 == 0)
    {
      volume.Blanked.resize(GetNumberOfPoints(volume.Shape.VertexExtent));
      volume.Blanked[random() % volume.Blanked.size()] ^= 1;
    }
    else
    {
      volume.Move(random, 0, i % 3 == 1 ? 1.5F : 14.0F); // the last one folds
    }
    const bool isAligned = i % 6 >= 4;
    const DeformRequest last = aligned.MakeRequest(volume);
    DeformRequest request = last;
    for (VolumeDeformer* deformer : { &whole, &updated })
    {
      volume.SendMasks(*deformer);
      volume.SendDisplacements(*deformer, GetRoute());
    }
    EditedOutputs expected(volume);
    whole.Deform(expected.MakeRequest(volume));
    request.Outputs[0] = isAligned ? last.Outputs[0] : shifted.data() + 1;
    request.Incremental = true;
    if (i > 0)
    {
      aligned.SetLast(request);
      request.LastOutputs[0] = wasAligned ? last.Outputs[0] : shifted.data() + 1;
    }
    const DeformReport report = updated.Deform(request);
    if (!isAligned)
    {
      std::memcpy(last.Outputs[0], shifted.data() + 1, bytes);
    }
    ASSERT_TRUE(aligned == expected);
    const bool isPart = report.NumberOfResampledBricks < report.NumberOfBricks;
    parts += isPart;
    if (HasVectors() && wasAligned && !isAligned)
    {
      EXPECT_FALSE(isPart) << "it was in the memory of the host";
    }
    wasAligned = isAligned;
  }
  EXPECT_GT(parts, 8);
}

INSTANTIATE_TEST_SUITE_P(Ways, IncrementalOutputs, GetWays(), GetWayName);
