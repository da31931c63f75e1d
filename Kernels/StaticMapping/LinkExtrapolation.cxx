// SPDX-License-Identifier: BSD-3-Clause
#include "LinkExtrapolation.h"

#include "BarycentricMap.h"
#include "ParallelFor.h"

#include <array>
#include <cstring>
#include <limits>

namespace deformvolume
{

namespace
{

// The feature of the distance transform: the local index of the nearest linked voxel. It is stored
// in the weights of an unlinked voxel until this voxel is linked, so that the transform needs no
// additional memory.
using Feature = std::array<std::int32_t, 3>;
static_assert(
  sizeof(Feature) == sizeof(VertexLink::Weights), "A feature is stored in place of the weights.");

Feature GetFeature(const VertexLink& link)
{
  Feature feature;
  std::memcpy(feature.data(), link.Weights, sizeof(feature));
  return feature;
}

void SetFeature(VertexLink& link, const Feature& feature)
{
  std::memcpy(link.Weights, feature.data(), sizeof(feature));
}

bool IsLinked(const VertexLink& link)
{
  return link.Tetrahedron >= 0;
}

// One-dimensional distance transform: for each position on a line, finds the position with the
// least sum of cost and squared distance.
class NearestOnLine
{
public:
  NearestOnLine(std::int64_t size, double spacing)
    : Weight(spacing * spacing)
    , Costs(size)
    , Nearest(size)
    , Indices(size)
    , Starts(size)
  {
  }

  // cost: infinity excludes the position.
  void SetCost(std::int64_t index, double cost) { this->Costs[index] = cost; }

  // Returns -1 if all positions are excluded.
  std::int32_t GetNearest(std::int64_t index) const { return this->Nearest[index]; }

  // Computes the lower envelope of the parabolas at the positions in one sweep (Felzenszwalb and
  // Huttenlocher).
  void Compute()
  {
    const std::int32_t size = static_cast<std::int32_t>(this->Costs.size());
    std::int32_t count = 0;
    for (std::int32_t index = 0; index < size; ++index)
    {
      if (this->Costs[index] == std::numeric_limits<double>::infinity())
      {
        continue;
      }
      double start = -std::numeric_limits<double>::infinity();
      while (count > 0)
      {
        start = this->Intersect(this->Indices[count - 1], index);
        if (start > this->Starts[count - 1])
        {
          break;
        }
        --count;
        start = -std::numeric_limits<double>::infinity();
      }
      this->Indices[count] = index;
      this->Starts[count] = start;
      ++count;
    }
    std::int32_t current = 0;
    for (std::int32_t index = 0; index < size; ++index)
    {
      while (current + 1 < count && this->Starts[current + 1] < index)
      {
        ++current;
      }
      this->Nearest[index] = count > 0 ? this->Indices[current] : -1;
    }
  }

private:
  // Returns the position from which the parabola at q is below that at p, for p < q. Differences
  // avoid cancellation of the squared positions.
  double Intersect(std::int32_t p, std::int32_t q) const
  {
    return 0.5 *
      (static_cast<double>(p) + q +
        (this->Costs[q] - this->Costs[p]) / (this->Weight * (static_cast<double>(q) - p)));
  }

  double Weight;
  std::vector<double> Costs;
  std::vector<std::int32_t> Nearest;
  std::vector<std::int32_t> Indices;
  std::vector<double> Starts;
};

class Extrapolator
{
public:
  Extrapolator(const Extent& voxels, const glm::dvec3& spacing,
    const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
    std::vector<VertexLink>& links)
    : Voxels(voxels)
    , Spacing(spacing)
    , RestPoints(restPoints)
    , Tetrahedra(tetrahedra)
    , Links(links.data())
    , Size{ GetSize(voxels, 0), GetSize(voxels, 1), GetSize(voxels, 2) }
  {
  }

  void Run(const std::function<void(double)>& progress)
  {
    this->RunInSteps(this->Size[2], 0.0, progress,
      [this](std::int64_t begin, std::int64_t end)
      {
        NearestOnLine line(this->Size[1], this->Spacing.y);
        for (std::int64_t z = begin; z < end; ++z)
        {
          this->SearchRows(z);
          this->SearchPlane(z, line);
        }
      });
    this->RunInSteps(this->Size[1], 0.5, progress,
      [this](std::int64_t begin, std::int64_t end)
      {
        NearestOnLine line(this->Size[2], this->Spacing.z);
        for (std::int64_t y = begin; y < end; ++y)
        {
          this->LinkPlane(y, line);
        }
      });
  }

private:
  template <typename Body>
  void RunInSteps(
    std::int64_t size, double done, const std::function<void(double)>& progress, Body&& body)
  {
    constexpr int steps = 8;
    for (int step = 0; step < steps; ++step)
    {
      ParallelFor(size * step / steps, size * (step + 1) / steps, 1, body);
      progress(done + 0.5 * (step + 1) / steps);
    }
  }

  VertexLink& At(std::int64_t x, std::int64_t y, std::int64_t z) const
  {
    return this->Links[(z * this->Size[1] + y) * this->Size[0] + x];
  }

