// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeToolPath_h
#define DeformVolumeToolPath_h

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace deformvolume
{

/// Positions of a tool, and the positions along which the tool has already been moved.
class ToolPath
{
public:
  /// The two ends of the tool; for a sphere both are its center.
  using Position = std::array<glm::dvec3, 2>;

  void Add(const Position& position) { this->Positions.push_back(position); }
  /// Removes all positions. The next ones begin a new stroke.
  void Clear()
  {
    this->Positions.clear();
    this->Done.clear();
  }
  /// Removes all positions. The next ones continue the last stroke if they begin with its
  /// positions.
  void ClearForSameStroke() { this->Positions.clear(); }
  std::size_t GetNumberOfPositions() const { return this->Positions.size(); }

  /// The positions along which the tool has to be moved: from the last finished position on if
  /// the positions begin with the finished ones, otherwise all. Empty: none is new.
  std::vector<Position> GetStroke() const
  {
    const std::vector<Position>& all = this->Positions;
    const std::size_t done = this->Done.size();
    if (done == 0 || done > all.size() ||
      !std::equal(this->Done.begin(), this->Done.end(), all.begin()))
    {
      return all;
    }
    if (done == all.size())
    {
      return {};
    }
    return { all.begin() + static_cast<std::ptrdiff_t>(done) - 1, all.end() };
  }
  /// Marks all positions as done.
  void Finish() { this->Done = this->Positions; }
  /// Marks no position as done.
  void Restart() { this->Done.clear(); }

private:
  std::vector<Position> Positions;
  std::vector<Position> Done;
};

} // namespace deformvolume

#endif
