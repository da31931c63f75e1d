// SPDX-License-Identifier: BSD-3-Clause
// ChainMail done slowly: shortest ways over all links, without blocks, marks or pruning. It shares
// no code with the engine, but for the types of its interface.
#ifndef ChainMailReference_h
#define ChainMailReference_h

#include "ChainMailTypes.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// A link between two voxels, by their numbers; axis: of the step from the first to the second.
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

  // To be changed by tests at will; FindLinks() follows.
  std::vector<deformvolume::ChainMailMaterial> Table{ deformvolume::ChainMailMaterial() };
  std::vector<unsigned char> Materials; // of each voxel
  std::vector<unsigned char> Active;    // of each cell
  std::vector<unsigned char> Pinned;    // of each voxel

  /// Which links the active tetrahedra leave.
  void FindLinks();
  const std::vector<ReferenceLink>& GetLinks() const { return this->Links; }
  bool IsElement(std::size_t voxel) const { return this->Elements[voxel]; }
  std::size_t GetNumberOfVoxels() const { return this->Materials.size(); }
  std::size_t GetVoxel(int i, int j, int k) const;

  /// Moves handles, in order.
  std::vector<deformvolume::ChainMailHandleReport> Step(
    const std::vector<deformvolume::ChainMailHandle>& handles);
  /// Displacements after so many sweeps of relaxation of all voxels but those that the handles hold
  /// and those that are pinned, in 1/65536 voxel. They are not rounded, and Displacements stay as
  /// they are.
  std::vector<std::array<double, 3>> Relax(
    int sweeps, const std::vector<deformvolume::ChainMailHandle>& handles) const;
  void Reset() { this->Displacements.assign(this->Displacements.size(), { { 0, 0, 0 } }); }

  /// In 1/65536 voxel.
  std::vector<std::array<std::int64_t, 3>> Displacements;
  /// The largest violation of displacements in voxels, three numbers a voxel.
  double GetViolation(const std::vector<float>& displacements) const;
  bool IsViolated() const;

  /// How much more the second voxel of a link may have than the first one, and how much less.
  std::array<std::int64_t, 2> GetLimits(const ReferenceLink& link, int component) const;

private:
  double GetSmallestRange() const;
  /// How much a link counts in a mean of displacements: a whole number from 1 to 255.
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
