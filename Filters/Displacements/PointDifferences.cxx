// SPDX-License-Identifier: BSD-3-Clause
#include "PointDifferences.h"

#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>

namespace deformvolume
{

namespace
{

constexpr vtkIdType POINTS_AT_A_TIME = 512;

// Copies points of a mesh, whose indices are counted over all parts.
class PointsOfParts
{
public:
  explicit PointsOfParts(const MeshParts& parts)
  {
    vtkIdType first = 0;
    for (vtkUnstructuredGrid* grid : parts)
    {
      const vtkIdType count = grid->GetNumberOfPoints();
      if (count > 0)
      {
        this->Parts.push_back({ first, count, MakeVectorCopier(grid->GetPoints()->GetData()) });
      }
      first += count;
    }
  }

  // Called by many threads.
  void Copy(vtkIdType first, vtkIdType count, glm::dvec3* points) const
  {
    for (const Part& part : this->Parts)
    {
      const vtkIdType begin = std::max(first, part.First);
      const vtkIdType end = std::min(first + count, part.First + part.Count);
      if (begin < end)
      {
        part.Copy(begin - part.First, end - begin, points + (begin - first));
      }
    }
  }

private:
  struct Part
  {
    vtkIdType First;
    vtkIdType Count;
    VectorCopier Copy;
  };
  std::vector<Part> Parts;
};

} // namespace

void ReadPointDifferences(const MeshParts& shape, const MeshParts& rest, const VectorTaker& take,
  std::vector<VectorMemory>& memories, NodeFaults& faults)
{
  const PointsOfParts starts(rest);
  memories.resize(shape.size());
  vtkIdType next = 0;
  for (std::size_t part = 0; part < shape.size(); ++part)
  {
    const vtkIdType count = shape[part]->GetNumberOfPoints();
    if (count == 0 || memories[part].FirstNumber != next)
    {
      memories[part] = VectorMemory();
      memories[part].FirstNumber = next;
    }
    if (count > 0)
    {
      ReadVectors(
        shape[part]->GetPoints()->GetData(),
        [&](vtkIdType first, const glm::dvec3* vectors, vtkIdType number)
        {
          std::array<glm::dvec3, POINTS_AT_A_TIME> moves;
          for (vtkIdType begin = 0; begin < number; begin += moves.size())
          {
            const vtkIdType some = std::min<vtkIdType>(number - begin, moves.size());
            starts.Copy(next + first + begin, some, moves.data());
            for (vtkIdType i = 0; i < some; ++i)
            {
              moves[i] = vectors[begin + i] - moves[i];
            }
            take(next + first + begin, moves.data(), some);
          }
        },
        "Point", MESH_NAME, &memories[part],
        [&](vtkIdType point) { faults.Mark(next + point, NodeFaults::NotFinite); });
    }
    next += count;
  }
}

} // namespace deformvolume
