// SPDX-License-Identifier: BSD-3-Clause
// The static mapping by runs, compared with that by links, and the choice between the two forms.
#include "StaticMapping.h"

#include "LoopThreads.h"
#include "TetrahedralMeshes.h"
#include "VertexRuns.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <utility>

using namespace deformvolume;
using namespace tetrahedralMeshes;

namespace
{

StaticMapping Build(const Mesh& mesh, const Extent& voxels, StaticMappingForm form)
{
  return BuildStaticMapping(voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, form);
}

bool IsRefused(const std::function<void()>& function, const std::string& words)
{
  try
  {
    function();
  }
  catch (const Error& error)
  {
    return std::string(error.what()).find(words) != std::string::npos;
  }
  return false;
}

// The sum that decides whether a tetrahedron is a sliver, from the definition in VertexRuns.h.
double GetWeightVariation(const RestTetrahedron& rest, const Mesh& mesh, const Extent& voxels)
{
  double variation = 0.0;
  for (int k = 0; k < 3; ++k)
  {
    double sum = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      double min = voxels[2 * axis + 1];
      double max = voxels[2 * axis];
      for (const std::int32_t node : mesh.Tetrahedra[rest.Tetrahedron])
      {
        min = std::min(min, mesh.Points[node][axis]);
        max = std::max(max, mesh.Points[node][axis]);
      }
      sum += std::abs(rest.Gradients[k][axis]) *
        (std::min<double>(max, voxels[2 * axis + 1]) - std::max<double>(min, voxels[2 * axis]));
    }
    variation = std::max(variation, sum);
  }
  return variation;
}

// Checks that the origin of a record is a voxel in the tetrahedron. Nodes are rounded by up to
// 1/512 voxel on each axis.
void CheckOrigin(const RestTetrahedron& rest, const Extent& voxels)
{
  double last = 1.0;
  double lastVariation = 0.0;
  for (int k = 0; k < 3; ++k)
  {
    double variation = 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      const double origin = rest.Origin[axis];
      EXPECT_TRUE(origin == std::floor(origin) && origin >= 0.0 &&
        origin < static_cast<double>(GetSize(voxels, axis)));
      variation += std::abs(rest.Gradients[k][axis]) / 128.0;
    }
    EXPECT_TRUE(rest.Weights[k] >= -variation && rest.Weights[k] <= 1.0 + variation);
    last -= rest.Weights[k];
    lastVariation += variation;
  }
  EXPECT_TRUE(last >= -lastVariation && last <= 1.0 + lastVariation);
}

// The record that displaces a voxel, with its origin as structured index: comparable between parts
// of a volume.
struct Displacer
{
  std::int32_t Tetrahedron = -1;
  std::array<double, 3> Origin{};
  std::array<double, 3> Weights{};
  std::array<std::array<double, 3>, 3> Gradients{};
  bool operator==(const Displacer& other) const
  {
    return this->Tetrahedron == other.Tetrahedron && this->Origin == other.Origin &&
      this->Weights == other.Weights && this->Gradients == other.Gradients;
  }
};

std::vector<Displacer> GetDisplacers(const VertexRuns& runs, const Extent& voxels)
{
  std::vector<Displacer> displacers;
  const std::int64_t size = GetSize(voxels, 0);
  for (std::size_t row = 0; row + 1 < runs.RowBegins.size(); ++row)
  {
    std::uint32_t run = runs.RowBegins[row];
    for (std::int64_t x = 0; x < size; ++x)
    {
      run += run + 1 < runs.RowBegins[row + 1] && runs.Runs[run + 1].Begin == x ? 1 : 0;
      Displacer displacer;
      if (runs.Runs[run].Tetrahedron >= 0)
      {
        const RestTetrahedron& rest = runs.Tetrahedra[runs.Runs[run].Tetrahedron];
        displacer.Tetrahedron = rest.Tetrahedron;
        displacer.Weights = rest.Weights;
        displacer.Gradients = rest.Gradients;
        for (int axis = 0; axis < 3; ++axis)
        {
          displacer.Origin[axis] = rest.Origin[axis] + voxels[2 * axis];
        }
      }
      displacers.push_back(displacer);
    }
  }
  return displacers;
}

