// SPDX-License-Identifier: BSD-3-Clause
#include "BrickEdit.h"

#include "Error.h"
#include "FiveTetrahedra.h"
#include "ParallelFor.h"
#include "Processors.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace deformvolume
{

void BrickEdit::Set(const CellBricks& bricks, std::size_t brick)
{
  this->Vertices = bricks.GetVertices(brick);
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Size[axis] = static_cast<int>(GetSize(this->Vertices, axis)) - 1;
  }
  const auto width = static_cast<std::size_t>(this->Size[0]) + 1;
  this->Steps = { { 1, width, width * (static_cast<std::size_t>(this->Size[1]) + 1) } };
}

void BrickEdit::Set(const VertexPositions& positions, std::size_t brick)
{
  this->Set(positions.GetBricks(), brick);
  positions.Find(this->Vertices, this->Positions.data(), this->HasPositions.data());
  // A vertex without a position gets the position of another vertex, so that all positions lie in
  // the box of the brick. Predicates could overflow for positions outside this box.
  const auto end =
    this->HasPositions.begin() + static_cast<std::ptrdiff_t>(this->GetNumberOfVertices());
  const auto found = std::find(this->HasPositions.begin(), end, true);
  for (std::size_t i = 0; found != end && i < this->GetNumberOfVertices(); ++i)
  {
    if (!this->HasPositions[i])
    {
      this->Positions[i] =
        this->Positions[static_cast<std::size_t>(found - this->HasPositions.begin())];
    }
  }
}

void BrickEdit::CopyPoints(std::array<glm::dvec3, MaxVertices>& points) const
{
  for (std::size_t i = 0; i < this->GetNumberOfVertices(); ++i)
  {
    points[i] = GetIndex(this->Positions[i]);
  }
}

BrickEdit::CellTetrahedra BrickEdit::GetTetrahedra(int x, int y, int z) const
{
  // Tetrahedra are mirrored by the structured index of the cell and not by its index in the brick,
  // so that a part of a volume has the same tetrahedra as the whole volume.
  const int mirror =
    DEFORMVOLUME_MIRROR(this->Vertices[0] + x, this->Vertices[2] + y, this->Vertices[4] + z);
  CellTetrahedra tetrahedra;
  for (std::size_t t = 0; t < 5; ++t)
  {
    for (std::size_t k = 0; k < 4; ++k)
    {
      const int offset = FiveTetrahedra[t][k] ^ mirror;
      tetrahedra[t][k] = this->GetVertex(x + DEFORMVOLUME_OFFSET_X(offset),
        y + DEFORMVOLUME_OFFSET_Y(offset), z + DEFORMVOLUME_OFFSET_Z(offset));
    }
  }
  return tetrahedra;
}

TetrahedronSet BrickEdit::ForEachBrick(std::size_t bricks,
  const std::function<void(std::size_t brick, BrickEdit& edit)>& function,
  const EditProgress& progress)
{
  constexpr std::size_t step = 64;
  // The number of bricks between two calls of the progress function.
  const std::size_t bricksPerCall =
    progress ? 16 * step * static_cast<std::size_t>(GetProcessorShare()) : std::max(bricks, step);
  std::vector<std::pair<std::size_t, TetrahedronSet>> parts; // with the first brick of each part
  std::mutex mutex;
  const auto editCells = [&](std::size_t begin, std::size_t end)
  {
    const auto edit = std::make_unique<BrickEdit>();
    TetrahedronSet part;
    for (std::size_t brick = begin; brick < end; ++brick)
    {
      function(brick, *edit);
      if (edit->HasHits)
      {
        part.Bricks.push_back(brick);
        part.Blocks.push_back(edit->Hits);
        edit->Hits.fill(0);
        edit->HasHits = false;
      }
    }
    if (!part.IsEmpty())
    {
      const std::lock_guard<std::mutex> lock(mutex);
      parts.emplace_back(begin, std::move(part));
    }
  };
  for (std::size_t first = 0; first < bricks; first += bricksPerCall)
  {
    if (progress && !progress(static_cast<double>(first) / static_cast<double>(bricks)))
    {
      throw Aborted();
    }
    ParallelForParts(std::min(bricksPerCall, bricks - first), step,
      [&](std::size_t begin, std::size_t end) { editCells(first + begin, first + end); });
  }
  std::sort(
    parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  TetrahedronSet whole;
  for (const auto& [first, part] : parts)
  {
    whole.Bricks.insert(whole.Bricks.end(), part.Bricks.begin(), part.Bricks.end());
    whole.Blocks.insert(whole.Blocks.end(), part.Blocks.begin(), part.Blocks.end());
  }
  return whole;
}

} // namespace deformvolume
