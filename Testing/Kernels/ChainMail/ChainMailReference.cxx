// SPDX-License-Identifier: BSD-3-Clause
#include "ChainMailReference.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

using namespace deformvolume;

namespace
{

constexpr std::int64_t Units = 65536;
constexpr std::int64_t Far = std::int64_t{ 1 } << 50;

// The tetrahedra of a cell, with its vertices numbered 1 to 8 as in the literature.
constexpr int Tetrahedra[5][4] = { { 1, 3, 4, 7 }, { 7, 8, 4, 6 }, { 4, 2, 1, 6 }, { 1, 5, 7, 6 },
  { 7, 4, 6, 1 } };
constexpr int Offsets[8][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 0, 1, 0 },
  { 1, 1, 0 }, { 0, 1, 1 }, { 1, 1, 1 } };

std::int64_t ToUnits(double limit)
{
  return static_cast<std::int64_t>(std::floor(limit * static_cast<double>(Units) + 1e-6));
}

} // namespace

ChainMailReference::ChainMailReference(
  const deformvolume::Extent& extent, const std::array<double, 3>& spacing)
  : Extent(extent)
  , Spacing(spacing)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Size[axis] = extent[2 * axis + 1] - extent[2 * axis] + 1;
  }
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(extent));
  this->Materials.resize(voxels);
  this->Pinned.resize(voxels);
  this->Active.assign(static_cast<std::size_t>(GetNumberOfCells(extent)), 31);
  this->Displacements.assign(voxels, { { 0, 0, 0 } });
  this->FindLinks();
}

std::size_t ChainMailReference::GetVoxel(int i, int j, int k) const
{
  return static_cast<std::size_t>(i + this->Size[0] * (j + this->Size[1] * k));
}

void ChainMailReference::FindLinks()
{
  std::map<std::pair<std::size_t, std::size_t>, int> found;
  this->Elements.assign(this->GetNumberOfVoxels(), 0);
  std::size_t cell = 0;
  for (int k = 0; k + 1 < this->Size[2]; ++k)
  {
    for (int j = 0; j + 1 < this->Size[1]; ++j)
    {
      for (int i = 0; i + 1 < this->Size[0]; ++i, ++cell)
      {
        const int at[3] = { i, j, k };
        for (int t = 0; t < 5; ++t)
        {
          if (!(this->Active[cell] >> t & 1))
          {
            continue;
          }
          int corners[4][3];
          for (int v = 0; v < 4; ++v)
          {
            for (int axis = 0; axis < 3; ++axis)
            {
              const int offset = Offsets[Tetrahedra[t][v] - 1][axis];
              const bool isOdd = (this->Extent[2 * axis] + at[axis]) % 2 != 0;
              corners[v][axis] = at[axis] + (isOdd ? 1 - offset : offset);
            }
            this->Elements[this->GetVoxel(corners[v][0], corners[v][1], corners[v][2])] = 1;
          }
          for (int v = 0; v < 4; ++v)
          {
            for (int w = 0; w < 4; ++w)
            {
              int axis = -1;
              int steps = 0;
              for (int a = 0; a < 3; ++a)
              {
                steps += std::abs(corners[w][a] - corners[v][a]);
                axis = corners[w][a] - corners[v][a] == 1 ? a : axis;
              }
              if (steps == 1 && axis >= 0)
              {
                found[{ this->GetVoxel(corners[v][0], corners[v][1], corners[v][2]),
                  this->GetVoxel(corners[w][0], corners[w][1], corners[w][2]) }] = axis;
              }
            }
          }
        }
      }
    }
  }
  this->Links.clear();
  for (const auto& link : found)
  {
    this->Links.push_back({ link.first.first, link.first.second, link.second });
  }
}

std::array<std::int64_t, 2> ChainMailReference::GetLimits(
  const ReferenceLink& link, int component) const
{
  const ChainMailMaterial& a = this->Table[this->Materials[link.First]];
  const ChainMailMaterial& b = this->Table[this->Materials[link.Second]];
  if (link.Axis == component)
  {
    // The mean, rounded to the stricter limit.
    return { { (ToUnits(a.MaximumStretch - 1.0) + ToUnits(b.MaximumStretch - 1.0)) / 2,
      (ToUnits(1.0 - a.MinimumStretch) + ToUnits(1.0 - b.MinimumStretch)) / 2 } };
  }
  const double ratio = this->Spacing[link.Axis] / this->Spacing[component];
  const std::int64_t shear = (ToUnits(a.Shear * ratio) + ToUnits(b.Shear * ratio)) / 2;
  return { { shear, shear } };
}

