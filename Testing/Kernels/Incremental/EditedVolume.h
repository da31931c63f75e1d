// SPDX-License-Identifier: BSD-3-Clause
// A volume in a grid of nodes that are moved bit by bit, and two deformers of it, of which one does
// all anew each time and one updates what it made last.
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

/// A volume of several bricks, and a grid of nodes round it. Each cell of the grid is split into
/// six tetrahedra, one for each order of the axes: along a way from its lowest to its highest
/// corner.
struct EditedVolume
{
  static constexpr int Step = 8; // voxels between nodes

  deformvolume::VoxelGrid Shape;
  std::array<int, 3> Nodes;
  std::vector<deformvolume::Tetrahedron> Tetrahedra;
  std::vector<deformvolume::VertexLink> Links;
  deformvolume::VertexRuns Runs;
  std::vector<float> Displacements;
  std::vector<std::uint16_t> First;
  std::vector<double> Second;
  std::vector<unsigned char> Blanked;
  std::vector<unsigned char> Active;
  std::vector<float> Distances;
  std::vector<unsigned char> Crossed; // of a smooth cut
  std::vector<float> CutDistances;
  deformvolume::Extent Output;
  double Background = 3.0;
  deformvolume::Resampling Method = deformvolume::Resampling::Exact;
  deformvolume::Interpolation Interpolation = deformvolume::Interpolation::Linear;

  /// hasCorner: whether a corner of the volume is outside the mesh.
  explicit EditedVolume(
    const deformvolume::Extent& extent = { { -5, 140, 0, 50, 3, 40 } }, bool hasCorner = true);

  /// Those of the grid, and copies of them.
  std::size_t GetNumberOfNodes() const;
  std::int32_t GetNode(const std::array<int, 3>& place) const;
  std::vector<deformvolume::VolumeArray> GetArrays() const;

  /// The displacements as a field.
  deformvolume::DisplacementField GetField() const;

  void SendAll(deformvolume::VolumeDeformer& deformer, Route route) const;
  void SendMasks(deformvolume::VolumeDeformer& deformer) const;
  void SendDisplacements(deformvolume::VolumeDeformer& deformer, Route route,
    const deformvolume::PointRanges* changes = nullptr) const;

  /// Where the displacements are not those, and a few points more.
  deformvolume::PointRanges FindChanges(const std::vector<float>& last, std::mt19937& random) const;

  /// Moves nodes round one by up to so many voxels; a radius of 0 moves one node.
  void Move(std::mt19937& random, int radius, float amount);
  /// Moves a node in the middle.
  void MoveInside(std::mt19937& random, float amount);

  /// Gives tetrahedra near one new nodes in place of some of theirs, displaced otherwise.
  std::vector<deformvolume::TetrahedronChange> Split(std::mt19937& random, int reach);

  /// A smooth cut along a plane, through all of the volume or up to a y, counted from the first
  /// voxel.
  void CutAlong(double place, double slope, int end);
  /// In a box takes over what is crossed, or joins it again, and moves the sheet. Nothing where
  /// there is no cut.
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

/// A route, and the kernel: that of the device's choice, or the one by cell.
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

/// A test of a way.
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
  /// How many edits there are time for, of some: fewer by cell, and fewest on a graphics card,
  /// where whole outputs are made by cell as well.
  static int GetNumberOf(int edits)
  {
    constexpr int byCell = 7;
    constexpr int onGraphics = 8;
    return !HasVectors()                               ? edits / onGraphics
      : GetMethod() == deformvolume::Resampling::Exact ? GetNumberOfCases(edits)
                                                       : edits / byCell;
  }
};

/// What becomes of an EditedVolume.
struct EditedOutputs
{
  std::vector<std::uint16_t> First;
  std::vector<double> Second;
  std::vector<signed char> Coverage;

  explicit EditedOutputs(const EditedVolume& volume);

  deformvolume::DeformRequest MakeRequest(const EditedVolume& volume);
  /// Tells a request that this is the last output.
  void SetLast(deformvolume::DeformRequest& request) const;
  bool operator==(const EditedOutputs& other) const;
};

/// Expects two reports to tell the same of an output.
void ExpectSame(const deformvolume::DeformReport& report, const deformvolume::DeformReport& wanted);

/// Two deformers, one of which updates what it made last, in place.
struct Twins
{
  deformvolume::VolumeDeformer Whole;
  deformvolume::VolumeDeformer Updated;
  std::unique_ptr<EditedOutputs> Last;
  deformvolume::DeformReport WholeReport;
  deformvolume::DeformReport UpdatedReport;

  void SendAll(const EditedVolume& volume, Route route);
  /// After displacements have changed. Expects the same of both.
  void Deform(const EditedVolume& volume, Route route);
  /// Whether the last one ran a part of the bricks only.
  bool IsPart() const;
};

#endif