// The static mapping of a part is equal to that of the whole volume, to the last bit.
TEST(StaticRuns, Parts)
{
  std::mt19937 random(11);
  const Extent voxels{ { -7, 40, 3, 40, -20, 29 } };
  for (const int nodes : { 4, 9, 30 })
  {
    Mesh mesh = MakeLattice(glm::ivec3(nodes), glm::dvec3(-5.0, 1.0, -18.5),
      glm::dvec3(43.0, 38.0, 27.25), 0.45, 0.0, random);
    if (nodes == 4)
    {
      // Add slivers, which have a record for each run.
      const Mesh soup = MakeSoup(60, 90, -5.0, 40.0, 0.0, random);
      for (Tetrahedron tetrahedron : soup.Tetrahedra)
      {
        for (std::int32_t& node : tetrahedron)
        {
          node += static_cast<std::int32_t>(mesh.Points.size());
        }
        mesh.Tetrahedra.push_back(tetrahedron);
      }
      mesh.Points.insert(mesh.Points.end(), soup.Points.begin(), soup.Points.end());
    }
    for (const StaticMappingForm form : { StaticMappingForm::Links, StaticMappingForm::Runs })
    {
      const StaticMappingBuilder builder(
        voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, form);
      const StaticMapping whole = builder.Build();
      const std::vector<Displacer> wholeDisplacers = GetDisplacers(whole.Runs, voxels);
      std::int64_t inner = 0;
      for (const Extent& part : { Extent{ { -7, 40, 3, 40, -20, -20 } },
             Extent{ { -7, 40, 3, 22, -19, 29 } }, Extent{ { -7, 40, 23, 40, -19, 29 } } })
      {
        const StaticMapping mapping = builder.Build(part);
        inner += mapping.NumberOfInnerVoxels;
        const std::vector<Displacer> displacers = GetDisplacers(mapping.Runs, part);
        for (std::int64_t i = 0; i < GetNumberOfPoints(part); ++i)
        {
          const glm::ivec3 voxel = GetVoxel(part, i);
          const std::int64_t at =
            (static_cast<std::int64_t>(voxel.z - voxels[4]) * GetSize(voxels, 1) +
              (voxel.y - voxels[2])) *
              GetSize(voxels, 0) +
            (voxel.x - voxels[0]);
          if (form == StaticMappingForm::Runs)
          {
            EXPECT_EQ(displacers[i], wholeDisplacers[at]);
          }
          else
          {
            EXPECT_EQ(std::memcmp(&mapping.Links[i], &whole.Links[at], sizeof(VertexLink)), 0);
          }
        }
      }
      EXPECT_TRUE(inner == whole.NumberOfInnerVoxels && inner > 0);
    }
  }
}

