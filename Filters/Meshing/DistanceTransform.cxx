// SPDX-License-Identifier: BSD-3-Clause
#include "DistanceTransform.h"

#include "ParallelFor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformvolume
{
namespace
{

constexpr float Far = std::numeric_limits<float>::infinity();

// Squares of the distances within a row, to the runs or to what lies between and beyond them.
void TransformRow(const BodyLevelSet& grid, const VoxelRun* run, const VoxelRun* end,
  bool complement, float* result)
{
  const double spacing = grid.VoxelSpacing.x;
  int before = complement ? -1 : std::numeric_limits<int>::min(); // the last voxel passed
  for (vtkIdType node = 0; node < grid.Size[0]; ++node)
  {
    const vtkIdType x = (node - grid.Border[0]) * grid.Step[0];
    while (run < end && run->End <= x)
    {
      before = complement ? run->End : run->End - 1;
      ++run;
    }
    double distance = Far;
    if (complement)
    {
      // What is not of the body begins at `before` and goes on to the next run.
      if (run < end && run->Begin <= x)
      {
        distance = static_cast<double>(std::min(x - (run->Begin - 1), run->End - x));
      }
      else
      {
        distance = 0.0;
      }
    }
    else
    {
      if (before >= 0)
      {
        distance = static_cast<double>(x - before);
      }
      if (run < end)
      {
        distance = run->Begin <= x ? 0.0 : std::min(distance, static_cast<double>(run->Begin - x));
      }
    }
    result[node] = static_cast<float>(distance * spacing * distance * spacing);
  }
}

// The rows of one slice, with so many rows beyond the volume on both sides.
void TransformRows(const BodyLevelSet& grid, const BodyVoxels& body, vtkIdType z, vtkIdType pad,
  bool complement, float* result)
{
  for (vtkIdType y = -pad; y < body.Size[1] + pad; ++y, result += grid.Size[0])
  {
    if (y < 0 || y >= body.Size[1] || z < 0 || z >= body.Size[2])
    {
      std::fill(result, result + grid.Size[0], 0.0f);
      continue;
    }
    const vtkIdType row = z * body.Size[1] + y;
    TransformRow(grid, body.Runs.data() + body.RowStarts[row],
      body.Runs.data() + body.RowStarts[row + 1], complement, result);
  }
}

// Room for the parabolas of a line.
struct Envelope
{
  double* Starts;    // where each becomes the lowest
  vtkIdType* Apexes; // the position of each
  float* Heights;
};

// What a line of voxels holds; the first of them has the position `First`.
struct Line
{
  const float* Values;
  vtkIdType Stride;
  vtkIdType First;
  vtkIdType Count;
};

// Felzenszwalb and Huttenlocher, "Distance transforms of sampled functions": the lower envelope of
// the parabolas over the voxels of a line, looked up at the nodes.
void TransformLine(const Line& line, const BodyLevelSet& grid, int axis, float* result,
  vtkIdType stride, const Envelope& envelope)
{
  const double spacing = grid.VoxelSpacing[axis];
  const double unit = spacing * spacing;
  vtkIdType size = 0;
  for (vtkIdType i = 0; i < line.Count; ++i)
  {
    const float height = line.Values[i * line.Stride];
    if (height == Far)
    {
      continue;
    }
    const vtkIdType apex = line.First + i;
    double start = -std::numeric_limits<double>::infinity();
    while (size > 0)
    {
      const vtkIdType last = envelope.Apexes[size - 1];
      start = 0.5 * static_cast<double>(apex + last) +
        (static_cast<double>(height) - envelope.Heights[size - 1]) /
          (2.0 * unit * static_cast<double>(apex - last));
      if (start > envelope.Starts[size - 1])
      {
        break;
      }
      --size;
      start = -std::numeric_limits<double>::infinity();
    }
    envelope.Starts[size] = start;
    envelope.Apexes[size] = apex;
    envelope.Heights[size] = height;
    ++size;
  }
  vtkIdType current = 0;
  for (vtkIdType node = 0; node < grid.Size[axis]; ++node)
  {
    const vtkIdType position = (node - grid.Border[axis]) * grid.Step[axis];
    float& value = result[node * stride];
    if (size == 0)
    {
      value = Far;
      continue;
    }
    while (current + 1 < size && envelope.Starts[current + 1] <= static_cast<double>(position))
    {
      ++current;
    }
    const double steps = static_cast<double>(position - envelope.Apexes[current]);
    value = static_cast<float>(unit * steps * steps + envelope.Heights[current]);
  }
}

// The envelopes of lines that are worked on at the same time: no thread allocates memory.
class Envelopes
{
public:
  Envelopes(vtkIdType lines, vtkIdType length)
    : Length(length)
    , Starts(lines * length)
    , Apexes(lines * length)
    , Heights(lines * length)
  {
  }
  Envelope Get(vtkIdType line)
  {
    const vtkIdType first = line * this->Length;
    return { &this->Starts[first], &this->Apexes[first], &this->Heights[first] };
  }

private:
  vtkIdType Length;
  std::vector<double> Starts;
  std::vector<vtkIdType> Apexes;
  std::vector<float> Heights;
};

} // namespace

std::vector<float> SquaredDistances(
  const BodyLevelSet& grid, const BodyVoxels& body, bool complement)
{
  // Beyond the border, everything is not of the body: one voxel of that on each side says so.
  const vtkIdType pad = complement ? 1 : 0;
  const vtkIdType rows = body.Size[1] + 2 * pad;
  const vtkIdType slices = body.Size[2] + 2 * pad;
  const Index& size = grid.Size;
  const vtkIdType plane = size[0] * size[1];
  std::vector<float> bySlice(slices * plane);
  // Some slices at a time, so that threads have work and memory is small.
  constexpr vtkIdType together = 16;
  std::vector<float> byRow(together * rows * size[0]);
  Envelopes sliceEnvelopes(together, rows);
  for (vtkIdType start = 0; start < slices; start += together)
  {
    ParallelFor(start, std::min(start + together, slices), 1,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType slice = begin; slice < end; ++slice)
        {
          float* lines = &byRow[(slice - start) * rows * size[0]];
          TransformRows(grid, body, slice - pad, pad, complement, lines);
          for (vtkIdType x = 0; x < size[0]; ++x)
          {
            TransformLine({ lines + x, size[0], -pad, rows }, grid, 1, &bySlice[slice * plane + x],
              size[0], sliceEnvelopes.Get(slice - start));
          }
        }
      });
  }
  std::vector<float> squares(grid.Count());
  Envelopes envelopes(size[1], slices);
  ParallelFor(0, size[1], 1,
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin * size[0]; i < end * size[0]; ++i)
      {
        TransformLine({ &bySlice[i], plane, -pad, slices }, grid, 2, &squares[i], plane,
          envelopes.Get(i / size[0]));
      }
    });
  return squares;
}

} // namespace deformvolume
