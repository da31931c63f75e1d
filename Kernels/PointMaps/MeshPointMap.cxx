// SPDX-License-Identifier: BSD-3-Clause
#include "MeshPointMap.h"

#include "BarycentricMap.h"
#include "BoundaryFaces.h"
#include "BoxTree.h"
#include "ClosestFace.h"
#include "IndexBounds.h"
#include "TetrahedronOrder.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace deformvolume
{

namespace
{

// Points within this distance from the mesh, relative to its diagonal, count as inside. Surfaces of
// meshes are often computed in single precision.
constexpr double MeshBoundaryTolerance = 1e-6;
// The following are added, relative to the largest coordinate: rounding of points.
constexpr double FloatRounding = 1.0 / (1 << 23);
constexpr double DoubleRounding = 1e-14;
// Tolerance at the faces of a tetrahedron, relative to Configuration::Size: rounding must not lose
// points between two tetrahedra.
constexpr double MeshFaceTolerance = 1e-13;
// Largest distance from the solution at which Newton's method counts as converged, relative to the
// diagonal. DoubleRounding is added.
constexpr double MeshSolutionTolerance = 1e-11;

using Points = std::vector<glm::dvec3>;

const glm::dvec3& At(const Points& points, std::int32_t node)
{
  return points[static_cast<std::size_t>(node)];
}

double GetVolume(const Tetrahedron& nodes, const Points& points)
{
  const glm::dvec3& last = At(points, nodes[3]);
  return glm::dot(At(points, nodes[0]) - last,
    glm::cross(At(points, nodes[1]) - last, At(points, nodes[2]) - last));
}

} // namespace

class MeshPointMap::Internals
{
public:
  Internals(const Points& points, const std::vector<Tetrahedron>& tetrahedra)
    : Tetrahedra(tetrahedra)
    , Order(points, tetrahedra)
    , Rest(this->Search(points))
  {
  }

  /// Positions of the nodes, and a tree of the bounding boxes of the tetrahedra.
  struct Configuration
  {
    const Points* Positions = nullptr;
    double Diagonal = 0.0;      // of the bounding box
    double Largest = 0.0;       // absolute coordinate
    double Size = 0.0;          // the sum of both
    BoxTree<IndexBounds> Boxes; // empty boxes for flat tetrahedra

    double GetBorderTolerance(bool areFloats) const
    {
      return this->Diagonal * MeshBoundaryTolerance +
        this->Largest * (areFloats ? FloatRounding : DoubleRounding);
    }
  };

  Configuration Search(const Points& positions) const
  {
    Configuration configuration;
    configuration.Positions = &positions;
    IndexBounds all;
    std::vector<IndexBounds> boxes(this->Tetrahedra.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
    {
      for (const std::int32_t node : this->Tetrahedra[i])
      {
        boxes[i].Add(At(positions, node));
      }
      all.Add(boxes[i]);
    }
    const glm::dvec3 largest = glm::max(glm::abs(all.Min), glm::abs(all.Max));
    configuration.Diagonal = glm::length(all.Max - all.Min);
    configuration.Largest = std::max({ largest.x, largest.y, largest.z });
    configuration.Size = configuration.Diagonal + configuration.Largest;
    for (std::size_t i = 0; i < boxes.size(); ++i)
    {
      if (!std::isfinite(configuration.Size) ||
        !BarycentricMap().SetTetrahedron(this->Tetrahedra[i], positions))
      {
        boxes[i] = IndexBounds();
      }
    }
    configuration.Boxes = BoxTree<IndexBounds>(std::move(boxes));
    return configuration;
  }

  void FindBoundary()
  {
    const Points& rest = *this->Rest.Positions;
    this->Faces =
      FindBoundaryFaces(rest, this->Tetrahedra, FindSolidTetrahedra(rest, this->Tetrahedra));
    std::vector<ClosestFace::Triangle> triangles;
    for (const TetrahedronFace& face : this->Faces)
    {
      const auto nodes = face.GetNodes(this->GetNodes(face.Tetrahedron));
      triangles.push_back({ { At(rest, nodes[0]), At(rest, nodes[1]), At(rest, nodes[2]) } });
    }
    this->Boundary = std::make_unique<ClosestFace>(std::move(triangles));
  }

  /// A tetrahedron that contains a point.
  struct Holder
  {
    std::int32_t Number = -1;
    bool IsInverted = false;
    BarycentricMap Map;
  };

  /// Finds the tetrahedron that contains a point. If there are several, a tetrahedron that is not
  /// inverted is preferred, then the first one in the order of the mesh at rest.
  Holder Find(const Configuration& configuration, const glm::dvec3& point) const
  {
    const bool isAtRest = &configuration == &this->Rest;
    const Points& positions = *configuration.Positions;
    const double tolerance = configuration.GetBorderTolerance(this->PointsAreFloats);
    const double touching = configuration.Size * MeshFaceTolerance;
    Holder best;
    bool isBestNear = true; // `best` is within the tolerance but does not contain the point
    configuration.Boxes.Visit({ point - tolerance, point + tolerance },
      [&](std::size_t i)
      {
        const auto number = static_cast<std::int32_t>(i);
        Holder found;
        found.Number = number;
        const Tetrahedron& nodes = this->Tetrahedra[i];
        if (!found.Map.SetTetrahedron(nodes, positions))
        {
          return true;
        }
        const glm::dvec4 weights = found.Map.GetAllWeights(point);
        bool holds = true;
        for (int node = 0; node < 4; ++node)
        {
          if (weights[node] >= 0.0)
          {
            continue;
          }
          // The weight is the distance from the face times the length of the gradient.
          const glm::dvec3 gradient = found.Map.GetGradient(node);
          const double squared = weights[node] * weights[node] / glm::dot(gradient, gradient);
          if (squared > tolerance * tolerance)
          {
            return true;
          }
          holds = holds && squared <= touching * touching;
        }
        found.IsInverted = !isAtRest &&
          (GetVolume(nodes, positions) > 0.0) != (GetVolume(nodes, *this->Rest.Positions) > 0.0);
        const std::pair<bool, bool> rank(!holds, found.IsInverted);
        const std::pair<bool, bool> bestRank(isBestNear, best.IsInverted);
        if (best.Number < 0 || rank < bestRank ||
          (rank == bestRank && this->Order.ComesBefore(number, best.Number)))
        {
          best = found;
          isBestNear = !holds;
        }
        return true;
      });
    return best;
  }

  struct Displacement
  {
    glm::dvec3 Vector{ 0.0 };
    glm::dmat3 Gradient{ 0.0 };
  };

  /// Returns the displacement of a point in a tetrahedron, and its derivatives with respect to the
  /// position of the point.
  Displacement Displace(const Holder& holder, const glm::dvec3& point) const
  {
    Displacement result;
    const Tetrahedron& nodes = this->GetNodes(holder.Number);
    const glm::dvec4 weights = holder.Map.GetAllWeights(point);
    for (int node = 0; node < 4; ++node)
    {
      const glm::dvec3& vector = At(this->Displacements, nodes[static_cast<std::size_t>(node)]);
      result.Vector += weights[node] * vector;
      result.Gradient += glm::outerProduct(vector, holder.Map.GetGradient(node));
    }
    return result;
  }

  /// Returns the tetrahedron of a boundary face.
  Holder GetHolder(std::int32_t face) const
  {
    Holder holder;
    holder.Number = this->Faces[static_cast<std::size_t>(face)].Tetrahedron;
    holder.Map.SetTetrahedron(this->GetNodes(holder.Number), *this->Rest.Positions);
    return holder;
  }

  void Keep(const glm::dvec3& point, const ClosestFace::Result& closest, double fadeDistance,
    Image& image) const
  {
    image = { point };
    const double distance = std::sqrt(closest.SquaredDistance);
    if (!(distance < fadeDistance))
    {
      return;
    }
    const double s = distance / fadeDistance;
    const double weight = GetFadedWeight(s);
    const TetrahedronFace& face = this->Faces[static_cast<std::size_t>(closest.Face)];
    const auto corners = face.GetNodes(this->GetNodes(face.Tetrahedron));
    glm::dvec3 position(0.0); // the closest point
    // The corners of the face, edge or node on which the closest point lies.
    std::array<glm::dvec3, 3> feature;
    std::size_t featureSize = 0;
    for (int k = 0; k < 3; ++k)
    {
      if (closest.Weights[k] > 0.0)
      {
        feature[featureSize] = At(*this->Rest.Positions, corners[static_cast<std::size_t>(k)]);
        position += closest.Weights[k] * feature[featureSize++];
      }
    }
    // The derivative of the closest point with respect to the point.
    glm::dmat3 projection(0.0);
    if (featureSize == 3)
    {
      const glm::dvec3 normal =
        glm::normalize(glm::cross(feature[1] - feature[0], feature[2] - feature[0]));
      projection = glm::dmat3(1.0) - glm::outerProduct(normal, normal);
    }
    else if (featureSize == 2)
    {
      const glm::dvec3 edge = glm::normalize(feature[1] - feature[0]);
      projection = glm::outerProduct(edge, edge);
    }
    const Displacement displacement = this->Displace(this->GetHolder(closest.Face), position);
    image.FadingDisplacement = glm::length(displacement.Vector);
    image.Point += weight * displacement.Vector;
    image.Gradient += weight * displacement.Gradient * projection;
    if (distance > 0.0)
    {
      const double slope = GetFadedSlope(s) / fadeDistance;
      image.Gradient +=
        glm::outerProduct(displacement.Vector, slope * (point - position) / distance);
    }
  }

  const Tetrahedron& GetNodes(std::int32_t number) const
  {
    return this->Tetrahedra[static_cast<std::size_t>(number)];
  }

  const std::vector<Tetrahedron>& Tetrahedra;
  const TetrahedronOrder Order;
  const Configuration Rest;
  bool PointsAreFloats = false;
  std::vector<TetrahedronFace> Faces;
  std::unique_ptr<ClosestFace> Boundary;
  Points Displacements;
  Points MovedPoints;
  Configuration Moved;
};

MeshPointMap::MeshPointMap(
  const std::vector<glm::dvec3>& points, const std::vector<Tetrahedron>& tetrahedra)
  : Inside(std::make_unique<Internals>(points, tetrahedra))
{
}

MeshPointMap::~MeshPointMap() = default;

void MeshPointMap::SetPointsAreFloats(bool areFloats)
{
  this->Inside->PointsAreFloats = areFloats;
}

void MeshPointMap::Set(
  std::vector<glm::dvec3> displacements, const OutsideVoxels& outside, bool isInverse)
{
  Internals& inside = *this->Inside;
  inside.Displacements = std::move(displacements);
  this->Outside = outside;
  if (!outside.AreDiscarded() && !inside.Boundary)
  {
    inside.FindBoundary();
  }
  inside.MovedPoints.clear();
  inside.Moved = {};
  if (isInverse)
  {
    inside.MovedPoints = *inside.Rest.Positions;
    for (std::size_t i = 0; i < inside.MovedPoints.size(); ++i)
    {
      inside.MovedPoints[i] += inside.Displacements[i];
    }
    inside.Moved = inside.Search(inside.MovedPoints);
    this->SolutionTolerance =
      std::max(inside.Rest.Diagonal, inside.Moved.Diagonal) * MeshSolutionTolerance +
      std::max(inside.Rest.Largest, inside.Moved.Largest) * DoubleRounding;
  }
}

bool MeshPointMap::Map(const glm::dvec3& point, Image& image) const
{
  const Internals& inside = *this->Inside;
  Internals::Holder holder = inside.Find(inside.Rest, point);
  if (holder.Number < 0)
  {
    if (this->Outside.AreDiscarded())
    {
      return false;
    }
    // The maps of two faces differ beyond the edge between them; displacements that fade do not.
    const ClosestFace::Result closest =
      this->Outside.AreKept() ? inside.Boundary->Find(point) : inside.Boundary->FindFirst(point);
    if (closest.Face < 0)
    {
      return false; // there are no faces, or squared distances overflow
    }
    if (this->Outside.AreKept())
    {
      inside.Keep(point, closest, this->Outside.FadeDistance, image);
      return true;
    }
    holder = inside.GetHolder(closest.Face);
  }
  const Internals::Displacement displacement = inside.Displace(holder, point);
  image = { point + displacement.Vector, glm::dmat3(1.0) + displacement.Gradient };
  return true;
}

bool MeshPointMap::InvertInside(const glm::dvec3& point, Image& image) const
{
  const Internals& inside = *this->Inside;
  const Internals::Holder holder = inside.Find(inside.Moved, point);
  if (holder.Number < 0)
  {
    return false;
  }
  const Internals::Displacement displacement = inside.Displace(holder, point);
  image = { point - displacement.Vector, glm::dmat3(1.0) - displacement.Gradient };
  return true;
}

} // namespace deformvolume
