// SPDX-License-Identifier: BSD-3-Clause
#include "CoincidentNodes.h"

#include "CoincidentPoints.h"
#include "RestMesh.h"

#include <algorithm>

namespace deformvolume
{

void CoincidentNodes::Join(std::int32_t first, std::int32_t second)
{
  const std::int32_t number = this->Numbers[first];
  const std::int32_t other = this->Numbers[second];
  if (number == other)
  {
    return;
  }
  this->AnyShared = true;
  if (!this->Shares[second])
  {
    this->Numbers[second] = number;
  }
  else if (!this->Shares[first])
  {
    this->Numbers[first] = other;
  }
  else
  {
    std::replace(this->Numbers.begin(), this->Numbers.end(), other, number);
  }
  this->Shares[first] = this->Shares[second] = 1;
}

void CoincidentNodes::Update(const RestMesh& mesh)
{
  const std::vector<glm::dvec3>& points = mesh.GetPoints();
  const bool isKnown = this->ShapeVersion == mesh.GetShapeVersion();
  if (isKnown && this->ConnectivityVersion == mesh.GetConnectivityVersion())
  {
    return;
  }
  const auto changes = isKnown ? mesh.GetChanges(this->ConnectivityVersion)
                               : std::optional<std::vector<TetrahedronChange>>();
  if (changes)
  {
    for (std::size_t node = this->Numbers.size(); node < points.size(); ++node)
    {
      this->Numbers.push_back(static_cast<std::int32_t>(node));
    }
    this->Shares.resize(this->Numbers.size());
    // The new nodes of tetrahedra have the positions of the old ones. No other new nodes are used.
    for (const TetrahedronChange& change : *changes)
    {
      for (int k = 0; k < 4; ++k)
      {
        this->Join(change.Before[k], change.After[k]);
      }
    }
    this->Numbers.resize(points.size());
    this->Shares.resize(points.size());
  }
  else
  {
    this->Numbers = FindCoincidentPoints(points);
    this->Shares.assign(points.size(), 0);
    this->AnyShared = false;
    for (std::size_t node = 0; node < points.size(); ++node)
    {
      const auto first = static_cast<std::size_t>(this->Numbers[node]);
      if (first != node)
      {
        this->Shares[first] = this->Shares[node] = 1;
        this->AnyShared = true;
      }
    }
  }
  this->ShapeVersion = mesh.GetShapeVersion();
  this->ConnectivityVersion = mesh.GetConnectivityVersion();
}

} // namespace deformvolume
