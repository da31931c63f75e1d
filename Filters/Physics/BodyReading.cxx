// SPDX-License-Identifier: BSD-3-Clause
#include "BodyReading.h"

#include "BarycentricMap.h"
#include "CellNumbers.h"
#include "CellTypes.h"
#include "Error.h"
#include "HandlePositions.h"
#include "IndexBounds.h"
#include "MaskArray.h"
#include "MeshStamp.h"
#include "ShapedArray.h"
#include "VectorArray.h"

#include "vtkCell.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkGenericCell.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkUnstructuredGrid.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <utility>

namespace deformvolume
{
namespace
{

constexpr const char* MESH = "mesh at rest on input port 0";

vtkDataArray* FindMeshArray(
  vtkDataSetAttributes* attributes, const char* name, int components, vtkIdType tuples)
{
  return FindShapedArray(attributes, name, components, tuples, "array", std::string("the ") + MESH);
}

std::vector<glm::dvec3> ReadAll(vtkDataArray* array, double factor, const char* kind)
{
  std::vector<glm::dvec3> vectors(static_cast<std::size_t>(array->GetNumberOfTuples()));
  ReadVectors(
    array,
    [&](vtkIdType first, const glm::dvec3* read, vtkIdType number)
    {
      std::transform(read, read + number, vectors.begin() + first,
        [&](const glm::dvec3& vector) { return vector * factor; });
    },
    kind, MESH);
  return vectors;
}

int GetCellDimension(int type)
{
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  return cell ? cell->GetCellDimension() : 3;
}

void ReadMaterials(vtkUnstructuredGrid* grid, const BodySettings& settings, BodyMesh& mesh)
{
  const auto find = [&](const char* name)
  { return FindMeshArray(grid->GetCellData(), name, 1, grid->GetNumberOfCells()); };
  vtkDataArray* youngModulus = find(YoungModulusName);
  vtkDataArray* poissonRatio = find(PoissonRatioName);
  vtkDataArray* density = find(DensityName);
  mesh.Body.Materials = { settings.Material };
  if (!youngModulus && !poissonRatio && !density)
  {
    return;
  }
  mesh.Body.Materials.assign(mesh.Cells.size(), settings.Material);
  for (std::size_t t = 0; t < mesh.Cells.size(); ++t)
  {
    ElasticMaterial& material = mesh.Body.Materials[t];
    const auto read = [&](vtkDataArray* array, double& value)
    {
      if (array)
      {
        value = array->GetComponent(mesh.Cells[t], 0);
      }
    };
    read(youngModulus, material.YoungModulus);
    read(poissonRatio, material.PoissonRatio);
    read(density, material.Density);
  }
}

// Sets IsUsed, and sets Size to the diagonal of the bounding box of the used nodes.
void FindUsed(BodyMesh& mesh)
{
  mesh.IsUsed.assign(mesh.Body.Points.size(), 0);
  IndexBounds box;
  for (std::size_t t = 0; t < mesh.Body.Tetrahedra.size(); ++t)
  {
    mesh.Body.ForNodes(t,
      [&](std::int32_t node)
      {
        mesh.IsUsed[static_cast<std::size_t>(node)] = 1;
        box.Add(mesh.Body.Points[static_cast<std::size_t>(node)]);
      });
  }
  mesh.Size = glm::distance(box.Min, box.Max);
}

// The number of nodes of a kind, and the first of them.
struct CountedNodes
{
  std::size_t Number = 0;
  std::size_t First = 0;

