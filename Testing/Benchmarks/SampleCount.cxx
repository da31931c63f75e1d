// SPDX-License-Identifier: BSD-3-Clause
#include "SampleCount.h"

#include "FiveTetrahedra.h"

#include <vtkSMPTools.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

namespace
{
using Position = std::array<double, 3>;

constexpr int Tetrahedra[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;

SampleCount MakeEmpty()
{
  SampleCount count;
  count.Fewest = std::numeric_limits<std::int64_t>::max();
  return count;
}

void AddTetrahedron(const Position corners[8], const int vertices[4], SampleCount& count)
{
  std::int64_t samples = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    double lower = corners[vertices[0]][axis];
    double upper = lower;
    for (int i = 1; i < 4; ++i)
    {
      lower = std::min(lower, corners[vertices[i]][axis]);
      upper = std::max(upper, corners[vertices[i]][axis]);
    }
    samples *= static_cast<std::int64_t>(std::ceil(upper) - std::ceil(lower));
  }
  ++count.Tetrahedra;
  count.Samples += samples;
  count.Fewest = std::min(count.Fewest, samples);
  count.Most = std::max(count.Most, samples);
}

// The cells between the planes z and z + 1.
struct CellLayer
{
  const PoseMap& Map;
  const std::array<int, 3>& Dimensions;
  std::vector<Position> Planes[2];

  void FillPlane(int z)
  {
    std::vector<Position>& plane = this->Planes[z % 2];
    plane.clear();
    for (int y = 0; y < this->Dimensions[1]; ++y)
    {
      for (int x = 0; x < this->Dimensions[0]; ++x)
      {
        Position position = this->Map({ { 1.0 * x, 1.0 * y, 1.0 * z } });
        for (double& coordinate : position)
        {
          coordinate = std::round(256.0 * coordinate) / 256.0;
        }
        plane.push_back(position);
      }
    }
  }

  void Count(int z, SampleCount& count) const
  {
    for (int y = 0; y + 1 < this->Dimensions[1]; ++y)
    {
      for (int x = 0; x + 1 < this->Dimensions[0]; ++x)
      {
        Position corners[8];
        for (int v = 0; v < 8; ++v)
        {
          // The offset of a vertex counts downward if the index of the cell is odd.
          const int i = x + ((v & 1) ^ (x & 1));
          const int j = y + ((v >> 2 & 1) ^ (y & 1));
          const int k = z + ((v >> 1 & 1) ^ (z & 1));
          corners[v] = this->Planes[k % 2][i + static_cast<std::size_t>(this->Dimensions[0]) * j];
        }
        for (const auto& tetrahedron : Tetrahedra)
        {
          AddTetrahedron(corners, tetrahedron, count);
        }
      }
    }
  }
};
}

SampleCount CountSamples(const std::array<int, 3>& dimensions, Pose pose)
{
  const PoseMap map(pose, dimensions, 0);
  SampleCount sum = MakeEmpty();
  std::mutex mutex;
  vtkSMPTools::For(0, dimensions[2] - 1, 8,
    [&](vtkIdType begin, vtkIdType end)
    {
      CellLayer layer{ map, dimensions, {} };
      SampleCount count = MakeEmpty();
      layer.FillPlane(static_cast<int>(begin));
      for (int z = static_cast<int>(begin); z < end; ++z)
      {
        layer.FillPlane(z + 1);
        layer.Count(z, count);
      }
      const std::lock_guard<std::mutex> lock(mutex);
      sum.Tetrahedra += count.Tetrahedra;
      sum.Samples += count.Samples;
      sum.Fewest = std::min(sum.Fewest, count.Fewest);
      sum.Most = std::max(sum.Most, count.Most);
    });
  return sum;
}
