// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBoxPyramid_h
#define DeformVolumeBoxPyramid_h

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace deformvolume
{

/// Finds those of many boxes that hold a point. Boxes are sorted along a Morton curve, and four
/// that follow each other have a common box, and so on. Calls may run side by side.
class BoxPyramid
{
public:
  /// Empty, which no point lies in, until something is added.
  struct Box
  {
    glm::dvec3 Min{ std::numeric_limits<double>::infinity() };
    glm::dvec3 Max{ -std::numeric_limits<double>::infinity() };

    void Add(const glm::dvec3& point)
    {
      this->Min = glm::min(this->Min, point);
      this->Max = glm::max(this->Max, point);
    }
    bool IsEmpty() const { return !(this->Min.x <= this->Max.x); }
  };

  BoxPyramid() = default;
  /// getBox: a box by its number, under count; called twice for each, in parallel.
  BoxPyramid(std::size_t count, const std::function<Box(std::size_t)>& getBox);

  /// Calls visit(number) for all boxes that hold a point, in no certain order, and for a few that
  /// miss it by the rounding to float.
  template <typename Visitor>
  void Visit(const glm::dvec3& point, Visitor&& visit) const
  {
    // Rounding is monotonic: a point in a box stays in it.
    const glm::vec3 place(point - this->Center);
    struct Entry
    {
      std::size_t Level;
      std::size_t Number;
    };
    Entry stack[4 * MostLevels];
    int depth = 0;
    const auto enter = [&](std::size_t level, std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        if (this->Levels[level][i].Holds(place))
        {
          stack[depth++] = { level, i };
        }
      }
    };
    if (!this->Levels.empty())
    {
      enter(this->Levels.size() - 1, 0, this->Levels.back().size());
    }
    while (depth > 0)
    {
      const Entry entry = stack[--depth];
      if (entry.Level == 0)
      {
        visit(static_cast<std::size_t>(this->Order[entry.Number]));
        continue;
      }
      const std::size_t begin = FanOut * entry.Number;
      enter(entry.Level - 1, begin, std::min(begin + FanOut, this->Levels[entry.Level - 1].size()));
    }
  }

private:
  static constexpr std::size_t FanOut = 4;
  static constexpr std::size_t MostLevels = 20; // of 2^32 boxes, with room to spare

  struct FloatBox
  {
    glm::vec3 Min;
    glm::vec3 Max;
    bool Holds(const glm::vec3& point) const
    {
      return point.x >= this->Min.x && point.x <= this->Max.x && point.y >= this->Min.y &&
        point.y <= this->Max.y && point.z >= this->Min.z && point.z <= this->Max.z;
    }
  };

  glm::dvec3 Center{ 0.0 };
  std::vector<std::uint32_t> Order;
  std::vector<std::vector<FloatBox>> Levels; // the last has FanOut boxes at most
};

} // namespace deformvolume

#endif