  void Add(std::size_t node)
  {
    this->First = this->Number == 0 ? node : this->First;
    ++this->Number;
  }
  // Throws an Error such as "3 nodes of the mesh at rest slide, the first one being number 7. ".
  void ThrowIfAny(const std::string& what, const std::string& advice) const
  {
    if (this->Number > 0)
    {
      throw Error(std::to_string(this->Number) + " nodes of the " + MESH + " " + what +
        ", the first one being number " + std::to_string(this->First) + ". " + advice);
    }
  }
};

void ReadPointArrays(vtkUnstructuredGrid* grid, const BodySettings& settings, BodyMesh& mesh)
{
  const vtkIdType points = grid->GetNumberOfPoints();
  vtkDataArray* fixed = FindMeshArray(grid->GetPointData(), FixedName, 1, points);
  if (fixed)
  {
    mesh.Body.Fixed.resize(mesh.Body.Points.size());
    CountedNodes faulty;
    for (vtkIdType i = 0; i < points; ++i)
    {
      const double value = fixed->GetComponent(i, 0);
      const auto node = static_cast<std::size_t>(i);
      mesh.Body.Fixed[node] = value != 0.0 ? 1 : 0;
      if (std::isnan(value))
      {
        faulty.Add(node);
      }
    }
    faulty.ThrowIfAny("are neither fixed nor free: their value in the point array \"Fixed\" is NaN",
      "Set 0 for free nodes, and 1 for fixed ones.");
  }
  const auto read = [&](const char* name, double factor)
  {
    vtkDataArray* array = FindMeshArray(grid->GetPointData(), name, 3, points);
    return array ? ReadAll(array, factor, name) : std::vector<glm::dvec3>();
  };
  mesh.Forces = read(ForceName, 1.0);
  mesh.Body.SlidingNormals = read(SlidingNormalName, 1.0);
  mesh.Body.SecondSlidingNormals = read(SecondSlidingNormalName, 1.0);
  mesh.PrescribedDisplacements = read(PrescribedDisplacementName, settings.UnitLength);
  const auto need = [](bool isThere, const char* needed, const char* name, const char* advice)
  {
    if (!isThere)
    {
      throw Error(std::string("The ") + MESH + " has the point array \"" + name +
        "\", but none named \"" + needed + "\". " + advice);
    }
  };
  need(fixed || mesh.PrescribedDisplacements.empty(), FixedName, PrescribedDisplacementName,
    "Add that array, with values other than 0 at nodes that are displaced.");
  need(!mesh.Body.SlidingNormals.empty() || mesh.Body.SecondSlidingNormals.empty(),
    SlidingNormalName, SecondSlidingNormalName, "Rename the array.");
}

// Throws an Error for arrays that mass-spring dynamics does not support: prescribed displacements
// of fixed nodes, and sliding nodes.
void CheckForSprings(const BodyMesh& mesh)
{
  CountedNodes displaced;
  CountedNodes sliding;
  for (std::size_t node = 0; node < mesh.Body.Points.size(); ++node)
  {
    const auto has = [&](const std::vector<glm::dvec3>& vectors)
    { return !vectors.empty() && vectors[node] != glm::dvec3(0.0) && mesh.IsUsed[node] != 0; };
    if (has(mesh.PrescribedDisplacements) && mesh.Body.IsFixed(node))
    {
      displaced.Add(node);
    }
    if (has(mesh.Body.SlidingNormals) || has(mesh.Body.SecondSlidingNormals))
    {
      sliding.Add(node);
    }
  }
  const auto getAdvice = [](const char* name)
  {
    return std::string("Springs cannot do that: use vtkFiniteElementDeformation, or remove the "
                       "point array \"") +
      name + "\".";
  };
  displaced.ThrowIfAny(
    "are fixed and have a prescribed displacement", getAdvice(PrescribedDisplacementName));
  sliding.ThrowIfAny("have a sliding normal", getAdvice(SlidingNormalName));
}

// Throws an Error if a mid-side node of the cells belongs to several edges, or is also a corner.
void CheckMidSides(const ElasticBody& body)
{
  constexpr std::uint64_t none = ~std::uint64_t{ 0 };
  constexpr std::uint64_t corner = none - 1;
  std::vector<std::uint64_t> uses(body.Points.size(), none);
  for (const Tetrahedron& tetrahedron : body.Tetrahedra)
  {
    for (const std::int32_t node : tetrahedron)
    {
      uses[static_cast<std::size_t>(node)] = corner;
    }
  }
  std::vector<unsigned char> isBad(body.Points.size(), 0);
  for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
  {
    for (std::size_t edge = 0; edge < std::size(TetrahedronEdges); ++edge)
    {
      if (body.MidSides[t][edge] >= 0)
      {
        const auto node = static_cast<std::size_t>(body.MidSides[t][edge]);
        const auto [low, high] = std::minmax(body.Tetrahedra[t][TetrahedronEdges[edge][0]],
          body.Tetrahedra[t][TetrahedronEdges[edge][1]]);
        const std::uint64_t use =
          static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint64_t>(high);
        isBad[node] |= uses[node] != none && uses[node] != use ? 1 : 0;
        uses[node] = uses[node] == none ? use : uses[node];
      }
    }
  }
  CountedNodes bad;
  for (std::size_t node = 0; node < isBad.size(); ++node)
  {
    if (isBad[node] != 0)
    {
      bad.Add(node);
    }
  }
  bad.ThrowIfAny("are in the middle of an edge, and also a corner or in the middle of another edge",
    "Give each edge a node of its own; the order of nodes must be that of vtkQuadraticTetra.");
}

constexpr double ParallelSine = ElasticBody::ParallelSine;

// Whether a node cannot move along a normal.
bool IsHeldAlong(const ElasticBody& body, std::size_t node, const glm::dvec3& normal)
{
  glm::dvec3 rest = body.IsFixed(node) ? glm::dvec3(0.0) : normal;
  for (const glm::dvec3& own : GetSlidingNormals(body, node))
  {
    rest -= glm::dot(rest, own) * own;
  }
  return glm::length(rest) <= ParallelSine;
}

// The sliding normals of the node in the middle of an edge; 0: none. They are the normals of the
// ends, not normalized, if the edge lies in the sliding plane and both ends stay in it.
std::array<glm::dvec3, 2> GetMiddleNormals(const ElasticBody& body, std::size_t a, std::size_t b)
{
  std::array<glm::dvec3, 2> result{ { glm::dvec3(0.0), glm::dvec3(0.0) } };
  if (body.IsFixed(a) && body.IsFixed(b))
  {
    return result;
  }
  const glm::dvec3 edge = glm::normalize(body.Points[b] - body.Points[a]);
  std::size_t number = 0;
  for (const std::size_t end : { a, b })
  {
    for (const auto* normals : { &body.SlidingNormals, &body.SecondSlidingNormals })
    {
      const glm::dvec3 given = normals->empty() ? glm::dvec3(0.0) : (*normals)[end];
      const glm::dvec3 normal = GetUnitVector(given);
      const bool isNew =
        number == 0 || glm::length(glm::cross(GetUnitVector(result[0]), normal)) > ParallelSine;
      if (number < result.size() && normal != glm::dvec3(0.0) && isNew &&
        std::abs(glm::dot(edge, normal)) <= ParallelSine && IsHeldAlong(body, a, normal) &&
        IsHeldAlong(body, b, normal))
      {
        result[number++] = given;
      }
    }
  }
  return result;
}

void AddMidSides(std::vector<MidSideNodes>&& ofCells, BodyMesh& mesh)
{
  ElasticBody& body = mesh.Body;
  body.MidSides = std::move(ofCells);
  CheckMidSides(body);
  mesh.HasNodesOfCells = std::all_of(body.MidSides.begin(), body.MidSides.end(),
    [](const MidSideNodes& nodes) { return nodes[0] >= 0; });
  mesh.MidSideEnds = AddMidSideNodes(body, &mesh.Forces);
  for (const std::array<std::int32_t, 2>& ends : mesh.MidSideEnds)
  {
    const auto a = static_cast<std::size_t>(ends[0]);
    const auto b = static_cast<std::size_t>(ends[1]);
    if (!mesh.PrescribedDisplacements.empty())
    {
      mesh.PrescribedDisplacements.push_back(
        0.5 * (mesh.PrescribedDisplacements[a] + mesh.PrescribedDisplacements[b]));
    }
    const std::array<glm::dvec3, 2> normals = GetMiddleNormals(body, a, b);
    if (!body.SlidingNormals.empty())
    {
      body.SlidingNormals.push_back(normals[0]);
    }
    if (!body.SecondSlidingNormals.empty())
    {
      body.SecondSlidingNormals.push_back(normals[1]);
    }
  }
}

bool Contains(const ElasticBody& body, std::size_t tetrahedron, const glm::dvec3& position)
{
  constexpr double tolerance = 1e-6;
  BarycentricMap map;
  if (!map.SetTetrahedron(body.Tetrahedra[tetrahedron], body.Points))
  {
    return false;
  }
  const glm::dvec4 weights = map.GetAllWeights(position);
  return std::min({ weights.x, weights.y, weights.z, weights.w }) >= -tolerance;
}

// Adds the nodes that a handle at a position holds. name: of the handle, for messages. isTaken:
// whether another handle holds a node.
void Hold(const std::string& name, const glm::dvec3& position, double radius,
  const glm::dvec3& displacement, const BodyMesh& mesh, std::vector<unsigned char>& isTaken,
  std::vector<HeldNode>& held)
{
  const ElasticBody& body = mesh.Body;
  const std::size_t before = held.size();
  const auto add = [&](std::size_t node)
  {
    if (isTaken[node] == 0 && !body.IsFixed(node))
    {
      isTaken[node] = 1;
      held.push_back({ static_cast<std::int32_t>(node), displacement });
    }
  };
  // Nodes at the same distance from a handle may differ by rounding errors, also of floats.
  constexpr double rounding = 1e-6;
  const double reach = radius + rounding * mesh.Size;
  double least = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    const double distance = glm::distance(body.Points[node], position);
    if (distance < least && mesh.IsUsed[node] != 0)
    {
      least = distance;
      nearest = node;
    }
    if (radius > 0.0 && distance <= reach && mesh.IsUsed[node] != 0)
    {
      add(node);
    }
  }
  // The tissue between the nodes of a coarse mesh: with all nodes of its tetrahedron it follows the
  // handle.
  for (std::size_t t = 0; radius > 0.0 && held.size() == before && t < body.Tetrahedra.size(); ++t)
  {
    if (Contains(body, t, position))
    {
      body.ForNodes(t, [&](std::int32_t node) { add(static_cast<std::size_t>(node)); });
    }
  }
  if (radius == 0.0)
  {
    // A handle that far away is in other units or in another world.
    if (least > mesh.Size)
    {
      throw Error(name +
        " is farther from the body than the body is long. Give its rest position in the "
        "coordinates and the unit of length of the mesh at rest.");
    }
    add(nearest);
  }
  if (held.size() == before)
  {
    throw Error(name +
      (radius > 0.0
          ? " holds no node that could move: no node is within its radius of its rest position, "
            "and no tetrahedron contains this position, or all of their nodes are fixed or held by "
            "another handle. Use a larger radius, or another rest position."
          : " holds no node that could move: the node nearest to its rest position is fixed, or "
            "held by another handle. Use another rest position, or a radius greater than 0."));
  }
}

// Adds a node that a handle holds, unless another handle holds it.
void HoldNode(double index, const glm::dvec3& displacement, const BodyMesh& mesh,
  std::vector<unsigned char>& isTaken, std::vector<HeldNode>& held)
{
  const auto node = static_cast<std::size_t>(index < 0x1p31 ? index : 0x1p31);
  if (node >= isTaken.size() || static_cast<double>(node) != index || mesh.IsUsed[node] == 0 ||
    mesh.Body.IsFixed(node))
  {
    throw Error(std::string("The point array \"") + HeldNodeName + "\" of the handles names node " +
      FormatNumber(index) + ", which is fixed or no node of the mesh.");
  }
  if (isTaken[node] == 0)
  {
    isTaken[node] = 1;
    held.push_back({ static_cast<std::int32_t>(node), displacement });
  }
}

} // namespace

