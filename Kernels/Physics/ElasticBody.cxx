// SPDX-License-Identifier: BSD-3-Clause
#include "ElasticBody.h"

#include "AbortCheck.h"
#include "CountedLists.h"
#include "Error.h"
#include "IndexBounds.h"
#include "QuadraticTetrahedron.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace deformvolume
{
namespace
{

void CheckPoints(const ElasticBody& body)
{
  const auto bad = std::find_if_not(body.Points.begin(), body.Points.end(), IsFinite);
  if (bad != body.Points.end())
  {
    throw Error("The rest position of node " + std::to_string(bad - body.Points.begin()) +
      " is not finite. Give all nodes finite coordinates.");
  }
}

void CheckNodes(AbortCheck& abortCheck, const ElasticBody& body)
{
  ForItems(abortCheck, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      body.ForNodes(t,
        [&](std::int32_t node)
        {
          if (node < 0 || static_cast<std::size_t>(node) >= body.Points.size())
          {
            throw Error("Tetrahedron " + std::to_string(t) + " has the node " +
              std::to_string(node) + ", but the mesh has " + std::to_string(body.Points.size()) +
              " nodes.");
          }
        });
    });
}

// The number of faulty items, and the first of them.
struct FaultCounter
{
  std::size_t Number = 0;
  std::size_t First = 0;

  void Add(std::size_t number)
  {
    this->First = this->Number == 0 ? number : this->First;
    ++this->Number;
  }
  // Such as "3 of 20 tetrahedra of the mesh at rest are flat, the first one with the points 3, 4, 5
  // and 9. ".
  void Throw(const ElasticBody& body, const std::string& what, const std::string& advice) const
  {
    throw Error(std::to_string(this->Number) + " of " + std::to_string(body.Tetrahedra.size()) +
      " tetrahedra of the mesh at rest " + what + ", the first one with the points " +
      ListNodes(body.Tetrahedra[this->First]) + ". " + advice);
  }
};

void CheckShapes(AbortCheck& abortCheck, const ElasticBody& body)
{
  FaultCounter inverted;
  FaultCounter flat;
  ForItems(abortCheck, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      const std::array<glm::dvec3, 4> points = body.GetCorners(t);
      if (IsFlat(points))
      {
        flat.Add(t);
      }
      else if (GetDeterminant(points) < 0.0)
      {
        inverted.Add(t);
      }
    });
  if (flat.Number > 0)
  {
    flat.Throw(body, "are flat", "Remove such cells, or make a better mesh.");
  }
  if (inverted.Number > 0 && inverted.Number < body.Tetrahedra.size())
  {
    inverted.Throw(body, "are inside out",
      "If only the order of their nodes is wrong, exchange two nodes of each of them; otherwise "
      "make a better mesh.");
  }
}

// Two tetrahedra with the same corners would be twice as stiff as one.
void CheckDuplicates(AbortCheck& abortCheck, const ElasticBody& body)
{
  // The other corners of the tetrahedra with the same lowest corner.
  using Entry = std::array<std::int32_t, 3>;
  std::vector<std::size_t> begins;
  std::vector<std::pair<Entry, std::size_t>> entries;
  Grow(abortCheck, entries, body.Tetrahedra.size());
  MakeLists(
    body.Points.size(),
    [&](const auto& take)
    {
      ForItems(abortCheck, body.Tetrahedra.size(),
        [&](std::size_t t)
        {
          Tetrahedron corners = body.Tetrahedra[t];
          std::sort(corners.begin(), corners.end());
          take(static_cast<std::size_t>(corners[0]),
            std::pair<Entry, std::size_t>{ { { corners[1], corners[2], corners[3] } }, t });
        });
    },
    begins, entries);
  FaultCounter duplicates;
  ForItems(abortCheck, body.Points.size(),
    [&](std::size_t node)
    {
      std::sort(entries.begin() + static_cast<std::ptrdiff_t>(begins[node]),
        entries.begin() + static_cast<std::ptrdiff_t>(begins[node + 1]));
      for (std::size_t i = begins[node] + 1; i < begins[node + 1]; ++i)
      {
        if (entries[i].first == entries[i - 1].first)
        {
          duplicates.Add(entries[i].second);
        }
      }
    });
  if (duplicates.Number > 0)
  {
    duplicates.Throw(body, "have the same corners as another one",
      "Remove them, or mark them as duplicate cells in the cell array \"vtkGhostType\".");
  }
}

