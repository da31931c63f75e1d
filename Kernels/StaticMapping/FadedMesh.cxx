// SPDX-License-Identifier: BSD-3-Clause
#include "FadedMesh.h"

#include "Error.h"

#include <algorithm>
#include <string>

namespace deformvolume
{

void FadedMesh::Set(
  const FadedLinks& links, const std::vector<Tetrahedron>& tetrahedra, std::size_t numberOfNodes)
{
  // Reserve numbers for nodes that are added when the mesh is split.
  this->NumberOfNodes = numberOfNodes + numberOfNodes / 4 + 1024;
  this->NumberOfTetrahedra = tetrahedra.size();
  this->Displacements.assign(3 * this->NumberOfNodes, 0.0F);
  this->Tetrahedra = tetrahedra;
  const auto still = static_cast<std::int32_t>(this->NumberOfNodes - 1);
  for (std::size_t i = 0; i < links.GetNumberOfFadedTetrahedra(); ++i)
  {
    this->Tetrahedra.push_back(links.GetFadedTetrahedron(i, tetrahedra, still));
  }
}

std::vector<TetrahedronChange> FadedMesh::Change(
  const FadedLinks& links, const std::vector<TetrahedronChange>& changes)
{
  std::vector<TetrahedronChange> all = changes;
  const std::vector<TetrahedronFace>& faces = links.GetFaces();
  for (const TetrahedronChange& change : changes)
  {
    this->Tetrahedra[static_cast<std::size_t>(change.Number)] = change.After;
    for (auto face = std::lower_bound(faces.begin(), faces.end(), change.Number,
           [](const TetrahedronFace&one, std::int32_t number) { return one.Tetrahedron < number; });
         face != faces.end() && face->Tetrahedron == change.Number; ++face)
    {
      const std::size_t number =
        this->NumberOfTetrahedra + 1 + static_cast<std::size_t>(face - faces.begin());
      TetrahedronChange& faded = all.emplace_back();
      faded.Number = static_cast<std::int32_t>(number);
      faded.Before = faded.After = this->Tetrahedra[number];
      const auto nodes = face->GetNodes(change.After);
      std::copy(nodes.begin(), nodes.end(), faded.After.begin());
      this->Tetrahedra[number] = faded.After;
      if (faded.After == faded.Before)
      {
        all.pop_back();
      }
    }
  }
  return all;
}

void FadedMesh::Move(
  const float* displacements, std::size_t numberOfNodes, const PointRanges* changes)
{
  if (!this->HasRoom(numberOfNodes))
  {
    throw Error("The displacements are those of " + std::to_string(numberOfNodes) +
      " nodes, but the faded mesh has room for fewer. Set the mesh first.");
  }
  const PointRanges all{ { { 0, numberOfNodes } } };
  for (const auto& range : changes ? *changes : all)
  {
    const std::size_t end = std::min(range[1], numberOfNodes);
    if (range[0] < end)
    {
      std::copy(displacements + 3 * range[0], displacements + 3 * end,
        this->Displacements.begin() + static_cast<std::ptrdiff_t>(3 * range[0]));
    }
  }
}

} // namespace deformvolume
