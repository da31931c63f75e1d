// SPDX-License-Identifier: BSD-3-Clause
// Deformations that invert tetrahedra or fold the volume onto itself.
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace deformvolume;

namespace
{

const Extent FoldedVolume{ { -2, 9, 0, 8, 1, 10 } };

void Check(const DeformerCase& folded, const reference::Result& reference)
{
  const UsualArrays usual(folded.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  ExpectEqualsReference(folded, reference, arrays, LoadAndRun(folded, arrays));
}

void Check(const DeformerCase& folded)
{
  Check(folded, ResampleByReference(folded));
}

// Offset of a vertex in its cell, by its number in FiveTetrahedra.h.
glm::dvec3 GetOffset(int vertex)
{
  return glm::dvec3(vertex & 1, vertex >> 2 & 1, vertex >> 1 & 1);
}

/// A single cell with two corner vertices that are moved past each other.
DeformerCase MakeCellWithOverlap(int parity, int first, int second, double size)
{
  // The face of a corner tetrahedron contains all vertices of the central tetrahedron but the one
  // at the opposite corner of the cell.
  glm::dvec3 edge(0.0);
  for (const int vertex : { 0, 3, 5, 6 })
  {
    edge += (vertex ^ first) == 7 || (vertex ^ second) == 7 ? glm::dvec3(0.0) : GetOffset(vertex);
  }
  edge *= 0.5;
  const glm::dvec3 outwards = 2.0 * (edge - glm::dvec3(0.5));
  const glm::dvec3 across = 0.25 * (GetOffset(second) - GetOffset(first));
  const Extent extent{ { parity & 1, (parity & 1) + 1, parity >> 1 & 1, (parity >> 1 & 1) + 1,
    parity >> 2 & 1, (parity >> 2 & 1) + 1 } };
  return MakeCase(extent, NoScale,
    [=](const glm::dvec3& index)
    {
      // Cells of odd index are mirrored.
      glm::dvec3 offset(0.0);
      for (int axis = 0; axis < 3; ++axis)
      {
        offset[axis] = std::fmod(index[axis], 2.0);
      }
      glm::dvec3 moved = offset;
      moved = offset == GetOffset(first) ? edge + outwards + across : moved;
      moved = offset == GetOffset(second) ? edge + outwards - across : moved;
      for (int axis = 0; axis < 3; ++axis)
      {
        moved[axis] *= parity >> axis & 1 ? -size : size;
      }
      return moved;
    });
}

} // namespace

TEST(Folded, MirroredAlongAnAxis)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // Nothing moves along the other two axes: all samples lie on edges of cells.
  for (int axis = 0; axis < 3; ++axis)
  {
    SCOPED_TRACE(axis);
    const auto jitter = MakeJitter(static_cast<unsigned int>(axis), 0.17);
    const DeformerCase mirrored = MakeCase(FoldedVolume, NoScale,
      [&](const glm::dvec3& index)
      {
        glm::dvec3 moved = index;
        moved[axis] = -jitter(index)[axis];
        return moved;
      });
    const reference::Result reference = ResampleByReference(mirrored);
    EXPECT_EQ(reference.NumberOfInvertedTetrahedra, 5 * GetNumberOfCells(FoldedVolume));
    Check(mirrored, reference);
  }
}

TEST(Folded, CornersOfOneCellOverlap)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // Two corner tetrahedra extend past each other over an edge of the central tetrahedron. None of
  // the five is inverted.
  constexpr std::array<std::array<int, 2>, 6> pairs{ { { { 1, 2 } }, { { 1, 4 } }, { { 1, 7 } },
    { { 2, 4 } }, { { 2, 7 } }, { { 4, 7 } } } };
  for (int parity = 0; parity < 8; ++parity)
  {
    for (const auto& [first, second] : pairs)
    {
      SCOPED_TRACE(testing::Message() << parity << ' ' << first << ' ' << second);
      const DeformerCase cell = MakeCellWithOverlap(parity, first, second, 8.0);
      const reference::Result reference = ResampleByReference(cell);
      EXPECT_EQ(reference.NumberOfInvertedTetrahedra, 0);
      EXPECT_GT(reference.NumberOfOverlappedVoxels, 0);
      Check(cell, reference);
    }
  }
}