Stamp GetBodyStamp(vtkUnstructuredGrid* grid)
{
  Stamp stamp = GetCellArraysStamp({ grid });
  AddPoints(stamp, grid->GetPoints());
  for (const char* name : { YoungModulusName, PoissonRatioName, DensityName })
  {
    AddArray(stamp, grid->GetCellData()->GetAbstractArray(name));
  }
  for (const char* name : { FixedName, ForceName, PrescribedDisplacementName, SlidingNormalName,
         SecondSlidingNormalName })
  {
    AddArray(stamp, grid->GetPointData()->GetAbstractArray(name));
  }
  return stamp;
}

GridTetrahedra ReadTetrahedra(vtkUnstructuredGrid* grid, bool takesQuadratic)
{
  GridTetrahedra read;
  vtkDataArray* types = GetCellTypes(grid);
  const vtkIdType count = grid->GetNumberOfCells();
  if (count > 0 && (!types || types->GetNumberOfTuples() < count || !grid->GetCells()->IsValid()))
  {
    throw Error(std::string("The cells of the ") + MESH + " are incomplete. Correct the cells.");
  }
  std::map<int, vtkIdType> others;
  const SkippedCells skipped(grid, MESH);
  for (vtkIdType cell = 0; cell < count; ++cell)
  {
    if (skipped.Contain(cell))
    {
      continue;
    }
    const int type = grid->GetCellType(cell);
    const bool isQuadratic = type == VTK_QUADRATIC_TETRA && takesQuadratic;
    if (type != VTK_TETRA && !isQuadratic)
    {
      ++others[type];
      continue;
    }
    vtkIdType size = 0;
    const vtkIdType* points = nullptr;
    grid->GetCells()->GetCellAtId(cell, size, points);
    if (size != (isQuadratic ? 10 : 4))
    {
      throw Error("Cell " + std::to_string(cell) + " of the " + MESH + " has " +
        std::to_string(size) + " points, but a " +
        (isQuadratic ? "quadratic tetrahedron has ten." : "tetrahedron has four.") +
        " Correct the cell.");
    }
    const vtkIdType* const missing = std::find_if(points, points + size,
      [&](vtkIdType point) { return point < 0 || point >= grid->GetNumberOfPoints(); });
    if (missing != points + size)
    {
      throw Error("Cell " + std::to_string(cell) + " of the " + MESH + " refers to point " +
        std::to_string(*missing) + ", but the mesh has only " +
        std::to_string(grid->GetNumberOfPoints()) + " points. Correct the cell.");
    }
    if (skipped.ContainPointOf(points, size))
    {
      continue;
    }
    const auto getPoint = [&](std::size_t i) { return static_cast<std::int32_t>(points[i]); };
    read.Tetrahedra.push_back({ { getPoint(0), getPoint(1), getPoint(2), getPoint(3) } });
    if (takesQuadratic)
    {
      read.MidSides.push_back({ { -1, -1, -1, -1, -1, -1 } });
      for (std::size_t edge = 0; isQuadratic && edge < read.MidSides.back().size(); ++edge)
      {
        read.MidSides.back()[edge] = getPoint(4 + edge);
      }
    }
    read.Cells.push_back(cell);
  }
  for (const auto& [type, number] : others)
  {
    if (GetCellDimension(type) == 3)
    {
      throw Error("The " + std::string(MESH) + " has " + std::to_string(number) +
        " cells of the type " + GetCellName(type) +
        ". Split them into tetrahedra first, for example with vtkDataSetTriangleFilter.");
    }
  }
  return read;
}

