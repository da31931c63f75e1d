// SPDX-License-Identifier: BSD-3-Clause
#include "CoarseVolume.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace deformvolume
{
namespace
{

// Marks what is connected through faces with `start` and has the same mark; returns how many.
vtkIdType Flood(std::vector<unsigned char>& marks, const Index& size, vtkIdType start,
  unsigned char mark, std::vector<vtkIdType>& queue)
{
  const unsigned char old = marks[start];
  const vtkIdType strides[3] = { 1, size[0], size[0] * size[1] };
  queue.assign(1, start);
  marks[start] = mark;
  for (std::size_t next = 0; next < queue.size(); ++next)
  {
    const vtkIdType voxel = queue[next];
    for (int axis = 0; axis < 3; ++axis)
    {
      const vtkIdType position = voxel / strides[axis] % size[axis];
      const vtkIdType neighbors[2] = { position > 0 ? voxel - strides[axis] : -1,
        position + 1 < size[axis] ? voxel + strides[axis] : -1 };
      for (vtkIdType neighbor : neighbors)
      {
        if (neighbor >= 0 && marks[neighbor] == old)
        {
          marks[neighbor] = mark;
          queue.push_back(neighbor);
        }
      }
    }
  }
  return static_cast<vtkIdType>(queue.size());
}

// Squared distances, in world units, of the voxels' centres to the nearest voxel of the body.
// Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions": along each axis the
// lower envelope of parabolas. (vtkImageEuclideanDistance of VTK 9.1 is wrong unless the spacing
// is 1.)
std::vector<double> SquaredDistances(
  const CoarseVolume& coarse, const std::vector<unsigned char>& body)
{
  const glm::dvec3 size = coarse.Spacing *
    glm::dvec3(static_cast<double>(coarse.Size[0]), static_cast<double>(coarse.Size[1]),
      static_cast<double>(coarse.Size[2]));
  const double far = 4.0 * glm::dot(size, size);
  std::vector<double> squares(coarse.Count());
  std::transform(body.begin(), body.end(), squares.begin(),
    [far](unsigned char inside) { return inside ? 0.0 : far; });

  const vtkIdType strides[3] = { 1, coarse.Size[0], coarse.Size[0] * coarse.Size[1] };
  for (int axis = 0; axis < 3; ++axis)
  {
    const vtkIdType count = coarse.Size[axis];
    const double unit = coarse.Spacing[axis] * coarse.Spacing[axis];
    std::vector<double> line(count);
    std::vector<vtkIdType> apex(count);
    std::vector<double> from(count); // where the parabola of that apex becomes the lowest
    for (vtkIdType start = 0; start < coarse.Count(); ++start)
    {
      if (start / strides[axis] % count != 0)
      {
        continue;
      }
      for (vtkIdType i = 0; i < count; ++i)
      {
        line[i] = squares[start + i * strides[axis]];
      }
      vtkIdType top = 0;
      apex[0] = 0;
      from[0] = -std::numeric_limits<double>::infinity();
      for (vtkIdType i = 1; i < count; ++i)
      {
        double meeting;
        do
        {
          const vtkIdType j = apex[top];
          meeting = 0.5 * (i + j) + (line[i] - line[j]) / (2.0 * unit * (i - j));
        } while (meeting <= from[top] && top-- > 0);
        ++top;
        apex[top] = i;
        from[top] = meeting;
      }
      vtkIdType current = 0;
      for (vtkIdType i = 0; i < count; ++i)
      {
        while (current < top && from[current + 1] <= i)
        {
          ++current;
        }
        const double steps = static_cast<double>(i - apex[current]);
        squares[start + i * strides[axis]] = unit * steps * steps + line[apex[current]];
      }
    }
  }
  return squares;
}

} // namespace

double OtsuThreshold(const std::vector<float>& values, double low, double high)
{
  constexpr int bins = 512;
  std::vector<double> histogram(bins, 0.0);
  for (float value : values)
  {
    if (std::isfinite(value))
    {
      const int bin = static_cast<int>((value - low) / (high - low) * bins);
      histogram[std::min(std::max(bin, 0), bins - 1)] += 1.0;
    }
  }
  const double total = std::accumulate(histogram.begin(), histogram.end(), 0.0);
  double moment = 0.0;
  for (int i = 0; i < bins; ++i)
  {
    moment += i * histogram[i];
  }
  double below = 0.0;
  double momentBelow = 0.0;
  double best = -1.0;
  double first = 0.0;
  double last = 0.0;
  for (int i = 0; i + 1 < bins; ++i)
  {
    below += histogram[i];
    momentBelow += i * histogram[i];
    const double above = total - below;
    if (below == 0.0 || above == 0.0)
    {
      continue;
    }
    const double difference = momentBelow / below - (moment - momentBelow) / above;
    const double between = below * above * difference * difference;
    if (between > best * (1.0 + 1e-12))
    {
      best = between;
      first = i;
    }
    if (between >= best * (1.0 - 1e-12))
    {
      last = i;
    }
  }
  return low + ((first + last) / 2.0 + 1.0) / bins * (high - low);
}

std::vector<unsigned char> FindBody(const CoarseVolume& coarse, double isovalue, bool largestOnly)
{
  constexpr unsigned char out = 0, in = 1, visited = 2, chosen = 3, outside = 4;
  std::vector<unsigned char> marks(coarse.Count(), out);
  std::vector<vtkIdType> queue;
  vtkIdType largest = 0;
  vtkIdType seed = -1;
  for (vtkIdType i = 0; i < coarse.Count(); ++i)
  {
    marks[i] = coarse.Values[i] >= isovalue ? in : out;
  }
  for (vtkIdType i = 0; i < coarse.Count(); ++i)
  {
    if (marks[i] == in)
    {
      const vtkIdType count = Flood(marks, coarse.Size, i, visited, queue);
      if (count > largest)
      {
        largest = count;
        seed = i;
      }
    }
  }
  if (seed < 0)
  {
    return {};
  }
  if (largestOnly)
  {
    Flood(marks, coarse.Size, seed, chosen, queue);
    std::replace(marks.begin(), marks.end(), visited, out);
  }
  Flood(marks, coarse.Size, 0, outside, queue);
  for (unsigned char& mark : marks)
  {
    mark = mark != outside;
  }
  return marks;
}

void MakeLevelSet(CoarseVolume& coarse, const std::vector<unsigned char>& body, double isovalue,
  double background, double margin)
{
  if (margin > 0.0)
  {
    const std::vector<double> squares = SquaredDistances(coarse, body);
    // The body ends about half a voxel beyond its outermost voxels.
    const double half = (coarse.Spacing.x + coarse.Spacing.y + coarse.Spacing.z) / 6.0;
    for (vtkIdType i = 0; i < coarse.Count(); ++i)
    {
      coarse.Values[i] = static_cast<float>((margin + half - std::sqrt(squares[i])) / half);
    }
  }
  else
  {
    const double scale = std::max(isovalue - background, std::numeric_limits<float>::min() * 1.0);
    for (vtkIdType i = 0; i < coarse.Count(); ++i)
    {
      const double value = std::isfinite(coarse.Values[i]) ? coarse.Values[i] : background;
      const double level = std::abs(value - isovalue) / scale;
      coarse.Values[i] = static_cast<float>(body[i] ? level : -level);
    }
  }
  // A value close to 0 would put several vertices of the surface almost into one place, and
  // TetGen has to keep the tiny triangles between them.
  for (float& value : coarse.Values)
  {
    value = std::copysign(std::max(std::abs(value), 0.1f), value);
  }
}

} // namespace deformvolume