TEST(Folded, VertexInAnotherTetrahedronOfItsCell)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // Two cells share the vertex at this sample. In the upper cell another tetrahedron, without this
  // vertex, also contains the sample. The tetrahedra overlap, so that the lower cell wins, whether
  // it is upright or mirrored.
  for (const double sign : { 1.0, -1.0 })
  {
    SCOPED_TRACE(sign);
    const DeformerCase cells = MakeCase({ { 0, 1, 0, 1, -1, 1 } }, NoScale,
      [sign](const glm::dvec3& index)
      {
        glm::dvec3 moved = 8.0 * index;
        moved = index == glm::dvec3(1, 0, 0) ? glm::dvec3(4, -2, 4) : moved;
        moved = index == glm::dvec3(0, 0, 1) ? glm::dvec3(6, -8, 2) : moved;
        return glm::dvec3(sign * moved.x, moved.y, moved.z);
      });
    Check(cells);
  }
}

TEST(Folded, ManyCells)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // In some of these many cells corner tetrahedra overlap.
  const DeformerCase jittered = MakeCase({ { 0, 30, 0, 30, 0, 30 } }, NoScale, MakeJitter(3, 1.0));
  Check(jittered);
}

TEST(Folded, FoldedLikeAPage)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // Upright and inverted cells meet in a crease on the plane x = 4, on samples and between them.
  for (const double sign : { 1.0, -1.0 })
  {
    for (const double crease : { 4.0, 3.5, 4.25 })
    {
      SCOPED_TRACE(sign * crease);
      Check(MakeCase(FoldedVolume, NoScale,
        [=](const glm::dvec3& index)
        { return glm::dvec3(sign * std::abs(index.x - crease), index.y, index.z); }));
      Check(MakeCase(FoldedVolume, NoScale,
        [=](const glm::dvec3& index)
        {
          return glm::dvec3(
            index.x, index.y + 0.25 * index.z, sign * 1.5 * std::abs(index.z - crease));
        }));
    }
  }
}

// Obliquely folded volumes with cells of more than four or eight voxels, and a crease on samples or
// between them.
TEST(Folded, LargeCells)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  for (const double size : { 5.0, 9.0 })
  {
    for (const double crease : { 3.0, 2.75 })
    {
      SCOPED_TRACE(size * crease);
      const auto fold = [=](const glm::dvec3& index)
      {
        const double across = std::abs(index.x - crease);
        return size * glm::dvec3(across, index.y + 0.25 * across + 0.125 * index.x, index.z);
      };
      Check(MakeCase({ { 0, 6, 0, 2, -1, 1 } }, NoScale, fold));
      const auto mirror = [=](const glm::dvec3& index)
      { return size * glm::dvec3(-index.x, index.y + 0.125 * index.x, index.z); };
      Check(MakeCase({ { 0, 6, 0, 2, -1, 1 } }, NoScale, mirror));
    }
  }
}

TEST(Folded, FlattenedVolume)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // One layer of cells has no thickness: its flat tetrahedra cover no samples.
  Check(MakeCase(FoldedVolume, NoScale,
    [](const glm::dvec3& index)
    { return glm::dvec3(index.x, index.y - (index.y > 4.0 ? 1.0 : 0.0), index.z); }));
  Check(MakeCase(FoldedVolume, NoScale,
    [](const glm::dvec3& index) { return glm::dvec3(index.x, 0.25 * index.x, index.z); }));
}

TEST(Folded, UprightOverlap)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // Twisted by more than a full turn: no tetrahedron is inverted, but the volume overlaps itself.
  const Extent ring{ { 0, 23, 0, 4, 0, 3 } };
  const DeformerCase wound = MakeCase(ring, NoScale,
    [](const glm::dvec3& index)
    {
      const double angle = 0.31 * index.x;
      const double radius = 4.0 + 1.5 * (4.0 - index.y);
      return glm::dvec3(radius * std::sin(angle), -radius * std::cos(angle), 1.5 * index.z);
    });
  const reference::Result reference = ResampleByReference(wound);
  EXPECT_EQ(reference.NumberOfInvertedTetrahedra, 0);
  EXPECT_GT(reference.NumberOfOverlappedVoxels, 0);
  Check(wound, reference);
}