// Returns the sums of limits along the shortest paths: how much greater (upwards) or smaller the
// displacement of each voxel may be than that of the voxels `from`.
std::vector<std::int64_t> ChainMailReference::FindWays(
  const std::vector<std::size_t>& from, int component, bool upwards) const
{
  std::vector<std::int64_t> ways(this->GetNumberOfVoxels(), Far);
  for (const std::size_t voxel : from)
  {
    ways[voxel] = 0;
  }
  for (bool changed = true; changed;)
  {
    changed = false;
    for (const ReferenceLink& link : this->Links)
    {
      const std::array<std::int64_t, 2> limits = this->GetLimits(link, component);
      const std::int64_t there = ways[link.First] + (upwards ? limits[0] : limits[1]);
      const std::int64_t back = ways[link.Second] + (upwards ? limits[1] : limits[0]);
      changed = changed || there < ways[link.Second] || back < ways[link.First];
      ways[link.Second] = std::min(ways[link.Second], there);
      ways[link.First] = std::min(ways[link.First], back);
    }
  }
  return ways;
}

std::vector<std::size_t> ChainMailReference::Select(const ChainMailHandle& handle) const
{
  std::vector<std::size_t> voxels;
  std::size_t nearest = 0;
  double least = 1e300;
  for (int k = 0; k < this->Size[2]; ++k)
  {
    for (int j = 0; j < this->Size[1]; ++j)
    {
      for (int i = 0; i < this->Size[0]; ++i)
      {
        const int at[3] = { i, j, k };
        double world = 0.0;
        double index = 0.0;
        for (int axis = 0; axis < 3; ++axis)
        {
          const double d = at[axis] + this->Extent[2 * axis] - handle.RestPosition[axis];
          index += d * d;
          world += d * d * this->Spacing[axis] * this->Spacing[axis];
        }
        if (index < least)
        {
          least = index;
          nearest = this->GetVoxel(i, j, k);
        }
        if (world <= handle.Radius * handle.Radius)
        {
          voxels.push_back(this->GetVoxel(i, j, k));
        }
      }
    }
  }
  if (std::find(voxels.begin(), voxels.end(), nearest) == voxels.end())
  {
    voxels.push_back(nearest);
  }
  return voxels;
}

std::vector<ChainMailHandleReport> ChainMailReference::Step(
  const std::vector<ChainMailHandle>& handles)
{
  std::vector<ChainMailHandleReport> reports(handles.size());
  std::vector<char> isFixed(this->Pinned.begin(), this->Pinned.end());
  std::vector<char> isTaken(this->GetNumberOfVoxels());
  for (std::size_t h = 0; h < handles.size(); ++h)
  {
    std::vector<std::size_t> held;
    for (const std::size_t voxel : this->Select(handles[h]))
    {
      // Voxels of an earlier handle are not available to later handles, even if the earlier handle
      // is released.
      if (this->Elements[voxel] && !this->Pinned[voxel] && !isTaken[voxel])
      {
        held.push_back(voxel);
      }
      isTaken[voxel] = 1;
    }
    reports[h].NumberOfVoxels = static_cast<std::int64_t>(held.size());
    reports[h].IsHeld = !held.empty();
    auto next = this->Displacements;
    std::array<std::int64_t, 3> targets{};
    bool isPossible = true;
    for (int c = 0; c < 3; ++c)
    {
      const auto wanted = static_cast<std::int64_t>(
        std::llround(handles[h].Displacement[c] * static_cast<double>(Units)));
      const std::vector<std::int64_t> more = this->FindWays(held, c, true);
      const std::vector<std::int64_t> less = this->FindWays(held, c, false);
      std::int64_t lowest = -Far;
      std::int64_t highest = Far;
      for (std::size_t i = 0; i < this->GetNumberOfVoxels(); ++i)
      {
        if (isFixed[i])
        {
          lowest = std::max(lowest, this->Displacements[i][c] - more[i]);
          highest = std::min(highest, this->Displacements[i][c] + less[i]);
        }
      }
      isPossible = isPossible && lowest <= highest;
      targets[c] = std::max(lowest, std::min(highest, wanted));
      reports[h].Reduction[c] =
        static_cast<double>(wanted - targets[c]) / static_cast<double>(Units);
      for (std::size_t i = 0; i < this->GetNumberOfVoxels(); ++i)
      {
        std::int64_t& x = next[i][c];
        x = more[i] < Far ? std::min(x, targets[c] + more[i]) : x;
        x = less[i] < Far ? std::max(x, targets[c] - less[i]) : x;
      }
    }
    if (!isPossible)
    {
      reports[h].IsHeld = false;
      reports[h].Reduction = { { 0, 0, 0 } };
      continue;
    }
    this->Displacements = next;
    for (const std::size_t voxel : held)
    {
      isFixed[voxel] = 1;
    }
  }
  return reports;
}

