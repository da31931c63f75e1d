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

/// Positions of a tool, and which of them it has been taken along already.
class ToolPath
{
public:
  /// The two ends of the tool; of a sphere both are its centre.
  using Position = std::array<glm::dvec3, 2>;

  void Add(const Position& position) { this->Positions.push_back(position); }
  void Clear() { this->Positions.clear(); }
  std::size_t GetNumberOfPositions() const { return this->Positions.size(); }

  /// Positions between which the tool has not been: from the last one where it was on, or all where
  /// these do not continue those before. Empty: nothing is new.
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
  /// The tool has been at all positions.
  void Finish() { this->Done = this->Positions; }
  /// The tool has been nowhere yet.
  void Restart() { this->Done.clear(); }

private:
  std::vector<Position> Positions;
  std::vector<Position> Done;
};

} // namespace deformvolume

#endif