// By runs and by links every voxel has the same tetrahedron, and the same weights up to rounding.
void Compare(const Mesh& mesh, const Extent& voxels)
{
  const StaticMapping byLinks = Build(mesh, voxels, StaticMappingForm::Links);
  const StaticMapping byRuns = Build(mesh, voxels, StaticMappingForm::Runs);
  EXPECT_TRUE(byLinks.Runs.RowBegins.empty() && byRuns.Links.empty());
  EXPECT_EQ(byRuns.NumberOfInnerVoxels, byLinks.NumberOfInnerVoxels);
  EXPECT_EQ(byRuns.NumberOfFlatTetrahedra, byLinks.NumberOfFlatTetrahedra);
  const VertexRuns& runs = byRuns.Runs;
  VoxelGrid voxelGrid;
  voxelGrid.VertexExtent = voxels;
  CheckRuns(runs, voxelGrid, mesh.Tetrahedra.size());
  const std::int64_t size = GetSize(voxels, 0);
  std::set<std::int32_t> used;
  for (std::size_t row = 0; row + 1 < runs.RowBegins.size(); ++row)
  {
    for (std::uint32_t i = runs.RowBegins[row]; i < runs.RowBegins[row + 1]; ++i)
    {
      const bool last = i + 1 == runs.RowBegins[row + 1];
      const std::int64_t end = last ? size : runs.Runs[i + 1].Begin;
      const std::int32_t record = runs.Runs[i].Tetrahedron;
      const RestTetrahedron rest = record < 0 ? RestTetrahedron() : runs.Tetrahedra[record];
      for (std::int64_t x = runs.Runs[i].Begin; x < end; ++x)
      {
        const std::int64_t voxel = static_cast<std::int64_t>(row) * size + x;
        const VertexLink& link = byLinks.Links[voxel];
        EXPECT_EQ(link.Tetrahedron, record < 0 ? -1 : rest.Tetrahedron);
        const glm::ivec3 local =
          GetVoxel(voxels, voxel) - glm::ivec3(voxels[0], voxels[2], voxels[4]);
        for (int k = 0; k < 3 && record >= 0; ++k)
        {
          double weight = rest.Weights[k];
          double magnitude = std::abs(weight);
          for (int axis = 0; axis < 3; ++axis)
          {
            const double term = rest.Gradients[k][axis] * (local[axis] - rest.Origin[axis]);
            weight += term;
            magnitude += std::abs(term);
          }
          // Rounding to float, and rounding of sums in double precision.
          EXPECT_LE(std::abs(weight - link.Weights[k]),
            std::ldexp(std::abs(weight), -24) + 1e-12 * magnitude + 1e-9);
        }
      }
      // Neighboring runs have different tetrahedra: otherwise they would be one run.
      EXPECT_TRUE(last || record < 0 || runs.Runs[i + 1].Tetrahedron < 0 ||
        runs.Tetrahedra[runs.Runs[i + 1].Tetrahedron].Tetrahedron != rest.Tetrahedron);
      EXPECT_TRUE(last || record >= 0 || runs.Runs[i + 1].Tetrahedron >= 0);
      if (record >= 0)
      {
        const bool sliver = GetWeightVariation(rest, mesh, voxels) > LargestWeightVariation;
        const bool first = used.insert(record).second;
        EXPECT_TRUE(!sliver || first);
        // Records are in the order of the voxels. The origin of a sliver's record is in its run.
        EXPECT_TRUE(!first || record + 1 == static_cast<std::int32_t>(used.size()));
        EXPECT_TRUE(!sliver || rest.Origin[0] == runs.Runs[i].Begin);
        CheckOrigin(rest, voxels);
      }
    }
  }
  EXPECT_EQ(used.size(), runs.Tetrahedra.size());
  std::set<std::int32_t> owners;
  for (const RestTetrahedron& rest : runs.Tetrahedra)
  {
    EXPECT_TRUE(owners.insert(rest.Tetrahedron).second ||
      GetWeightVariation(rest, mesh, voxels) > LargestWeightVariation);
  }
}

TEST(StaticRuns, Misuse)
{
  std::mt19937 random(1);
  const Mesh mesh = MakeLattice({ 3, 3, 3 }, glm::dvec3(0.0), glm::dvec3(9.0), 0.0, 0.0, random);
  const Extent voxels{ { 0, 9, 0, 9, 0, 9 } };
  EXPECT_TRUE(IsRefused(
    [&]()
    {
      BuildStaticMapping(
        voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, true, StaticMappingForm::Runs);
    },
    "extrapolated"));
  EXPECT_TRUE(IsRefused(
    [&]()
    {
      Mesh far = mesh;
      far.Points[13].y = 1e10;
      Build(far, voxels, StaticMappingForm::Automatic);
    },
    "units"));
  for (const StaticMappingForm form : { StaticMappingForm::Automatic, StaticMappingForm::Runs })
  {
    const StaticMapping nothing = Build(mesh, Extent{ { 0, -1, 0, 4, 0, 4 } }, form);
    EXPECT_TRUE(nothing.Links.empty() && nothing.Runs.Runs.empty());
    for (const Mesh& apart :
      { Mesh(), MakeLattice({ 2, 2, 2 }, glm::dvec3(20.0), glm::dvec3(30.0), 0.0, 0.0, random) })
    {
      const StaticMapping outside = Build(apart, voxels, form);
      EXPECT_TRUE(outside.NumberOfInnerVoxels == 0 && outside.Links.empty());
      EXPECT_TRUE(outside.Runs.Runs.size() == 100 && outside.Runs.Tetrahedra.empty());
      EXPECT_TRUE(std::all_of(outside.Runs.Runs.begin(), outside.Runs.Runs.end(),
        [](const VertexRun& run) { return run.Tetrahedron == -1 && run.Begin == 0; }));
    }
  }
  CheckProgress(
    [&](const std::function<bool(double)>& progress)
    {
      BuildStaticMapping(voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false,
        StaticMappingForm::Runs, progress);
    });
}