// Whether a ten-node tetrahedron overlaps itself: its Jacobian vanishes or changes its sign. Also
// true if one of the linear tetrahedra into which it is split is inverted.
bool IsFolded(const std::array<glm::dvec3, QuadraticTetrahedron::NumberOfNodes>& points)
{
  // With straight edges the determinant is the same everywhere.
  constexpr double leastPart = 1e-3;
  const double corners = glm::determinant(
    glm::dmat3(points[1] - points[0], points[2] - points[0], points[3] - points[0]));
  const auto isBad = [&](const glm::dvec4& weights)
  {
    return !(
      glm::determinant(QuadraticTetrahedron::GetJacobian(points, weights)) / corners > leastPart);
  };
  for (std::size_t i = 0; i < 4; ++i)
  {
    glm::dvec4 corner(0.0);
    corner[static_cast<int>(i)] = 1.0;
    if (isBad(corner) || isBad(QuadraticTetrahedron::GetGaussPoint(i)))
    {
      return true;
    }
  }
  return QuadraticTetrahedron::IsSplitInverted(points, corners < 0.0) ||
    std::any_of(std::begin(TetrahedronEdges), std::end(TetrahedronEdges),
      [&](const std::size_t(&ends)[2])
      {
        glm::dvec4 middle(0.0);
        middle[static_cast<int>(ends[0])] = 0.5;
        middle[static_cast<int>(ends[1])] = 0.5;
        return isBad(middle);
      });
}

void CheckMidSides(AbortCheck& abortCheck, const ElasticBody& body)
{
  FaultCounter folded;
  ForItems(abortCheck, body.MidSides.size(),
    [&](std::size_t t)
    {
      if (IsFolded(QuadraticTetrahedron::GetPoints(body, t)))
      {
        folded.Add(t);
      }
    });
  if (folded.Number > 0)
  {
    folded.Throw(body, "overlap themselves, as mid-side nodes are misplaced",
      "Each must lie near the middle of its edge, and the order of nodes must be that of "
      "vtkQuadraticTetra.");
  }
}

void CheckLength(std::size_t length, std::size_t wanted, const std::string& what)
{
  if (length != wanted)
  {
    throw Error("There are " + std::to_string(length) + " " + what + ", but " +
      std::to_string(wanted) + " are needed.");
  }
}

void CheckSliding(const ElasticBody& body)
{
  std::vector<bool> slides(body.Points.size(), false);
  for (const auto* normals : { &body.SlidingNormals, &body.SecondSlidingNormals })
  {
    if (!normals->empty())
    {
      CheckLength(normals->size(), body.Points.size(), "normals of sliding nodes");
    }
    for (std::size_t node = 0; node < normals->size(); ++node)
    {
      const glm::dvec3& normal = (*normals)[node];
      if (!IsFinite(normal))
      {
        throw Error("The sliding normal of node " + std::to_string(node) + " is not finite.");
      }
      slides[node] = slides[node] || normal != glm::dvec3(0.0);
    }
  }
  FaultCounter contradictory;
  for (std::size_t node = 0; node < slides.size(); ++node)
  {
    if (slides[node] && body.IsFixed(node))
    {
      contradictory.Add(node);
    }
  }
  if (contradictory.Number > 0)
  {
    throw Error(std::to_string(contradictory.Number) +
      " nodes have contradictory conditions: they are fixed, and have a sliding normal. The first "
      "of them is node " +
      std::to_string(contradictory.First) + ". Set one of the two to 0.");
  }
}

} // namespace

glm::dvec3 GetUnitVector(const glm::dvec3& vector)
{
  const glm::dvec3 sizes = glm::abs(vector);
  const double largest = std::max({ sizes.x, sizes.y, sizes.z });
  // Scale first: squares of tiny components are 0, those of huge components infinite.
  return largest > 0.0 ? glm::normalize(vector / largest) : vector;
}

std::array<glm::dvec3, 2> GetSlidingNormals(const ElasticBody& body, std::size_t node)
{
  const auto get = [&](const std::vector<glm::dvec3>& normals)
  { return normals.empty() ? glm::dvec3(0.0) : GetUnitVector(normals[node]); };
  const glm::dvec3 first = get(body.SlidingNormals);
  const glm::dvec3 second = get(body.SecondSlidingNormals);
  const glm::dvec3 across = second - glm::dot(second, first) * first;
  return { first,
    glm::length(across) > ElasticBody::ParallelSine ? glm::normalize(across) : glm::dvec3(0.0) };
}

bool IsFlat(const std::array<glm::dvec3, 4>& points)
{
  constexpr double leastHeight = 1e-6;
  double longest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      longest = std::max(longest, glm::distance(points[i], points[j]));
    }
  }
  return !(std::abs(GetDeterminant(points)) > leastHeight * longest * longest * longest);
}

