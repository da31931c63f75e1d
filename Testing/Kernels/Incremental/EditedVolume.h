// SPDX-License-Identifier: BSD-3-Clause
// A volume in a grid of nodes that tests move step by step, and two deformers of it. One deformer
// resamples the whole output each time. The other one updates its last output.
#ifndef EditedVolume_h
#define EditedVolume_h

#include "DeformerCase.h"
#include "DeviceNeeds.h"
#include "TimeAllowance.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

/// A volume of several bricks, and a grid of nodes around it. Each cell of the grid is divided into
/// six tetrahedra. Each of them follows one path along edges from the lowest to the highest corner
/// of the cell, with its own order of the axes.
struct EditedVolume
{
  static constexpr int Step = 8; // voxels between nodes

  deformvolume::VoxelGrid Shape;
  std::array<int, 3> Nodes;
  std::vector<deformvolume::Tetrahedron> Tetrahedra;
  std::vector<deformvolume::VertexLink> Links;
  deformvolume::VertexRuns Runs;
  std::vector<float> Displacements;
  UsualArrays Arrays{ 0 };
  std::vector<unsigned char> Blanked;
  std::vector<unsigned char> Active;
  std::vector<float> Distances;
  std::vector<unsigned char> Crossed; // by a smooth cut
  std::vector<float> CutDistances;
  deformvolume::Extent Output;
  double Background = 3.0;
  deformvolume::Resampling Method = deformvolume::Resampling::Exact;
  deformvolume::Interpolation Interpolation = deformvolume::Interpolation::Linear;

  /// hasCorner: whether a corner of the volume is outside the mesh.
  explicit EditedVolume(
    const deformvolume::Extent& extent = { { -5, 140, 0, 50, 3, 40 } }, bool hasCorner = true);

  /// Nodes of the grid, and copies that Split() added.
  std::size_t GetNumberOfNodes() const;
  std::int32_t GetNode(const std::array<int, 3>& place) const;
  std::vector<deformvolume::VolumeArray> GetArrays() const;

  /// The displacements as a field.
  deformvolume::DisplacementField GetField() const;

  void SendAll(deformvolume::VolumeDeformer& deformer, Route route) const;
  void SendMasks(deformvolume::VolumeDeformer& deformer) const;
  void SendDisplacements(deformvolume::VolumeDeformer& deformer, Route route,
    const deformvolume::PointRanges* changes = nullptr) const;

  /// The ranges of points whose displacements differ from `last`, and a few other points.
  deformvolume::PointRanges FindChanges(const std::vector<float>& last, std::mt19937& random) const;

  /// Moves the nodes within a radius of a random node by up to `amount` voxels. A radius of 0 moves
  /// one node.
  void Move(std::mt19937& random, int radius, float amount);
  /// Moves a random node in the middle of the grid.
  void MoveInside(std::mt19937& random, float amount);

  /// Gives up to `reach` tetrahedra copies of some of their nodes, with other displacements.
  std::vector<deformvolume::TetrahedronChange> Split(std::mt19937& random, int reach);

  /// Makes a smooth cut along a plane. It cuts cells with a y index below `end`, counted from the
  /// first voxel.
  void CutAlong(double place, double slope, int end);
  /// In a random box, either copies the crossed tetrahedra from an array or joins the cut, and
  /// moves the sheet. Does nothing if there is no cut.
  void EditCut(const std::vector<unsigned char>& crossed, std::mt19937& random);

private:
  void MakeTetrahedra();
  void MakeLinks(bool hasCorner);
  void AddVoxel(const std::array<int, 3>& voxel, bool linked, std::vector<std::int32_t>& records,
    std::int32_t& last);
  void MoveRound(const std::array<int, 3>& center, std::mt19937& random, int radius, float amount);
};

/// The name of a test's route.
inline std::string GetRouteName(const testing::TestParamInfo<Route>& info)
{
  return info.param == Route::Mesh ? "Links" : info.param == Route::Runs ? "Runs" : "Field";
}

/// A route, and a method: the default kernel of the device, or the kernel by cells.
using Way = std::tuple<Route, deformvolume::Resampling>;
inline std::string GetWayName(const testing::TestParamInfo<Way>& info)
{
  return GetRouteName({ std::get<0>(info.param), info.index }) +
    (std::get<1>(info.param) == deformvolume::Resampling::ExactByCell ? "ByCell" : "");
}
inline auto GetWays()
{
  return testing::Combine(testing::Values(Route::Mesh, Route::Runs, Route::Field),
    testing::Values(deformvolume::Resampling::Exact, deformvolume::Resampling::ExactByCell));
}

/// A test with a Way as its parameter.
class WayTest : public testing::TestWithParam<Way>
{
protected:
  static Route GetRoute() { return std::get<0>(GetParam()); }
  static deformvolume::Resampling GetMethod() { return std::get<1>(GetParam()); }
  template <typename... Arguments>
  static EditedVolume MakeVolume(const Arguments&... arguments)
  {
    EditedVolume volume(arguments...);
    volume.Method = GetMethod();
    return volume;
  }
  /// Reduces a number of edits to limit the time of a test. Tests by cells have fewer edits. Tests
  /// on graphics cards have the fewest, because their whole outputs are also computed by cells.
  static int GetNumberOf(int edits)
  {
    constexpr int byCell = 7;
    constexpr int onGraphics = 8;
    return !HasVectors()                               ? edits / onGraphics
      : GetMethod() == deformvolume::Resampling::Exact ? GetNumberOfCases(edits)
                                                       : edits / byCell;
  }
};

/// Outputs of an EditedVolume.
struct EditedOutputs
{
  std::vector<std::int16_t> Shorts;
  std::vector<float> Floats;
  std::vector<std::uint16_t> Labels; // two per voxel
  std::vector<signed char> Coverage;

  explicit EditedOutputs(const EditedVolume& volume);

  deformvolume::DeformRequest MakeRequest(const EditedVolume& volume);
  /// Declares these outputs to be the last output of a request.
  void SetLast(deformvolume::DeformRequest& request) const;
  bool operator==(const EditedOutputs& other) const;
};

/// Expects two reports to describe the same output.
void ExpectSame(const deformvolume::DeformReport& report, const deformvolume::DeformReport& wanted);

/// Two deformers. The second one updates its last output, in place.
struct Twins
{
  deformvolume::VolumeDeformer Whole;
  deformvolume::VolumeDeformer Updated;
  std::unique_ptr<EditedOutputs> Last;
  deformvolume::DeformReport WholeReport;
  deformvolume::DeformReport UpdatedReport;

  void SendAll(const EditedVolume& volume, Route route);
  /// Deforms with both, after displacements have changed, and expects the same results.
  void Deform(const EditedVolume& volume, Route route);
  /// Whether the last update resampled only a part of the bricks.
  bool IsPart() const;
};

#endif
