// SPDX-License-Identifier: BSD-3-Clause
#include "CellReader.h"

#include "CellNumbers.h"
#include "CellParts.h"
#include "CoincidentPoints.h"
#include "Error.h"
#include "PolyhedronSplit.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace deformvolume
{

std::vector<std::string> GetCellWarnings(const std::string& ignored, const std::string& wrongOrder)
{
  std::vector<std::string> warnings;
  if (!ignored.empty())
  {
    warnings.push_back(
      "Cells of the deformation mesh that are not three-dimensional, or of a type that "
      "cannot be split into tetrahedra, are ignored: " +
      ignored + ".");
  }
  if (!wrongOrder.empty())
  {
    warnings.push_back(wrongOrder + " Check that the nodes of the cells are in VTK's order.");
  }
  return warnings;
}

void ThrowBadCell(std::int64_t cell, int type, std::int64_t count, const std::string& complaint)
{
  throw Error("Cell " + std::to_string(cell) + " of the deformation mesh is a " +
    GetCellName(type) + " with " + std::to_string(count) + " points" + complaint +
    ". Correct the cells of the mesh.");
}

void CheckCellPoint(std::int64_t point, std::int64_t numberOfPoints, std::int64_t cell)
{
  if (point < 0 || point >= numberOfPoints)
  {
    throw Error("Cell " + std::to_string(cell) + " of the deformation mesh uses point " +
      std::to_string(point) + ", but the mesh has only " + std::to_string(numberOfPoints) +
      " points. Correct the cells of the mesh.");
  }
}

CellReader::CellReader(std::int32_t numberOfNodes, Positions positions, double rounding)
  : NumberOfNodes(numberOfNodes)
  , GetPosition(std::move(positions))
  , Rounding(rounding)
{
}

void CellReader::CheckSize(std::int64_t cell, int type, std::int64_t count)
{
  const int needed = GetNumberOfCellPoints(type);
  if (needed > 0 && count != needed)
  {
    ThrowBadCell(cell, type, count, " instead of " + std::to_string(needed));
  }
}

// Returns the nodes of a cell that is split, until the next call.
const std::vector<CellNode>& CellReader::GetNodes(const std::vector<std::int32_t>& numbers)
{
  if (this->Places.empty())
  {
    std::vector<glm::dvec3> points(static_cast<std::size_t>(this->NumberOfNodes));
    for (std::int32_t node = 0; node < this->NumberOfNodes; ++node)
    {
      points[static_cast<std::size_t>(node)] = this->GetPosition(node);
    }
    this->Places = FindCoincidentPoints(points);
  }
  this->Cells.DependOnPoints = true;
  this->Nodes.clear();
  for (const std::int32_t number : numbers)
  {
    // Cells may also use derived nodes of the mesh.
    this->Nodes.push_back(
      { number < this->NumberOfNodes ? this->Places[static_cast<std::size_t>(number)] : number,
        number });
  }
  return this->Nodes;
}

// Adds a derived node, and returns its index.
std::int32_t CellReader::AddNode(
  const std::vector<std::int32_t>& nodes, const std::vector<double>& weights)
{
  const std::size_t number =
    static_cast<std::size_t>(this->NumberOfNodes) + this->Cells.Derived.GetCount();
  if (number >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
  {
    throw Error("The deformation mesh has more than 2,147,483,647 nodes, including derived nodes "
                "in the middle of cells. Use a coarser mesh.");
  }
  this->Cells.Derived.Add(nodes, weights);
  return static_cast<std::int32_t>(number);
}

void CellReader::AddPolyhedron(
  std::int64_t cell, std::int64_t count, const PolyhedronFaces& faces, bool areComplete)
{
  bool complete = areComplete;
  std::vector<std::int32_t> nodes;
  CellFaces facesByIndex;
  std::set<std::vector<int>> known; // the sorted nodes of the faces
  std::map<std::int32_t, int> indices;
  for (const std::vector<std::int32_t>& points : faces)
  {
    complete &= points.size() >= 3;
    std::vector<int> face;
    for (const std::int32_t node : points)
    {
      const auto inserted = indices.emplace(node, static_cast<int>(nodes.size()));
      if (inserted.second)
      {
        nodes.push_back(node);
      }
      face.push_back(inserted.first->second);
    }
    // Repeated nodes and repeated faces do not change the cell.
    face.erase(std::unique(face.begin(), face.end()), face.end());
    while (face.size() > 1 && face.front() == face.back())
    {
      face.pop_back();
    }
    std::vector<int> sorted = face;
    std::sort(sorted.begin(), sorted.end());
    if (face.size() >= 3 && known.insert(sorted).second)
    {
      facesByIndex.push_back(face);
    }
  }
  if (!complete || facesByIndex.size() < 4)
  {
    ThrowBadCell(cell, cellNumbers::Polyhedron, count, " and incomplete faces");
  }
  std::vector<glm::dvec3> points;
  for (const std::int32_t node : nodes)
  {
    points.push_back(this->GetPosition(node));
  }
  PolyhedronSplit split;
  if (!SplitPolyhedron(this->GetNodes(nodes), facesByIndex, points, this->Rounding, split))
  {
    if (split.IsOpen)
    {
      ThrowBadCell(cell, cellNumbers::Polyhedron, count, " and faces that do not close");
    }
    throw Error("Cell " + std::to_string(cell) + " of the deformation mesh is a concave " +
      GetCellName(cellNumbers::Polyhedron) + " with " + std::to_string(nodes.size()) +
      " points, and no point inside sees all of its faces. Divide it into convex or star-shaped "
      "cells.");
  }
  std::vector<Tetrahedron>& tetrahedra = this->Cells.Tetrahedra;
  tetrahedra.insert(tetrahedra.end(), split.Tetrahedra.begin(), split.Tetrahedra.end());
  if (!split.CenterWeights.empty())
  {
    const std::int32_t center = this->AddNode(nodes, split.CenterWeights);
    for (const std::array<std::int32_t, 3>& triangle : split.Triangles)
    {
      tetrahedra.push_back({ { center, triangle[0], triangle[1], triangle[2] } });
    }
  }
}

// Whether all mid-side nodes are close to the midpoints of their edges. The distances, relative to
// the length between the ends of the edge, are 0.29 for the middle of an arc of 120 degrees, 0.25
// for a quarter point, and 0.5 for the midpoint of a wrong edge if all edges have the same length.
bool CellReader::HasNearMidSides(int type, const std::vector<std::int32_t>& nodes) const
{
  constexpr double most = 0.3;
  for (const std::array<int, 3>& edge : HigherOrderCells::GetMidSides(type))
  {
    const auto at = [&](std::size_t i)
    { return this->GetPosition(nodes[static_cast<std::size_t>(edge[i])]); };
    const glm::dvec3 first = at(0);
    const glm::dvec3 second = at(1);
    if (glm::distance(at(2), 0.5 * (first + second)) > most * glm::distance(first, second))
    {
      return false;
    }
  }
  return true;
}

void CellReader::AddHigherOrder(std::int64_t cell, int type, const std::vector<std::int32_t>& nodes,
  const std::array<int, 3>* degrees)
{
  const auto count = static_cast<std::int64_t>(nodes.size());
  const CellParts& parts = this->HigherOrder.GetParts(type, count, degrees);
  if (parts.empty())
  {
    ThrowBadCell(cell, type, count, ", which does not fit its degree");
  }
  std::vector<Tetrahedron>& tetrahedra = this->Cells.Tetrahedra;
  std::vector<std::size_t> begins;
  std::vector<std::int32_t> some;
  for (const CellPart& part : parts)
  {
    begins.push_back(tetrahedra.size());
    some.clear();
    for (const int node : part.Nodes)
    {
      some.push_back(nodes[static_cast<std::size_t>(node)]);
    }
    if (part.CenterWeights.empty())
    {
      SplitCell(this->GetNodes(some), part.Faces, tetrahedra);
      continue;
    }
    const std::int32_t center = this->AddNode(nodes, part.CenterWeights);
    for (const std::vector<int>& face : part.Faces)
    {
      tetrahedra.push_back({ { center, some[static_cast<std::size_t>(face[0])],
        some[static_cast<std::size_t>(face[1])], some[static_cast<std::size_t>(face[2])] } });
    }
  }
  this->NumberOfQuadraticCells += HigherOrderCells::GetMidSides(type).empty() ? 0 : 1;
  if (this->HasNearMidSides(type, nodes))
  {
    this->CountOverlap(begins);
  }
  else
  {
    ++this->NumberOfFarMidSides;
  }
}

// Counts a cell if it overlaps itself: if, in its parts, more than a tenth of the volume of the
// tetrahedra has another orientation than the rest of the part. In a cube with the nodes in the
// order of a voxel it is half of the volume. The volume of a flat cell, as of a layer between two
// bodies, is only rounding. begins: the first tetrahedron of each part.
void CellReader::CountOverlap(const std::vector<std::size_t>& begins)
{
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high(-std::numeric_limits<double>::infinity());
  const auto at = [&](std::int32_t node)
  {
    const glm::dvec3 point = node < this->NumberOfNodes
      ? this->GetPosition(node)
      : this->Cells.Derived.Sum(
          static_cast<std::size_t>(node - this->NumberOfNodes), this->GetPosition);
    low = glm::min(low, point);
    high = glm::max(high, point);
    return point;
  };
  double volume = 0.0;
  double overlap = 0.0;
  for (std::size_t part = 0; part < begins.size(); ++part)
  {
    const std::size_t end =
      part + 1 < begins.size() ? begins[part + 1] : this->Cells.Tetrahedra.size();
    double ofOneSign = 0.0;
    double ofOtherSign = 0.0;
    for (std::size_t t = begins[part]; t < end; ++t)
    {
      const Tetrahedron& nodes = this->Cells.Tetrahedra[t];
      const glm::dvec3 apex = at(nodes[0]);
      const double signedVolume =
        glm::dot(at(nodes[1]) - apex, glm::cross(at(nodes[2]) - apex, at(nodes[3]) - apex));
      (signedVolume > 0.0 ? ofOneSign : ofOtherSign) += std::abs(signedVolume);
    }
    volume += ofOneSign + ofOtherSign;
    overlap += std::min(ofOneSign, ofOtherSign);
  }
  const double length = glm::distance(low, high);
  const double farthest = std::max(glm::length(low), glm::length(high));
  constexpr double most = 0.1;
  ++this->NumberOfSplitCells;
  this->NumberOfFoldedCells +=
    overlap > most * volume && volume > 100.0 * this->Rounding * farthest * length * length ? 1 : 0;
}

void CellReader::Add(std::int64_t cell, int type, const std::vector<std::int32_t>& nodes,
  const std::array<int, 3>* degrees)
{
  const auto count = static_cast<std::int64_t>(nodes.size());
  CheckSize(cell, type, count);
  std::vector<Tetrahedron>& tetrahedra = this->Cells.Tetrahedra;
  const std::vector<std::size_t> begin{ tetrahedra.size() };
  if (type == cellNumbers::Tetrahedron)
  {
    this->AddTetrahedron({ { nodes[0], nodes[1], nodes[2], nodes[3] } });
  }
  else if (type == cellNumbers::Voxel)
  {
    std::vector<std::int32_t> swapped = nodes;
    std::swap(swapped[2], swapped[3]);
    std::swap(swapped[6], swapped[7]);
    SplitCell(this->GetNodes(swapped), *GetCellFaces(cellNumbers::Hexahedron), tetrahedra);
    this->CountOverlap(begin);
  }
  else if (const CellFaces* faces = GetCellFaces(type))
  {
    SplitCell(this->GetNodes(nodes), *faces, tetrahedra);
    this->CountOverlap(begin);
  }
  else if (HigherOrderCells::Contain(type))
  {
    this->AddHigherOrder(cell, type, nodes, degrees);
  }
  else if (HigherOrderCells::IsBezier(type))
  {
    ThrowBadCell(cell, type, count,
      ". The points of Bezier cells control their shape and do not lie on it: convert the mesh "
      "to Lagrange or to linear cells");
  }
  else
  {
    ++this->Ignored[type];
  }
}

MeshCells CellReader::Finish()
{
  for (const auto& entry : this->Ignored)
  {
    this->Cells.Ignored += (this->Cells.Ignored.empty() ? "" : ", ") +
      std::to_string(entry.second) + " " + GetCellName(entry.first);
  }
  if (this->NumberOfFarMidSides > 0)
  {
    this->Cells.WrongOrder = std::to_string(this->NumberOfFarMidSides) + " of " +
      std::to_string(this->NumberOfQuadraticCells) +
      " quadratic cells of the deformation mesh have a mid-side node that is farther from the "
      "middle of its edge than 30 % of the length of the edge.";
  }
  if (this->NumberOfFoldedCells > 0)
  {
    this->Cells.WrongOrder += (this->Cells.WrongOrder.empty() ? "" : " ") +
      std::to_string(this->NumberOfFoldedCells) + " of " +
      std::to_string(this->NumberOfSplitCells) +
      " cells of the deformation mesh that are split into tetrahedra overlap themselves at rest, "
      "so that voxels in them may be lost.";
  }
  return std::move(this->Cells);
}

} // namespace deformvolume
