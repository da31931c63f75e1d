// SPDX-License-Identifier: BSD-3-Clause
// A slow implementation of ChainMail: shortest paths over all links, without blocks, marks or
// pruning. It shares no code with the engine except for the types of its interface.
#ifndef ChainMailReference_h
#define ChainMailReference_h

#include "ChainMailTypes.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// A link between two voxels, by their numbers. axis: of the step from the first voxel to the
/// second one.
struct ReferenceLink
{
  std::size_t First;
  std::size_t Second;
  int Axis;
};

class ChainMailReference
{
public:
  ChainMailReference(const deformvolume::Extent& extent, const std::array<double, 3>& spacing);

  // Tests may change these members at any time. Call FindLinks() after a change of Active.
  std::vector<deformvolume::ChainMailMaterial> Table{ deformvolume::ChainMailMaterial() };
  std::vector<unsigned char> Materials; // of each voxel
  std::vector<unsigned char> Active;    // of each cell
  std::vector<unsigned char> Pinned;    // of each voxel

  /// Finds the links of the active tetrahedra.
  void FindLinks();
  const std::vector<ReferenceLink>& GetLinks() const { return this->Links; }
  std::size_t GetNumberOfVoxels() const { return this->Materials.size(); }
  std::size_t GetVoxel(int i, int j, int k) const;

  /// Moves handles, in their order.
  std::vector<deformvolume::ChainMailHandleReport> Step(
    const std::vector<deformvolume::ChainMailHandle>& handles);
  /// Returns the displacements after some sweeps of relaxation, in 1/65536 voxel, not rounded.
  /// Voxels that are pinned or held by handles do not relax. Does not change Displacements.
  std::vector<std::array<double, 3>> Relax(
    int sweeps, const std::vector<deformvolume::ChainMailHandle>& handles) const;
  void Reset() { this->Displacements.assign(this->Displacements.size(), { { 0, 0, 0 } }); }

  /// The displacement of each voxel, in 1/65536 voxel.
  std::vector<std::array<std::int64_t, 3>> Displacements;
  /// Returns the largest violation of a limit. displacements: in voxels, three numbers per voxel.
  double GetViolation(const std::vector<float>& displacements) const;
  bool IsViolated() const;

  /// How much greater and how much smaller the displacement of the second voxel of a link may be
  /// than that of the first one.
  std::array<std::int64_t, 2> GetLimits(const ReferenceLink& link, int component) const;

private:
  double GetSmallestRange() const;
  /// The weight of a link in the mean of displacements: an integer from 1 to 255.
  double GetWeight(const ReferenceLink& link, int component, double smallestRange) const;
  std::vector<std::int64_t> FindWays(
    const std::vector<std::size_t>& from, int component, bool upwards) const;
  std::vector<std::size_t> Select(const deformvolume::ChainMailHandle& handle) const;

  deformvolume::Extent Extent;
  std::array<double, 3> Spacing;
  std::array<int, 3> Size;
  std::vector<ReferenceLink> Links;
  std::vector<char> Elements;
};

#endif