  double SquaredDistance(int axis, std::int64_t from, std::int64_t to) const
  {
    const double distance = static_cast<double>(to - from) * this->Spacing[axis];
    return distance * distance;
  }

  void SearchRows(std::int64_t z)
  {
    for (std::int64_t y = 0; y < this->Size[1]; ++y)
    {
      VertexLink* row = &this->At(0, y, z);
      std::int32_t nearest = -1;
      for (std::int32_t x = 0; x < this->Size[0]; ++x)
      {
        if (IsLinked(row[x]))
        {
          nearest = x;
        }
        else
        {
          SetFeature(row[x], Feature{ { nearest, -1, -1 } });
        }
      }
      nearest = -1;
      for (std::int32_t x = static_cast<std::int32_t>(this->Size[0]) - 1; x >= 0; --x)
      {
        if (IsLinked(row[x]))
        {
          nearest = x;
        }
        else if (nearest >= 0)
        {
          Feature feature = GetFeature(row[x]);
          if (feature[0] < 0 || nearest - x < x - feature[0])
          {
            feature[0] = nearest;
            SetFeature(row[x], feature);
          }
        }
      }
    }
  }

  void SearchPlane(std::int64_t z, NearestOnLine& line)
  {
    std::vector<std::int32_t> features(this->Size[1]);
    for (std::int64_t x = 0; x < this->Size[0]; ++x)
    {
      bool complete = true;
      for (std::int64_t y = 0; y < this->Size[1]; ++y)
      {
        const VertexLink& link = this->At(x, y, z);
        const bool linked = IsLinked(link);
        complete = complete && linked;
        features[y] = linked ? static_cast<std::int32_t>(x) : GetFeature(link)[0];
        line.SetCost(y,
          features[y] < 0 ? std::numeric_limits<double>::infinity()
                          : this->SquaredDistance(0, x, features[y]));
      }
      if (complete)
      {
        continue;
      }
      line.Compute();
      for (std::int64_t y = 0; y < this->Size[1]; ++y)
      {
        VertexLink& link = this->At(x, y, z);
        if (!IsLinked(link))
        {
          const std::int32_t nearest = line.GetNearest(y);
          SetFeature(link, Feature{ { nearest < 0 ? -1 : features[nearest], nearest, -1 } });
        }
      }
    }
  }

  // Writes unlinked voxels of this plane, and reads only linked voxels of other planes. So planes
  // can be processed in parallel.
  void LinkPlane(std::int64_t y, NearestOnLine& line)
  {
    std::vector<Feature> features(this->Size[2]);
    BarycentricMap map;
    std::int32_t mapped = -1;
    for (std::int64_t x = 0; x < this->Size[0]; ++x)
    {
      bool complete = true;
      for (std::int64_t z = 0; z < this->Size[2]; ++z)
      {
        const VertexLink& link = this->At(x, y, z);
        const bool linked = IsLinked(link);
        complete = complete && linked;
        features[z] = linked
          ? Feature{ { static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), -1 } }
          : GetFeature(link);
        line.SetCost(z,
          features[z][0] < 0 ? std::numeric_limits<double>::infinity()
                             : this->SquaredDistance(0, x, features[z][0]) +
              this->SquaredDistance(1, y, features[z][1]));
      }
      if (complete)
      {
        continue;
      }
      line.Compute();
      for (std::int64_t z = 0; z < this->Size[2]; ++z)
      {
        VertexLink& link = this->At(x, y, z);
        const std::int32_t nearest = line.GetNearest(z);
        if (IsLinked(link) || nearest < 0)
        {
          continue;
        }
        const Feature& feature = features[nearest];
        const std::int32_t tetrahedron = this->At(feature[0], feature[1], nearest).Tetrahedron;
        if (tetrahedron != mapped)
        {
          map.SetTetrahedron(this->Tetrahedra[tetrahedron], this->RestPoints);
          mapped = tetrahedron;
        }
        const glm::dvec3 point(static_cast<double>(this->Voxels[0] + x),
          static_cast<double>(this->Voxels[2] + y), static_cast<double>(this->Voxels[4] + z));
        link = MakeLink(tetrahedron, map.GetWeights(point));
      }
    }
  }

  const Extent& Voxels;
  const glm::dvec3 Spacing;
  const std::vector<glm::dvec3>& RestPoints;
  const std::vector<Tetrahedron>& Tetrahedra;
  VertexLink* Links;
  std::int64_t Size[3];
};

} // namespace

void ExtrapolateLinks(const Extent& voxels, const glm::dvec3& spacing,
  const std::vector<glm::dvec3>& restPoints, const std::vector<Tetrahedron>& tetrahedra,
  std::vector<VertexLink>& links, const std::function<void(double)>& progress)
{
  if (GetNumberOfPoints(voxels) > 0)
  {
    Extrapolator(voxels, spacing, restPoints, tetrahedra, links).Run(progress);
  }
}

} // namespace deformvolume