BodyMesh ReadBody(vtkUnstructuredGrid* grid, const BodySettings& settings)
{
  BodyMesh mesh;
  const vtkIdType points = grid->GetNumberOfPoints();
  if (points > std::numeric_limits<std::int32_t>::max())
  {
    throw Error(
      std::string("The ") + MESH + " has more than 2,147,483,647 points. Use a coarser mesh.");
  }
  if (points > 0)
  {
    mesh.Body.Points = ReadAll(grid->GetPoints()->GetData(), settings.UnitLength, "Point");
  }
  GridTetrahedra read = ReadTetrahedra(grid, settings.IsQuadratic);
  mesh.Body.Tetrahedra = std::move(read.Tetrahedra);
  mesh.Cells = std::move(read.Cells);
  ReadMaterials(grid, settings, mesh);
  ReadPointArrays(grid, settings, mesh);
  if (settings.IsQuadratic)
  {
    AddMidSides(std::move(read.MidSides), mesh);
  }
  CheckBody(mesh.Body);
  FindUsed(mesh);
  if (!settings.IsQuadratic)
  {
    CheckForSprings(mesh);
  }
  return mesh;
}

std::vector<HeldNode> ReadHandles(
  vtkPointSet* handles, double radius, const BodyMesh& mesh, const BodySettings& settings)
{
  if (!(radius >= 0.0))
  {
    throw Error("HandleRadius is not a number. Set a radius of at least 0.");
  }
  std::vector<HeldNode> held;
  const HandlePositions positions = ReadHandlePositions(handles, "mesh");
  vtkDataArray* nodes = positions.Rest.empty()
    ? nullptr
    : FindShapedArray(handles->GetPointData(), HeldNodeName, 1, handles->GetNumberOfPoints(),
        "point array", "the handles on input port 1");
  std::vector<unsigned char> isTaken(mesh.Body.Points.size(), 0);
  for (std::size_t i = 0; i < positions.Rest.size(); ++i)
  {
    const glm::dvec3 rest = positions.Rest[i] * settings.UnitLength;
    const glm::dvec3 now = positions.Now[i] * settings.UnitLength;
    const double node = nodes ? nodes->GetComponent(static_cast<vtkIdType>(i), 0) : -1.0;
    if (!(node < 0.0))
    {
      HoldNode(node, now - rest, mesh, isTaken, held);
      continue;
    }
    const glm::dvec3& at = positions.Rest[i];
    const std::string name = "Handle " + std::to_string(i) + " with the rest position (" +
      FormatNumber(at.x) + ", " + FormatNumber(at.y) + ", " + FormatNumber(at.z) + ")";
    Hold(name, rest, radius * settings.UnitLength, now - rest, mesh, isTaken, held);
  }
  return held;
}

} // namespace deformvolume