double ChainMailReference::GetSmallestRange() const
{
  double smallest = 1e300;
  for (const ChainMailMaterial& material : this->Table)
  {
    smallest = std::min(
      { smallest, material.MaximumStretch - material.MinimumStretch, 2.0 * material.Shear });
  }
  return std::max(smallest, 1.0 / 1024.0);
}

double ChainMailReference::GetWeight(
  const ReferenceLink& link, int component, double smallestRange) const
{
  const ChainMailMaterial& a = this->Table[this->Materials[link.First]];
  const ChainMailMaterial& b = this->Table[this->Materials[link.Second]];
  const double range = link.Axis == component
    ? 0.5 * (a.MaximumStretch + b.MaximumStretch - a.MinimumStretch - b.MinimumStretch)
    : a.Shear + b.Shear;
  return std::max(1.0, std::round(std::min(1.0, smallestRange / range) * 255.0));
}

std::vector<std::array<double, 3>> ChainMailReference::Relax(
  int sweeps, const std::vector<ChainMailHandle>& handles) const
{
  std::vector<char> stays(this->Pinned.begin(), this->Pinned.end());
  for (const ChainMailHandle& handle : handles)
  {
    for (const std::size_t voxel : this->Select(handle))
    {
      stays[voxel] = 1;
    }
  }
  std::vector<std::array<double, 3>> x(this->GetNumberOfVoxels());
  for (std::size_t i = 0; i < x.size(); ++i)
  {
    std::copy(this->Displacements[i].begin(), this->Displacements[i].end(), x[i].begin());
  }
  // The other end of a link of a voxel. More, Less: for each component, how much greater and
  // smaller the displacement of the voxel may be than that of the other end.
  struct End
  {
    std::size_t There;
    std::array<double, 3> More, Less, Weight;
  };
  std::vector<std::vector<End>> ends(x.size());
  const double smallestRange = this->GetSmallestRange();
  for (const ReferenceLink& link : this->Links)
  {
    End ofSecond{ link.First, {}, {}, {} };
    for (int c = 0; c < 3; ++c)
    {
      const std::array<std::int64_t, 2> limits = this->GetLimits(link, c);
      ofSecond.More[c] = static_cast<double>(limits[0]);
      ofSecond.Less[c] = static_cast<double>(limits[1]);
      ofSecond.Weight[c] = this->GetWeight(link, c, smallestRange);
    }
    ends[link.First].push_back({ link.Second, ofSecond.Less, ofSecond.More, ofSecond.Weight });
    ends[link.Second].push_back(ofSecond);
  }
  const auto relax = [&](std::size_t voxel, int c)
  {
    double pull = 0.0;
    double sum = 0.0;
    double lowest = -1e300;
    double highest = 1e300;
    for (const End& end : ends[voxel])
    {
      const double there = x[end.There][c];
      pull += end.Weight[c] * there;
      sum += end.Weight[c];
      highest = std::min(highest, there + end.More[c]);
      lowest = std::max(lowest, there - end.Less[c]);
    }
    return sum > 0.0 ? std::max(lowest, std::min(highest, pull / sum)) : x[voxel][c];
  };
  for (int turn = 0; turn < 2 * sweeps; ++turn)
  {
    for (std::size_t voxel = 0; voxel < x.size(); ++voxel)
    {
      const std::size_t i = voxel % this->Size[0];
      const std::size_t j = voxel / this->Size[0] % this->Size[1];
      const std::size_t k = voxel / this->Size[0] / this->Size[1];
      if (!stays[voxel] && static_cast<int>((i + j + k) % 2) == turn % 2)
      {
        x[voxel] = { { relax(voxel, 0), relax(voxel, 1), relax(voxel, 2) } };
      }
    }
  }
  return x;
}

double ChainMailReference::GetViolation(const std::vector<float>& displacements) const
{
  double largest = 0.0;
  for (const ReferenceLink& link : this->Links)
  {
    for (int c = 0; c < 3; ++c)
    {
      const auto component = static_cast<std::size_t>(c);
      const double difference = static_cast<double>(displacements[3 * link.Second + component]) -
        static_cast<double>(displacements[3 * link.First + component]);
      const std::array<std::int64_t, 2> limits = this->GetLimits(link, c);
      largest = std::max({ largest, difference - static_cast<double>(limits[0]) / Units,
        -difference - static_cast<double>(limits[1]) / Units });
    }
  }
  return largest;
}

bool ChainMailReference::IsViolated() const
{
  std::vector<float> displacements;
  for (const std::array<std::int64_t, 3>& x : this->Displacements)
  {
    for (const std::int64_t value : x)
    {
      displacements.push_back(static_cast<float>(value) / Units);
    }
  }
  return this->GetViolation(displacements) > 0.0;
}