TEST(Folded, CellsWithoutAllVerticesAtTheEdgeOfTheOutput)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  // At a blanked vertex nothing bounds the samples of the cell on that side. Some of these cells
  // win a voxel, and begin outside the output.
  std::mt19937 random(5);
  DeformerCase jittered = MakeCase(FoldedVolume, NoScale, MakeJitter(32, 1.0));
  for (std::int64_t voxel = 0; voxel < GetNumberOfPoints(FoldedVolume); ++voxel)
  {
    jittered.Blanked.push_back(random() % 12 == 0 ? 1 : 0);
  }
  const int first = jittered.Output[0];
  for (const int cropped : { 3, 5, 7 })
  {
    SCOPED_TRACE(cropped);
    jittered.Output[0] = first + cropped;
    Check(jittered);
  }
}

TEST(Folded, SameFromRunToRunAndForEveryWorkGroupSize)
{
  const DeformerCase jittered = MakeCase(FoldedVolume, NoScale, MakeJitter(33, 1.5));
  const UsualArrays usual(jittered.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer deformer;
  Load(deformer, jittered, arrays, Route::Field);
  const Deformed first = RunDeformer(deformer, jittered, arrays);
  ExpectEqualsReference(jittered, ResampleByReference(jittered), arrays, first);
  const std::array<std::size_t, 7> sizes{ { 0, 1, 2, 3, 8, 64, 128 } };
  for (int run = 0; run < 20; ++run)
  {
    SCOPED_TRACE(run);
    deformer.SetWorkGroupSize(sizes[run % sizes.size()]);
    const Deformed again = RunDeformer(deformer, jittered, arrays);
    EXPECT_EQ(again.Outputs, first.Outputs);
    EXPECT_EQ(again.Coverage, first.Coverage);
    EXPECT_EQ(again.Report.NumberOfInvertedTetrahedra, first.Report.NumberOfInvertedTetrahedra);
    EXPECT_TRUE(again.Report.Overlapping);
  }
}

TEST(Folded, EarlierOutputsDoNotMatter)
{
  // The passes depend on whether the previous output was folded. The result does not.
  const Extent large{ { 0, 131, 0, 9, 0, 11 } };
  // In the second deformation cells have samples on their upper faces. Only some of the passes
  // examine these samples.
  int pose = 0;
  const auto fold = [&](double crease)
  {
    return MakeCase(large, NoScale,
      [crease, pose](const glm::dvec3& index)
      {
        const double x = index.x > crease ? 2.0 * crease - index.x : index.x;
        return pose == 0
          ? glm::dvec3(x + 0.3 * index.y, index.y + 0.01 * index.x, index.z + 0.02 * x)
          : glm::dvec3(1.3 * x + 0.3 * index.y, 1.5 * index.y, 1.5 * index.z);
      });
  };
  const UsualArrays usual(fold(60.0).GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  for (const auto& [method, number] :
    { std::make_pair(Resampling::ExactByLanes, 0), std::make_pair(Resampling::ExactByLanes, 1),
      std::make_pair(Resampling::ExactByColumns, 0), std::make_pair(Resampling::ExactByCell, 0) })
  {
    if (method == Resampling::ExactByLanes && !HasVectors())
    {
      continue;
    }
    SCOPED_TRACE(number);
    pose = number;
    VolumeDeformer deformer;
    Load(deformer, fold(60.0), arrays, Route::Field);
    for (const double crease : { 60.0, 47.5, 140.0, 60.0, 20.25, 140.0, 140.0 })
    {
      SCOPED_TRACE(crease);
      const DeformerCase folded = fold(crease);
      MoveByField(deformer, folded);
      const Deformed again = RunDeformer(deformer, folded, arrays, method);
      VolumeDeformer fresh;
      Load(fresh, folded, arrays, Route::Field);
      const Deformed first = RunDeformer(fresh, folded, arrays, method);
      EXPECT_EQ(again.Outputs, first.Outputs);
      EXPECT_EQ(again.Coverage, first.Coverage);
      EXPECT_EQ(again.Report.Overlapping, crease < 131.0);
      EXPECT_EQ(again.Report.NumberOfInvertedTetrahedra, first.Report.NumberOfInvertedTetrahedra);
      EXPECT_EQ(again.Report.NumberOfCoveredVoxels, first.Report.NumberOfCoveredVoxels);
    }
  }
}

TEST(Folded, SamplesOnFacesAfterAFold)
{
  // If the previous output was folded, one pass finds the winners, except for cells that only touch
  // a sample. All cells here have samples on their faces: as boxes and sheared, with the crease on
  // samples and between them.
  const auto fold = [](const Extent& extent, double crease, double shear, double scale)
  {
    return MakeCase(extent, NoScale,
      [=](const glm::dvec3& index)
      {
        const double x = index.x > crease ? 2.0 * crease - index.x : index.x;
        return glm::dvec3(scale * x + shear * index.y, index.y, index.z + shear * x);
      });
  };
  struct Volume
  {
    Extent VertexExtent;
    std::vector<double> Creases;
  };
  // The second volume has creases in later columns of a brick, and in a second brick.
  const std::vector<Volume> volumes{ { { { -1, 40, 0, 8, 1, 9 } }, { 25.0, 30.5, 22.25 } },
    { { { 1, 212, 0, 4, 1, 5 } }, { 110.0, 140.5, 202.0 } } };
  for (const Resampling method : GetExactMethods())
  {
    for (const Volume& volume : volumes)
    {
      const UsualArrays usual(fold(volume.VertexExtent, 0.0, 0.0, 1.0).GetNumberOfVoxels());
      const std::vector<VolumeArray> arrays = usual.Get();
      VolumeDeformer deformer;
      Load(deformer, fold(volume.VertexExtent, 0.0, 0.0, 1.0), arrays, Route::Field);
      for (const double shear : { 0.0, 1.0 })
      {
        for (const double scale : { 1.0, 1.5 })
        {
          for (const double crease : volume.Creases)
          {
            SCOPED_TRACE(testing::Message() << shear << ' ' << scale << ' ' << crease);
            const DeformerCase folded = fold(volume.VertexExtent, crease, shear, scale);
            MoveByField(deformer, folded);
            const Deformed deformed = RunDeformer(deformer, folded, arrays, method);
            EXPECT_TRUE(deformed.Report.Overlapping);
            ExpectEqualsReference(folded, ResampleByReference(folded), arrays, deformed);
          }
        }
      }
    }
  }
}

TEST(Folded, CreaseAwayFromTheBorder)
{
  SKIP_WITHOUT_VECTORS()
  // Aligned cells on both sides of a crease, on samples that neither side writes. The brick has
  // only aligned cells, and the crease is not in its first column.
  const Extent large{ { 0, 400, 0, 34, 0, 34 } };
  const DeformerCase folded = MakeCase(large, NoScale,
    [](const glm::dvec3& index)
    { return glm::dvec3(index.x > 240.0 ? 480.0 - index.x : index.x, index.y, index.z); });
  const UsualArrays usual(folded.GetNumberOfVoxels());
  const std::vector<VolumeArray> arrays = usual.Get();
  VolumeDeformer byCells;
  Load(byCells, folded, arrays, Route::Field);
  const Deformed reference = RunDeformer(byCells, folded, arrays, Resampling::ExactByCell);
  VolumeDeformer byLanes;
  Load(byLanes, folded, arrays, Route::Field);
  for (int i = 0; i < 2; ++i) // the second time the output is known to be folded
  {
    const Deformed deformed = RunDeformer(byLanes, folded, arrays, Resampling::ExactByLanes);
    EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, std::int64_t{ 241 } * 35 * 35);
    EXPECT_TRUE(deformed.Coverage == reference.Coverage);
    EXPECT_TRUE(deformed.Outputs == reference.Outputs);
  }
}

TEST(Folded, OverstretchedTetrahedraAreSkippedAndCounted)
{
  const Extent small{ { 0, 3, 0, 3, 0, 3 } };
  DeformerCase torn = MakeCase(small, NoScale, [](const glm::dvec3& index) { return index; });
  // One vertex at a corner of the volume is moved far away. It belongs to one cell.
  torn.Displacements.back() = { { 5000 * 256, 0, 0 } };
  UsualArrays usual(torn.GetNumberOfVoxels()); // the background of the floats is 2
  std::fill(usual.Floats.begin(), usual.Floats.end(), 3.0F);
  const std::vector<VolumeArray> arrays = usual.Get();
  const Deformed deformed = LoadAndRun(torn, arrays);
  EXPECT_EQ(deformed.Report.NumberOfOverstretchedCells, 1);
  EXPECT_GE(deformed.Report.NumberOfCoveredVoxels, 63);
  for (std::size_t voxel = 0; voxel < deformed.Coverage.size(); ++voxel)
  {
    EXPECT_EQ(deformed.GetOutput<float>(1)[voxel], deformed.Coverage[voxel] != 0 ? 3.0F : 2.0F);
  }
}
