// SPDX-License-Identifier: BSD-3-Clause
#include "LatticeBody.h"

#include "FiveTetrahedra.h"

#include <algorithm>
#include <utility>

namespace physicsTesting
{

using namespace deformvolume;

ElasticBody MakeLatticeBody(
  const std::array<int, 3>& nodes, const glm::dvec3& spacing, const ElasticMaterial& material)
{
  constexpr int table[5][4] = DEFORMVOLUME_FIVE_TETRAHEDRA;
  ElasticBody body;
  body.Materials = { material };
  for (int z = 0; z < nodes[2]; ++z)
  {
    for (int y = 0; y < nodes[1]; ++y)
    {
      for (int x = 0; x < nodes[0]; ++x)
      {
        body.Points.push_back(spacing * glm::dvec3(x, y, z));
      }
    }
  }
  for (int z = 0; z + 1 < nodes[2]; ++z)
  {
    for (int y = 0; y + 1 < nodes[1]; ++y)
    {
      for (int x = 0; x + 1 < nodes[0]; ++x)
      {
        for (std::size_t t = 0; t < 5; ++t)
        {
          Tetrahedron tetrahedron;
          for (std::size_t i = 0; i < 4; ++i)
          {
            const int vertex = table[t][i];
            tetrahedron[i] = static_cast<std::int32_t>(GetNode(nodes, x + ((vertex & 1) ^ (x & 1)),
              y + ((vertex >> 2 & 1) ^ (y & 1)), z + ((vertex >> 1 & 1) ^ (z & 1))));
          }
          if (((x + y + z) % 2 != 0) != (t == 4))
          {
            std::swap(tetrahedron[2], tetrahedron[3]);
          }
          body.Tetrahedra.push_back(tetrahedron);
        }
      }
    }
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
