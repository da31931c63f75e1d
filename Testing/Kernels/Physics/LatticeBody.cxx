// SPDX-License-Identifier: BSD-3-Clause
#include "LatticeBody.h"

#include "FiveTetrahedra.h"

#include <algorithm>
#include <cstddef>
#include <utility>

using namespace deformvolume;

LatticeBody::LatticeBody(const Place& nodes, double spacing, const ElasticMaterial& material)
  : Nodes(nodes)
  , Spacing(spacing)
{
  this->Body.Materials = { material };
  this->ForNodes([&](const Place& place, std::int32_t)
    { this->Body.Points.push_back(glm::dvec3(place[0], place[1], place[2]) * spacing); });
  LatticeBody::Place cell;
  for (cell[2] = 0; cell[2] + 1 < nodes[2]; ++cell[2])
  {
    for (cell[1] = 0; cell[1] + 1 < nodes[1]; ++cell[1])
    {
      for (cell[0] = 0; cell[0] + 1 < nodes[0]; ++cell[0])
      {
        const bool isOdd = (cell[0] + cell[1] + cell[2]) % 2 != 0;
        for (int number = 0; number < 5; ++number)
        {
          Tetrahedron tetrahedron;
          for (std::size_t i = 0; i < 4; ++i)
          {
            const std::int32_t vertex = FiveTetrahedra[number][i];
            const std::int32_t offsets[3] = { vertex & 1, vertex >> 2 & 1, vertex >> 1 & 1 };
            Place place;
            for (std::size_t axis = 0; axis < 3; ++axis)
            {
              place[axis] = cell[axis] + (cell[axis] % 2 != 0 ? 1 - offsets[axis] : offsets[axis]);
            }
            tetrahedron[i] = this->GetNode(place);
          }
          // The fifth tetrahedron, and the other four in mirrored cells, have negative volumes in
          // this order of nodes.
          if ((number == 4) != isOdd)
          {
            std::swap(tetrahedron[2], tetrahedron[3]);
          }
          this->Body.Tetrahedra.push_back(tetrahedron);
        }
      }
    }
  }
}

void LatticeBody::Fix(const std::function<bool(const Place&)>& isFixed)
{
  this->Body.Fixed.resize(this->Body.Points.size(), 0);
  this->ForNodes([&](const Place& place, std::int32_t node)
    { this->Body.Fixed[static_cast<std::size_t>(node)] = isFixed(place) ? 1 : 0; });
}

void LatticeBody::ForNodes(const std::function<void(const Place&, std::int32_t node)>& visit) const
{
  Place place;
  for (place[2] = 0; place[2] < this->Nodes[2]; ++place[2])
  {
    for (place[1] = 0; place[1] < this->Nodes[1]; ++place[1])
    {
      for (place[0] = 0; place[0] < this->Nodes[0]; ++place[0])
      {
        visit(place, this->GetNode(place));
      }
    }
  }
}

namespace physicsTesting
{

ElasticBody MakeLatticeBody(
  const LatticeBody::Place& nodes, const glm::dvec3& spacing, const ElasticMaterial& material)
{
  ElasticBody body = LatticeBody(nodes, 1.0, material).Body;
  for (glm::dvec3& point : body.Points)
  {
    point *= spacing;
  }
  return body;
}

void FixNodes(ElasticBody& body, const std::function<bool(const glm::dvec3&)>& isFixed)
{
  body.Fixed.resize(body.Points.size());
  std::transform(body.Points.begin(), body.Points.end(), body.Fixed.begin(),
    [&](const glm::dvec3& point) { return static_cast<unsigned char>(isFixed(point)); });
}

} // namespace physicsTesting