TEST(StaticRuns, AgainstLinks)
{
  std::mt19937 random(2);
  const double unit = 1.0 / 256.0;
  const Extent voxels{ { -5, 12, 3, 21, -20, -2 } };
  const glm::dvec3 min(-5.0, 3.0, -20.0);
  const glm::dvec3 max(12.0, 21.0, -2.0);
  for (const double jitter : { 0.0, 0.2, 0.45 })
  {
    Compare(MakeLattice({ 5, 4, 6 }, min, max, jitter, unit, random), voxels);
    Compare(MakeLattice({ 2, 3, 2 }, min, max, jitter, 0.0, random), voxels);
  }
  // Rows outside the mesh, holes, and runs of one voxel; nodes at voxels; meshes that are folded,
  // flat or overlapping.
  Compare(MakeLattice({ 4, 5, 4 }, min - 7.3, max + 5.1, 0.3, unit, random), voxels);
  Compare(MakeLattice({ 4, 5, 4 }, min + 2.6, max - 4.9, 0.3, 0.0, random), voxels);
  Compare(MakeLattice({ 9, 9, 9 }, min + 5.5, min + 8.0, 0.3, 0.0, random), voxels);
  Compare(MakeLattice({ 6, 6, 6 }, min, max, 1.4, 1.0, random), voxels);
  Compare(MakeSoup(40, 120, -8.0, 24.0, 1.0, random), voxels);
  Compare(MakeSoup(200, 60, -30.0, 30.0, 0.0, random), voxels);
  Compare(MakeSoup(200, 80, -3100.0, 3100.0, unit, random), voxels);
  Compare(MakeSoup(200, 80, -2.0e9, 2.0e9, 1.0, random), voxels);
  // Several tiles on y and z, of which the last ones are narrower; one row and one column of tiles.
  for (const Extent& many : { Extent{ { 0, 4, 0, 40, 0, 37 } }, Extent{ { 0, 70, 5, 1300, 7, 8 } },
         Extent{ { -3, 9, -1, 0, -500, 600 } } })
  {
    const glm::dvec3 first(many[0], many[2], many[4]);
    const glm::dvec3 end(many[1], many[3], many[5]);
    Compare(MakeLattice({ 3, 6, 5 }, first, end, 0.4, 0.0, random), many);
    Compare(MakeLattice({ 4, 3, 3 }, first + 0.3, end - 1.2, 0.4, 0.0, random), many);
  }
}

// A layer of slivers between two planes that are close together: each run has its own record.
TEST(StaticRuns, Slivers)
{
  const Extent voxels{ { 0, 40, 0, 30, 0, 20 } };
  for (const double height : { 0.1, 0.03 })
  {
    std::mt19937 random(3);
    Mesh mesh =
      MakeLattice({ 3, 3, 2 }, glm::dvec3(0.0), glm::dvec3(40.0, 30.0, height), 0.0, 0.0, random);
    for (glm::dvec3& point : mesh.Points)
    {
      point.z += 0.25 * point.x + 0.2 * point.y; // through some voxels
    }
    Compare(mesh, voxels);
    const StaticMapping mapping = Build(mesh, voxels, StaticMappingForm::Runs);
    EXPECT_GT(mapping.NumberOfInnerVoxels, 0);
    EXPECT_GT(mapping.Runs.Tetrahedra.size(), mesh.Tetrahedra.size());
    const auto inner = std::count_if(mapping.Runs.Runs.begin(), mapping.Runs.Runs.end(),
      [](const VertexRun& run) { return run.Tetrahedron >= 0; });
    EXPECT_EQ(mapping.Runs.Tetrahedra.size(), static_cast<std::size_t>(inner));
  }
}