void CheckBody(const ElasticBody& body, AbortCheck* abortCheck)
{
  AbortCheck none(nullptr);
  AbortCheck& given = abortCheck ? *abortCheck : none;
  if (body.Tetrahedra.empty())
  {
    throw Error("The mesh at rest has no tetrahedra, or all of them are hidden.");
  }
  if (!body.Fixed.empty())
  {
    CheckLength(body.Fixed.size(), body.Points.size(), "marks of fixed nodes");
  }
  if (!body.MidSides.empty())
  {
    CheckLength(body.MidSides.size(), body.Tetrahedra.size(), "tetrahedra with mid-side nodes");
  }
  CheckPoints(body);
  CheckNodes(given, body);
  CheckShapes(given, body);
  CheckDuplicates(given, body);
  CheckMidSides(given, body);
  CheckSliding(body);
  CheckMaterials(body, body.Materials);
}

void CheckMaterial(const ElasticMaterial& material, const std::string& where)
{
  if (!(material.YoungModulus > 0.0) || !std::isfinite(material.YoungModulus))
  {
    throw Error("The Young modulus" + where + " is " + FormatNumber(material.YoungModulus) +
      " Pa. It must be greater than 0.");
  }
  if (!(material.PoissonRatio >= 0.0 &&
        material.PoissonRatio < ElasticMaterial::LargestPoissonRatio))
  {
    throw Error("The Poisson ratio" + where + " is " + FormatNumber(material.PoissonRatio) +
      ". It must be 0 or more, and less than 0.495.");
  }
  if (!(material.Density > 0.0) || !std::isfinite(material.Density))
  {
    throw Error("The density" + where + " is " + FormatNumber(material.Density) +
      " kg/m^3. It must be greater than 0.");
  }
}

std::string ListNodes(const Tetrahedron& tetrahedron)
{
  const auto name = [&](std::size_t i) { return std::to_string(tetrahedron[i]); };
  return name(0) + ", " + name(1) + ", " + name(2) + " and " + name(3);
}

void CheckMaterials(const ElasticBody& body, const std::vector<ElasticMaterial>& materials)
{
  if (materials.size() == 1)
  {
    CheckMaterial(materials.front(), "");
    return;
  }
  CheckLength(materials.size(), body.Tetrahedra.size(), "materials");
  for (std::size_t t = 0; t < materials.size(); ++t)
  {
    CheckMaterial(
      materials[t], " of the tetrahedron with the points " + ListNodes(body.Tetrahedra[t]));
  }
}

void CheckLoads(const ElasticBody& body, const BodyLoads& loads)
{
  if (!IsFinite(loads.Gravity))
  {
    throw Error("The gravity is not finite.");
  }
  const auto check = [&](const std::vector<glm::dvec3>& vectors, const char* all, const char* one)
  {
    if (vectors.empty())
    {
      return;
    }
    CheckLength(vectors.size(), body.Points.size(), all);
    const auto bad = std::find_if_not(vectors.begin(), vectors.end(), IsFinite);
    if (bad != vectors.end())
    {
      throw Error(std::string("The ") + one + " node " + std::to_string(bad - vectors.begin()) +
        " is not finite.");
    }
  };
  check(loads.Forces, "forces on nodes", "force on");
  check(loads.FixedDisplacements, "displacements of fixed nodes", "prescribed displacement of");
}

void CheckHeldNodes(const ElasticBody& body, const std::vector<HeldNode>& held)
{
  std::vector<unsigned char> isHeld(body.Points.size(), 0);
  for (const HeldNode& heldNode : held)
  {
    const auto node = static_cast<std::size_t>(heldNode.Node);
    if (heldNode.Node < 0 || node >= body.Points.size())
    {
      throw Error("A handle holds the node " + std::to_string(heldNode.Node) +
        ", but the mesh has " + std::to_string(body.Points.size()) + " nodes.");
    }
    if (!IsFinite(heldNode.Displacement))
    {
      throw Error("The displacement of the handle that holds node " +
        std::to_string(heldNode.Node) + " is not finite.");
    }
    if (body.IsFixed(node) || isHeld[node] != 0)
    {
      throw Error("The node " + std::to_string(heldNode.Node) +
        (body.IsFixed(node) ? " is fixed, and a handle holds it." : " is held by two handles."));
    }
    isHeld[node] = 1;
  }
}

std::vector<double> GetVolumes(const ElasticBody& body)
{
  std::vector<double> volumes(body.Tetrahedra.size());
  for (std::size_t t = 0; t < volumes.size(); ++t)
  {
    volumes[t] = std::abs(GetDeterminant(body.GetCorners(t))) / 6.0;
  }
  return volumes;
}

std::vector<double> GetNodeMasses(const ElasticBody& body, const std::vector<double>& volumes)
{
  std::vector<double> masses(body.Points.size(), 0.0);
  for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
  {
    const double quarter = 0.25 * volumes[t] * body.GetMaterial(t).Density;
    for (const std::int32_t node : body.Tetrahedra[t])
    {
      masses[static_cast<std::size_t>(node)] += quarter;
    }
  }
  return masses;
}

} // namespace deformvolume
