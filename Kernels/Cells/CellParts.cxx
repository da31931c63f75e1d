// SPDX-License-Identifier: BSD-3-Clause
#include "CellParts.h"

#include "Extent.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>

namespace deformvolume
{

namespace
{

// Makes a part from faces whose nodes are indices in the cell's list of points.
CellPart MakePart(const CellFaces& faces)
{
  CellPart part;
  for (const std::vector<int>& face : faces)
  {
    part.Nodes.insert(part.Nodes.end(), face.begin(), face.end());
  }
  std::sort(part.Nodes.begin(), part.Nodes.end());
  part.Nodes.erase(std::unique(part.Nodes.begin(), part.Nodes.end()), part.Nodes.end());
  part.Faces = faces;
  for (std::vector<int>& face : part.Faces)
  {
    for (int& node : face)
    {
      node = static_cast<int>(
        std::lower_bound(part.Nodes.begin(), part.Nodes.end(), node) - part.Nodes.begin());
    }
  }
  OrientFaces(part.Faces);
  return part;
}

CellPart MakeTetrahedron(int a, int b, int c, int d)
{
  return MakePart({ { a, b, c }, { a, b, d }, { a, c, d }, { b, c, d } });
}

CellPart MakeWedge(const std::array<int, 3>& bottom, const std::array<int, 3>& top)
{
  CellFaces faces{ { bottom[0], bottom[1], bottom[2] }, { top[0], top[1], top[2] } };
  for (std::size_t i = 0; i < 3; ++i)
  {
    const std::size_t next = (i + 1) % 3;
    faces.push_back({ bottom[i], bottom[next], top[next], top[i] });
  }
  return MakePart(faces);
}

// Makes a pyramid over a polygon.
CellPart MakeCone(int apex, const std::vector<int>& base)
{
  CellFaces faces{ base };
  for (std::size_t i = 0; i < base.size(); ++i)
  {
    faces.push_back({ apex, base[i], base[(i + 1) % base.size()] });
  }
  return MakePart(faces);
}

CellPart MakeHexahedron(const std::array<int, 4>& bottom, const std::array<int, 4>& top)
{
  CellFaces faces{ { bottom.begin(), bottom.end() }, { top.begin(), top.end() } };
  for (std::size_t i = 0; i < 4; ++i)
  {
    const std::size_t next = (i + 1) % 4;
    faces.push_back({ bottom[i], bottom[next], top[next], top[i] });
  }
  return MakePart(faces);
}

} // namespace

CellParts SplitSerendipity(const CellFaces& faces)
{
  CellParts parts;
  CellFaces rest;
  // For each corner, the mid-edge nodes around it. These form a ring; each has two neighbors in the
  // ring.
  std::map<int, std::map<int, std::vector<int>>> rings;
  for (const std::vector<int>& face : faces)
  {
    const std::size_t corners = face.size() / 2;
    rest.emplace_back(face.begin() + static_cast<std::ptrdiff_t>(corners), face.end());
    for (std::size_t i = 0; i < corners; ++i)
    {
      const int before = face[corners + (i + corners - 1) % corners];
      const int after = face[corners + i];
      rings[face[i]][before].push_back(after);
      rings[face[i]][after].push_back(before);
    }
  }
  for (const auto& corner : rings)
  {
    std::vector<int> ring{ corner.second.begin()->first };
    int next = corner.second.begin()->second.front();
    while (next != ring.front())
    {
      const std::vector<int>& neighbors = corner.second.at(next);
      const int last = ring.back();
      ring.push_back(next);
      next = neighbors[0] == last ? neighbors[1] : neighbors[0];
    }
    rest.push_back(ring);
    parts.push_back(MakeCone(corner.first, ring));
  }
  parts.push_back(MakePart(rest));
  return parts;
}

CellParts SplitRoundCenter(const CellFaces& faces, int center)
{
  CellParts parts;
  for (const std::vector<int>& face : faces)
  {
    const std::size_t corners = face.size() / 2;
    for (std::size_t i = 0; i < corners; ++i)
    {
      const int before = face[corners + (i + corners - 1) % corners];
      const int after = face[corners + i];
      if (corners == 3)
      {
        parts.push_back(MakeTetrahedron(center, before, face[i], after));
        parts.push_back(MakeTetrahedron(center, before, after, face.back()));
      }
      else
      {
        parts.push_back(MakeCone(center, { before, face[i], after, face.back() }));
      }
    }
  }
  return parts;
}

CellParts SplitHexahedron(const std::array<int, 3>& degrees, const NodeAt& at)
{
  CellParts parts;
  ForEachPoint({ { 0, degrees[0] - 1, 0, degrees[1] - 1, 0, degrees[2] - 1 } },
    [&](int i, int j, int k)
    {
      const auto layer = [&](int z) -> std::array<int, 4> {
        return { { at(i, j, z), at(i + 1, j, z), at(i + 1, j + 1, z), at(i, j + 1, z) } };
      };
      parts.push_back(MakeHexahedron(layer(k), layer(k + 1)));
    });
  return parts;
}

CellParts SplitWedge(int degree, int layers, const NodeAt& at)
{
  CellParts parts;
  for (int k = 0; k < layers; ++k)
  {
    for (int j = 0; j < degree; ++j)
    {
      for (int i = 0; i + j < degree; ++i)
      {
        const auto upright = [&](int z) -> std::array<int, 3> {
          return { { at(i, j, z), at(i + 1, j, z), at(i, j + 1, z) } };
        };
        parts.push_back(MakeWedge(upright(k), upright(k + 1)));
        if (i + j + 1 < degree)
        {
          const auto inverted = [&](int z) -> std::array<int, 3> {
            return { { at(i + 1, j, z), at(i + 1, j + 1, z), at(i, j + 1, z) } };
          };
          parts.push_back(MakeWedge(inverted(k), inverted(k + 1)));
        }
      }
    }
  }
  return parts;
}

CellParts SplitRings(const NodeAt& at)
{
  static const int mid[4][2] = { { 1, 0 }, { 2, 1 }, { 1, 2 }, { 0, 1 } };
  static const int corner[4][2] = { { 2, 0 }, { 2, 2 }, { 0, 2 }, { 0, 0 } }; // follows mid[i]
  CellParts parts;
  for (int k = 0; k < 2; ++k)
  {
    const auto layer = [&](int z) -> std::array<int, 4>
    {
      return { { at(mid[0][0], mid[0][1], z), at(mid[1][0], mid[1][1], z),
        at(mid[2][0], mid[2][1], z), at(mid[3][0], mid[3][1], z) } };
    };
    const std::array<int, 4> bottom = layer(k);
    const std::array<int, 4> top = layer(k + 1);
    parts.push_back(MakeHexahedron(bottom, top));
    for (std::size_t i = 0; i < 4; ++i)
    {
      const std::size_t next = (i + 1) % 4;
      parts.push_back(MakeWedge({ { bottom[i], at(corner[i][0], corner[i][1], k), bottom[next] } },
        { { top[i], at(corner[i][0], corner[i][1], k + 1), top[next] } }));
    }
  }
  return parts;
}

// Each complete cube of the lattice consists of a tetrahedron, an octahedron and a tetrahedron.
CellParts SplitTetrahedron(int degree, const NodeAt& at)
{
  CellParts parts;
  for (int k = 0; k < degree; ++k)
  {
    for (int j = 0; j + k < degree; ++j)
    {
      for (int i = 0; i + j + k < degree; ++i)
      {
        const auto node = [&](int x, int y, int z) { return at(i + x, j + y, k + z); };
        const int x = node(1, 0, 0);
        const int y = node(0, 1, 0);
        const int z = node(0, 0, 1);
        parts.push_back(MakeTetrahedron(node(0, 0, 0), x, y, z));
        if (i + j + k + 2 > degree)
        {
          continue;
        }
        const int xy = node(1, 1, 0);
        const int xz = node(1, 0, 1);
        const int yz = node(0, 1, 1);
        parts.push_back(MakePart({ { x, y, z }, { xy, xz, yz }, { x, y, xy }, { x, z, xz },
          { y, z, yz }, { x, xy, xz }, { y, xy, yz }, { z, xz, yz } }));
        if (i + j + k + 3 <= degree)
        {
          parts.push_back(MakeTetrahedron(xy, xz, yz, node(1, 1, 1)));
        }
      }
    }
  }
  return parts;
}

CellParts SplitWedgeOf21()
{
  static const int nodes[3][7] = { { 0, 1, 2, 6, 7, 8, 15 }, { 12, 13, 14, 17, 18, 19, 20 },
    { 3, 4, 5, 9, 10, 11, 16 } };
  CellParts parts;
  for (int k = 0; k < 2; ++k)
  {
    const auto add = [&](int a, int b, int c)
    {
      const auto layer = [&](int z) -> std::array<int, 3> {
        return { { nodes[z][a], nodes[z][b], nodes[z][c] } };
      };
      parts.push_back(MakeWedge(layer(k), layer(k + 1)));
    };
    for (int i = 0; i < 3; ++i)
    {
      const int before = 3 + (i + 2) % 3;
      add(before, i, 3 + i);
      add(before, 3 + i, 6);
    }
  }
  return parts;
}

} // namespace deformvolume