TEST(StaticRuns, Choice)
{
  std::mt19937 random(4);
  const Extent voxels{ { 0, 95, 0, 79, 0, 69 } };
  const glm::dvec3 max(95.0, 79.0, 69.0);
  for (const int nodes : { 3, 7, 13, 20, 31 })
  {
    const Mesh mesh = MakeLattice(glm::ivec3(nodes), glm::dvec3(0.0), max, 0.2, 0.0, random);
    const StaticMapping runs = Build(mesh, voxels, StaticMappingForm::Runs);
    const double mean =
      static_cast<double>(GetNumberOfPoints(voxels)) / static_cast<double>(runs.Runs.Runs.size());
    const StaticMappingBuilder builder(voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false);
    std::cout << nodes << " nodes on each axis: mean run length " << mean << ", "
              << static_cast<double>(GetBytes(runs.Runs)) / GetNumberOfPoints(voxels)
              << " bytes a voxel, estimated "
              << static_cast<double>(builder.GetRunBytes()) / GetNumberOfPoints(voxels) << "\n";
    if (std::abs(mean - LeastMeanRunLength) > 0.3)
    {
      EXPECT_EQ(builder.GetRunBytes() > 0, mean > LeastMeanRunLength);
    }
    const StaticMapping chosen = builder.Build();
    EXPECT_EQ(chosen.Links.empty(), builder.GetRunBytes() > 0);
    EXPECT_EQ(chosen.Runs.Runs.empty(), builder.GetRunBytes() == 0);
    if (builder.GetRunBytes() > 0)
    {
      const double ratio = static_cast<double>(builder.GetRunBytes()) / GetBytes(runs.Runs);
      EXPECT_TRUE(ratio > 0.8 && ratio < 1.25);
      EXPECT_LT(GetBytes(runs.Runs), 6 * static_cast<std::uint64_t>(GetNumberOfPoints(voxels)));
    }
    // With extrapolation, links are chosen for any mesh.
    const StaticMapping extrapolated = BuildStaticMapping(
      voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, true, StaticMappingForm::Automatic);
    EXPECT_TRUE(extrapolated.Runs.Runs.empty() && !extrapolated.Links.empty());
  }
}

TEST(StaticRuns, Threads)
{
  std::mt19937 random(6);
  const Extent voxels{ { 0, 40, -50, 9, 5, 70 } };
  const Mesh mesh = MakeSoup(400, 100, -20.0, 60.0, 0.0, random);
  const auto build = [&]()
  {
    const StaticMappingBuilder builder(
      voxels, UnitSpacing, mesh.Points, mesh.Tetrahedra, false, StaticMappingForm::Runs);
    return std::make_pair(Build(mesh, voxels, StaticMappingForm::Runs), builder.GetRunBytes());
  };
  const auto [expected, bytes] = CallOnThreads<1>(build);
  EXPECT_GT(expected.NumberOfInnerVoxels, 0);
  const VertexRuns& b = expected.Runs;
  for (const auto& [mapping, bytesNow] : { CallOnThreads<2>(build), CallOnThreads<4>(build) })
  {
    const VertexRuns& a = mapping.Runs;
    EXPECT_EQ(bytesNow, bytes);
    ASSERT_TRUE(a.RowBegins == b.RowBegins && a.Runs.size() == b.Runs.size());
    EXPECT_EQ(std::memcmp(a.Runs.data(), b.Runs.data(), a.Runs.size() * sizeof(VertexRun)), 0);
    ASSERT_EQ(a.Tetrahedra.size(), b.Tetrahedra.size());
    for (std::size_t i = 0; i < a.Tetrahedra.size(); ++i)
    {
      EXPECT_TRUE(a.Tetrahedra[i].Tetrahedron == b.Tetrahedra[i].Tetrahedron &&
        a.Tetrahedra[i].Origin == b.Tetrahedra[i].Origin &&
        a.Tetrahedra[i].Weights == b.Tetrahedra[i].Weights &&
        a.Tetrahedra[i].Gradients == b.Tetrahedra[i].Gradients);
    }
  }
}

} // namespace
