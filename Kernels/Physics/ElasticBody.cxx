// SPDX-License-Identifier: BSD-3-Clause
#include "ElasticBody.h"

#include "Error.h"
#include "IndexBounds.h"
#include "Watch.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace deformvolume
{
namespace
{

// A tetrahedron is flat where its height is less than this part of its longest edge.
constexpr double LeastHeight = 1e-6;

std::array<glm::dvec3, 3> GetEdges(const ElasticBody& body, const Tetrahedron& tetrahedron)
{
  const auto point = [&](std::size_t i) -> const glm::dvec3&
  { return body.Points[static_cast<std::size_t>(tetrahedron[i])]; };
  return { point(1) - point(0), point(2) - point(0), point(3) - point(0) };
}

// Six times the volume; less than 0 where the nodes go round the other way.
double GetDeterminant(const std::array<glm::dvec3, 3>& edges)
{
  return glm::dot(glm::cross(edges[0], edges[1]), edges[2]);
}

void CheckPoints(const ElasticBody& body)
{
  const auto bad = std::find_if_not(body.Points.begin(), body.Points.end(), IsFinite);
  if (bad != body.Points.end())
  {
    throw Error("The rest position of node " + std::to_string(bad - body.Points.begin()) +
      " is not finite. Give all nodes finite coordinates.");
  }
}

void CheckNodes(Watch& watch, const ElasticBody& body)
{
  ForItems(watch, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      for (const std::int32_t node : body.Tetrahedra[t])
      {
        if (node < 0 || static_cast<std::size_t>(node) >= body.Points.size())
        {
          throw Error("Tetrahedron " + std::to_string(t) + " has the node " + std::to_string(node) +
            ", but the mesh has " + std::to_string(body.Points.size()) + " nodes.");
        }
      }
    });
}

void CheckShapes(Watch& watch, const ElasticBody& body)
{
  std::size_t inverted = 0;
  std::size_t firstInverted = 0;
  ForItems(watch, body.Tetrahedra.size(),
    [&](std::size_t t)
    {
      const std::array<glm::dvec3, 3> edges = GetEdges(body, body.Tetrahedra[t]);
      const double determinant = GetDeterminant(edges);
      double longest = 0.0;
      for (const glm::dvec3& edge : { edges[0], edges[1], edges[2], edges[1] - edges[0],
             edges[2] - edges[0], edges[2] - edges[1] })
      {
        longest = std::max(longest, glm::length(edge));
      }
      if (!(std::abs(determinant) > LeastHeight * longest * longest * longest))
      {
        throw Error("Tetrahedron " + std::to_string(t) +
          " of the rest mesh is flat. Remove such cells, or make a better mesh.");
      }
      if (determinant < 0.0)
      {
        firstInverted = inverted == 0 ? t : firstInverted;
        ++inverted;
      }
    });
  if (inverted > 0 && inverted < body.Tetrahedra.size())
  {
    throw Error(std::to_string(inverted) + " of " + std::to_string(body.Tetrahedra.size()) +
      " tetrahedra of the rest mesh are inside out, the first one being number " +
      std::to_string(firstInverted) +
      ". If only the order of their nodes is wrong, exchange two nodes of each of them; "
      "otherwise make a better mesh.");
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

} // namespace

void CheckBody(const ElasticBody& body, Watch* watch)
{
  Watch none(nullptr);
  Watch& asked = watch ? *watch : none;
  if (body.Tetrahedra.empty())
  {
    throw Error("The rest mesh has no tetrahedra.");
  }
  if (!body.Fixed.empty())
  {
    CheckLength(body.Fixed.size(), body.Points.size(), "marks of fixed nodes");
  }
  CheckPoints(body);
  CheckNodes(asked, body);
  CheckShapes(asked, body);
  CheckMaterials(body, body.Materials);
}

void CheckMaterial(const ElasticMaterial& material, const std::string& where)
{
  if (!(material.YoungModulus > 0.0) || !std::isfinite(material.YoungModulus))
  {
    throw Error("The Young modulus" + where + " is " + std::to_string(material.YoungModulus) +
      " Pa. It must be greater than 0.");
  }
  if (!(material.PoissonRatio >= 0.0 &&
        material.PoissonRatio < ElasticMaterial::LargestPoissonRatio))
  {
    throw Error("The Poisson ratio" + where + " is " + std::to_string(material.PoissonRatio) +
      ". It must be 0 or more, and less than 0.495.");
  }
  if (!(material.Density > 0.0) || !std::isfinite(material.Density))
  {
    throw Error("The density" + where + " is " + std::to_string(material.Density) +
      " kg/m^3. It must be greater than 0.");
  }
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
    CheckMaterial(materials[t], " of tetrahedron " + std::to_string(t));
  }
}

void CheckLoads(const ElasticBody& body, const BodyLoads& loads)
{
  if (!IsFinite(loads.Gravity))
  {
    throw Error("The gravity is not finite.");
  }
  if (loads.Forces.empty())
  {
    return;
  }
  CheckLength(loads.Forces.size(), body.Points.size(), "forces on nodes");
  const auto bad = std::find_if_not(loads.Forces.begin(), loads.Forces.end(), IsFinite);
  if (bad != loads.Forces.end())
  {
    throw Error(
      "The force on node " + std::to_string(bad - loads.Forces.begin()) + " is not finite.");
  }
}

void CheckHeldNodes(const ElasticBody& body, const std::vector<HeldNode>& held)
{
  std::vector<unsigned char> isHeld(body.Points.size(), 0);
  for (const HeldNode& node : held)
  {
    const auto place = static_cast<std::size_t>(node.Node);
    if (node.Node < 0 || place >= body.Points.size())
    {
      throw Error("A handle holds the node " + std::to_string(node.Node) + ", but the mesh has " +
        std::to_string(body.Points.size()) + " nodes.");
    }
    if (!IsFinite(node.Displacement))
    {
      throw Error("The displacement of a handle is not finite.");
    }
    if (body.IsFixed(place) || isHeld[place] != 0)
    {
      throw Error("The node " + std::to_string(node.Node) +
        (body.IsFixed(place) ? " is fixed, and a handle holds it." : " is held by two handles."));
    }
    isHeld[place] = 1;
  }
}

std::vector<double> GetVolumes(const ElasticBody& body)
{
  std::vector<double> volumes(body.Tetrahedra.size());
  std::transform(body.Tetrahedra.begin(), body.Tetrahedra.end(), volumes.begin(),
    [&](const Tetrahedron& tetrahedron)
    { return std::abs(GetDeterminant(GetEdges(body, tetrahedron))) / 6.0; });
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
