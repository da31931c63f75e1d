// SPDX-License-Identifier: BSD-3-Clause
#include "BoxPyramid.h"

#include "MortonCurve.h"
#include "ParallelFor.h"

#include <mutex>
#include <utility>

namespace deformvolume
{

namespace
{

constexpr std::size_t BoxesPerPart = 4096; // boxes that a thread takes at a time

} // namespace

BoxPyramid::BoxPyramid(std::size_t count, const std::function<Box(std::size_t)>& getBox)
{
  Box all;
  std::mutex mutex;
  ParallelForParts(count, BoxesPerPart,
    [&](std::size_t begin, std::size_t end)
    {
      Box some;
      for (std::size_t i = begin; i < end; ++i)
      {
        const Box box = getBox(i);
        some.Min = glm::min(some.Min, box.Min);
        some.Max = glm::max(some.Max, box.Max);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      all.Min = glm::min(all.Min, some.Min);
      all.Max = glm::max(all.Max, some.Max);
    });
  if (all.IsEmpty())
  {
    return;
  }
  this->Center = 0.5 * all.Min + 0.5 * all.Max;
  const glm::dvec3 size = all.Max - all.Min;
  const glm::dvec3 scale =
    1.0 / glm::dvec3(std::max({ size.x, size.y, size.z, std::numeric_limits<double>::min() }));
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted(count);
  std::vector<FloatBox> boxes(count);
  ParallelForParts(count, BoxesPerPart,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        const Box box = getBox(i);
        const glm::dvec3 place =
          box.IsEmpty() ? glm::dvec3(0.0) : scale * (0.5 * box.Min + 0.5 * box.Max - all.Min);
        sorted[i] = { GetMortonNumber(place, 21), static_cast<std::uint32_t>(i) };
        boxes[i] = { glm::vec3(box.Min - this->Center), glm::vec3(box.Max - this->Center) };
      }
    });
  std::sort(sorted.begin(), sorted.end());
  this->Order.resize(count);
  this->Levels.emplace_back(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    this->Order[i] = sorted[i].second;
    this->Levels[0][i] = boxes[sorted[i].second];
  }
  while (this->Levels.back().size() > FanOut)
  {
    const std::vector<FloatBox>& lower = this->Levels.back();
    std::vector<FloatBox> upper((lower.size() + FanOut - 1) / FanOut);
    for (std::size_t i = 0; i < upper.size(); ++i)
    {
      upper[i] = lower[FanOut * i];
      for (std::size_t k = FanOut * i; k < std::min(FanOut * (i + 1), lower.size()); ++k)
      {
        upper[i].Min = glm::min(upper[i].Min, lower[k].Min);
        upper[i].Max = glm::max(upper[i].Max, lower[k].Max);
      }
    }
    this->Levels.push_back(std::move(upper));
  }
}

} // namespace deformvolume
