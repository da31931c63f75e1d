// SPDX-License-Identifier: BSD-3-Clause
#include "RefinedMesh.h"

#include <algorithm>
#include <set>

using namespace deformvolume;

RefinedMesh::RefinedMesh(EditedVolume& volume, double jitter, unsigned int seed)
  : Volume(volume)
  , Random(seed)
{
  std::uniform_real_distribution<double> beside(-jitter, jitter);
  for (int z = 0; z < volume.Nodes[2]; ++z)
  {
    for (int y = 0; y < volume.Nodes[1]; ++y)
    {
      for (int x = 0; x < volume.Nodes[0]; ++x)
      {
        const int place[3] = { x, y, z };
        glm::dvec3 point;
        for (int axis = 0; axis < 3; ++axis)
        {
          point[axis] = volume.Shape.VertexExtent[2 * axis] + EditedVolume::Step * place[axis] +
            beside(this->Random);
        }
        this->Points.push_back(point);
      }
    }
  }
  for (std::size_t t = 0; t < volume.Tetrahedra.size(); ++t)
  {
    this->Names.push_back(++this->LastName);
  }
  this->Last = this->GetState();
  this->Snapshots.push_back(this->Last);
}

RefinedMesh::State RefinedMesh::GetState() const
{
  return { this->Volume.Tetrahedra, this->Names, this->Points, this->Volume.Displacements };
}

std::int32_t RefinedMesh::AddNode(const std::vector<std::int32_t>& between)
{
  const double weight = 1.0 / static_cast<double>(between.size());
  std::uniform_real_distribution<double> move(-0.2, 0.2);
  glm::dvec3 point(0.0);
  glm::dvec3 moved(0.0);
  for (const std::int32_t node : between)
  {
    point += weight * this->Points[node];
    for (int axis = 0; axis < 3; ++axis)
    {
      moved[axis] += weight * this->Volume.Displacements[3 * node + axis];
    }
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Volume.Displacements.push_back(static_cast<float>(moved[axis] + move(this->Random)));
  }
  this->Points.push_back(point);
  return static_cast<std::int32_t>(this->Points.size() - 1);
}

void RefinedMesh::Insert(std::size_t place, const Tetrahedron& tetrahedron)
{
  const auto at = static_cast<std::ptrdiff_t>(place);
  this->Volume.Tetrahedra.insert(this->Volume.Tetrahedra.begin() + at, tetrahedron);
  this->Names.insert(this->Names.begin() + at, ++this->LastName);
}

void RefinedMesh::Refine()
{
  const std::size_t parent = this->Pick(this->Names.size());
  const Tetrahedron nodes = this->Volume.Tetrahedra[parent];
  const std::int32_t center = this->AddNode({ nodes.begin(), nodes.end() });
  const bool beside = this->Pick(2) == 0;
  for (int k = 0; k < 4; ++k)
  {
    Tetrahedron child = nodes;
    child[k] = center;
    if (k == 0)
    {
      this->Volume.Tetrahedra[parent] = child;
      this->Names[parent] = ++this->LastName;
    }
    else
    {
      this->Insert(beside ? parent + 1 : this->Names.size(), child);
    }
  }
}

void RefinedMesh::SplitEdge()
{
  const Tetrahedron& one = this->Volume.Tetrahedra[this->Pick(this->Names.size())];
  const std::int32_t a = one[this->Pick(2)];
  const std::int32_t b = one[2 + this->Pick(2)];
  const std::int32_t middle = this->AddNode({ a, b });
  const std::size_t count = this->Names.size();
  for (std::size_t t = 0; t < count; ++t)
  {
    const Tetrahedron nodes = this->Volume.Tetrahedra[t];
    if (std::count(nodes.begin(), nodes.end(), a) && std::count(nodes.begin(), nodes.end(), b))
    {
      Tetrahedron child = nodes;
      std::replace(child.begin(), child.end(), a, middle);
      this->Volume.Tetrahedra[t] = child;
      this->Names[t] = ++this->LastName;
      child = nodes;
      std::replace(child.begin(), child.end(), b, middle);
      this->Insert(this->Names.size(), child);
    }
  }
}

void RefinedMesh::Remove()
{
  const std::size_t first = this->Pick(this->Names.size() - 8);
  const auto begin = static_cast<std::ptrdiff_t>(first);
  const auto end = begin + 1 + static_cast<std::ptrdiff_t>(this->Pick(6));
  this->Volume.Tetrahedra.erase(
    this->Volume.Tetrahedra.begin() + begin, this->Volume.Tetrahedra.begin() + end);
  this->Names.erase(this->Names.begin() + begin, this->Names.begin() + end);
}

void RefinedMesh::Append()
{
  Tetrahedron nodes = this->Volume.Tetrahedra[this->Pick(this->Names.size())];
  switch (this->Pick(3))
  {
    case 0:
      break;
    case 1:
      std::rotate(nodes.begin(), nodes.begin() + 1, nodes.end());
      break;
    default:
      nodes[this->Pick(4)] = this->AddNode({ nodes[0], nodes[1] });
  }
  this->Insert(this->Pick(2) ? this->Names.size() : this->Pick(this->Names.size()), nodes);
}

void RefinedMesh::Undo()
{
  this->Snapshots.resize(1 + this->Pick(this->Snapshots.size()));
  const State& state = this->Snapshots.back();
  this->Volume.Tetrahedra = state.Tetrahedra;
  this->Names = state.Names;
  this->Points = state.Points;
  this->Volume.Displacements = state.Displacements;
}

std::vector<TetrahedronChange> RefinedMesh::Split(int reach)
{
  const std::vector<TetrahedronChange> changes = this->Volume.Split(this->Random, reach);
  this->Points.resize(this->Volume.GetNumberOfNodes());
  for (const TetrahedronChange& change : changes)
  {
    for (int k = 0; k < 4; ++k)
    {
      this->Points[change.After[k]] = this->Points[change.Before[k]];
    }
  }
  return changes;
}

std::string RefinedMesh::Edit()
{
  switch (this->Pick(10))
  {
    case 0:
    case 1:
    case 2:
      this->Refine();
      return "one becomes four";
    case 3:
    case 4:
      this->SplitEdge();
      return "an edge that is split";
    case 5:
      this->Remove();
      return "some that are removed";
    case 6:
      this->Append();
      return "one that is added";
    case 7:
      this->Undo();
      return "those that were";
    case 8:
      this->Snapshots.push_back(this->GetState());
      this->Refine();
      return "one becomes four, which may be undone";
    default:
      this->Remove();
      this->Refine();
      this->Append();
      return "all of this";
  }
}

TetrahedronReplacement RefinedMesh::TakeReplacement()
{
  TetrahedronReplacement replacement;
  const std::set<std::int64_t> now(this->Names.begin(), this->Names.end());
  std::size_t after = 0;
  const std::set<std::int64_t> then(this->Last.Names.begin(), this->Last.Names.end());
  for (std::size_t before = 0; before < this->Last.Names.size(); ++before)
  {
    const std::int64_t name = this->Last.Names[before];
    if (!now.count(name))
    {
      std::array<glm::dvec3, 4> places;
      std::transform(this->Last.Tetrahedra[before].begin(), this->Last.Tetrahedra[before].end(),
        places.begin(), [&](std::int32_t node) { return this->Last.Points[node]; });
      replacement.Removed.push_back({ this->Last.Tetrahedra[before], places });
      continue;
    }
    while (!then.count(this->Names[after]))
    {
      ++after;
    }
    EXPECT_EQ(this->Names[after], name);
    KeptTetrahedra* const last = replacement.Kept.empty() ? nullptr : &replacement.Kept.back();
    if (last && last->Before + last->Count == static_cast<std::int32_t>(before) &&
      last->After + last->Count == static_cast<std::int32_t>(after))
    {
      ++last->Count;
    }
    else
    {
      replacement.Kept.push_back(
        { static_cast<std::int32_t>(before), static_cast<std::int32_t>(after), 1 });
    }
    ++after;
  }
  this->Last = this->GetState();
  return replacement;
}
