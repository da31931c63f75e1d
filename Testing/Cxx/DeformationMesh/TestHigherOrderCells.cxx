// SPDX-License-Identifier: BSD-3-Clause
// Quadratic and Lagrange cells, and concave polyhedra. Their tetrahedra must fill the cells,
// conform with those of neighboring cells, and use all nodes. In finer meshes their displacements
// must converge to those of the cells' shape functions at the rate of linear interpolation.
#include "FilterTesting.h"
#include "MeshCells.h"

#include "CellLattices.h"
#include "CellNumbers.h"
#include "Error.h"

#include <vtkCell.h>
#include <vtkCell3D.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCellTypeSource.h>
#include <vtkDoubleArray.h>
#include <vtkGenericCell.h>
#include <vtkHigherOrderHexahedron.h>
#include <vtkHigherOrderTetra.h>
#include <vtkHigherOrderWedge.h>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

using namespace filterTesting;
using deformvolume::Tetrahedron;

namespace
{

using Grid = vtkSmartPointer<vtkUnstructuredGrid>;

double GetVolume(const std::vector<glm::dvec3>& points, const Tetrahedron& nodes)
{
  const glm::dvec3 origin = points[nodes[0]];
  return std::abs(glm::determinant(glm::dmat3(
           points[nodes[1]] - origin, points[nodes[2]] - origin, points[nodes[3]] - origin))) /
    6.0;
}

// The vectors of the nodes of a mesh, followed by those of the derived nodes.
std::vector<glm::dvec3> AddDerived(
  const std::vector<glm::dvec3>& vectors, const deformvolume::MeshCells& cells)
{
  std::vector<glm::dvec3> all = vectors;
  for (std::size_t i = 0; i < cells.Derived.GetCount(); ++i)
  {
    all.push_back(cells.Derived.Sum(i, [&](std::int32_t node) { return vectors[node]; }));
  }
  return all;
}

std::vector<glm::dvec3> GetPoints(vtkUnstructuredGrid* grid, const deformvolume::MeshCells& cells)
{
  std::vector<glm::dvec3> points;
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    points.push_back(GetPoint(grid, id));
  }
  return AddDerived(points, cells);
}

// Returns a number for each point, which is the same for points with the same position.
std::vector<std::int32_t> FindPlaces(const std::vector<glm::dvec3>& points)
{
  std::map<std::array<double, 3>, std::int32_t> known;
  std::vector<std::int32_t> places;
  for (const glm::dvec3& point : points)
  {
    const auto number = static_cast<std::int32_t>(known.size());
    places.push_back(
      known.emplace(std::array<double, 3>{ { point.x, point.y, point.z } }, number).first->second);
  }
  return places;
}

// Checks that the tetrahedra of a grid are a conforming mesh if coincident points are merged. Each
// face belongs to one or two tetrahedra. area: the total area of the faces that belong to only one
// tetrahedron. volume: the total volume of the tetrahedra, which must use every node.
void CheckFilled(const std::string& what, vtkUnstructuredGrid* grid, double volume, double area)
{
  const deformvolume::MeshCells cells = deformvolume::ReadCells({ grid }, { grid });
  const std::vector<Tetrahedron>& tetrahedra = cells.Tetrahedra;
  const std::vector<glm::dvec3> points = GetPoints(grid, cells);
  const std::vector<std::int32_t> places = FindPlaces(points);
  std::set<std::int32_t> used;
  struct Face
  {
    double Area;
    int Count;
  };
  std::map<std::array<std::int32_t, 3>, Face> faces;
  double sum = 0.0;
  double least = volume;
  for (const Tetrahedron& tetrahedron : tetrahedra)
  {
    used.insert(tetrahedron.begin(), tetrahedron.end());
    for (std::size_t opposite = 0; opposite < 4; ++opposite)
    {
      std::array<std::int32_t, 3> face;
      std::array<glm::dvec3, 3> corners;
      for (std::size_t i = 0, j = 0; i < 4; ++i)
      {
        if (i != opposite)
        {
          corners[j] = points[tetrahedron[i]];
          face[j++] = places[tetrahedron[i]];
        }
      }
      std::sort(face.begin(), face.end());
      const double faceArea =
        0.5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
      ++faces.emplace(face, Face{ faceArea, 0 }).first->second.Count;
    }
    const double part = GetVolume(points, tetrahedron);
    sum += part;
    least = std::min(least, part);
  }
  double surface = 0.0;
  int most = 0;
  for (const auto& face : faces)
  {
    most = std::max(most, face.second.Count);
    surface += face.second.Count == 1 ? face.second.Area : 0.0;
  }
  // The tolerance allows for rounding in sums of some thousand numbers of order one.
  EXPECT_NEAR(sum, volume, 1e-10 * volume) << what;
  EXPECT_NEAR(surface, area, 1e-10 * area) << what;
  EXPECT_LE(most, 2) << what;
  EXPECT_GE(least, 1e-6 * volume / static_cast<double>(tetrahedra.size())) << what;
  EXPECT_EQ(used.size(), points.size()) << what;
}

// The same mesh with its points in another order: how cells are split depends on the ids of points.
Grid Shuffle(vtkUnstructuredGrid* grid, unsigned int seed)
{
  std::vector<vtkIdType> newIds(static_cast<std::size_t>(grid->GetNumberOfPoints()));
  std::iota(newIds.begin(), newIds.end(), 0);
  std::mt19937 random(seed);
  std::shuffle(newIds.begin(), newIds.end(), random);
  Grid shuffled = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(grid->GetNumberOfPoints());
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    points->SetPoint(newIds[id], grid->GetPoint(id));
  }
  shuffled->SetPoints(points);
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> ids;
    grid->GetCellPoints(cell, ids);
    for (vtkIdType& id : *ids)
    {
      id = newIds[id];
    }
    shuffled->InsertNextCell(grid->GetCellType(cell), ids);
  }
  shuffled->GetCellData()->ShallowCopy(grid->GetCellData());
  return shuffled;
}

// The same cells, each with points of its own.
Grid Separate(vtkUnstructuredGrid* grid)
{
  Grid separated = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> ids;
    grid->GetCellPoints(cell, ids);
    for (vtkIdType& id : *ids)
    {
      id = points->InsertNextPoint(grid->GetPoint(id));
    }
    separated->InsertNextCell(grid->GetCellType(cell), ids);
  }
  separated->SetPoints(points);
  return separated;
}

// Checks a grid with its points in several orders, and with each cell separated from the others.
void CheckOrders(const std::string& what, vtkUnstructuredGrid* grid, double volume, double area,
  unsigned int seeds)
{
  const Grid separated = Separate(grid);
  for (unsigned int seed = 0; seed < seeds; ++seed)
  {
    CheckFilled(what, Shuffle(grid, seed), volume, area);
    CheckFilled(what + ", separated", Shuffle(separated, seed), volume, area);
  }
}

// Makes quadratic cells from their corners: adds nodes in the middle of edges, of faces and of the
// cell, in the order of VTK's cell type. Cells share nodes that are in the middle of the same
// corners.
class Elevation
{
public:
  explicit Elevation(const std::vector<glm::dvec3>& corners)
    : Corners(corners)
  {
    this->Mesh->SetPoints(this->Points);
    this->Points->SetDataTypeToDouble();
  }

  void Add(int type, const std::vector<int>& corners)
  {
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
    const vtkIdType count = cell->GetNumberOfPoints();
    std::vector<std::vector<int>> between(static_cast<std::size_t>(count), corners);
    for (vtkIdType i = 0; i < count; ++i)
    {
      cell->PointIds->SetId(i, i);
    }
    const auto number = static_cast<vtkIdType>(corners.size());
    for (vtkIdType i = 0; i < number; ++i)
    {
      between[i] = { corners[i] };
    }
    const auto take = [&](vtkCell* side, std::size_t sideCorners)
    {
      vtkIdList* ids = side->PointIds;
      if (ids->GetNumberOfIds() > static_cast<vtkIdType>(sideCorners))
      {
        std::vector<int> those;
        for (std::size_t i = 0; i < sideCorners; ++i)
        {
          those.push_back(corners[ids->GetId(i)]);
        }
        between[ids->GetId(ids->GetNumberOfIds() - 1)] = those;
      }
    };
    for (int i = 0; i < cell->GetNumberOfFaces(); ++i)
    {
      vtkCell* face = cell->GetFace(i);
      const vtkIdType size = face->PointIds->GetNumberOfIds();
      if (size == 9 || size == 7) // a node in the middle
      {
        take(face, static_cast<std::size_t>(size / 2));
      }
    }
    for (int i = 0; i < cell->GetNumberOfEdges(); ++i)
    {
      take(cell->GetEdge(i), 2);
    }
    vtkNew<vtkIdList> ids;
    for (const std::vector<int>& some : between)
    {
      ids->InsertNextId(this->GetNode(some));
    }
    this->Mesh->InsertNextCell(type, ids);
  }

  Grid Mesh = Grid::New();

private:
  vtkIdType GetNode(std::vector<int> corners)
  {
    glm::dvec3 middle(0.0);
    for (const int corner : corners)
    {
      middle += this->Corners[corner] / static_cast<double>(corners.size());
    }
    std::sort(corners.begin(), corners.end());
    const auto found = this->Nodes.emplace(corners, this->Points->GetNumberOfPoints());
    if (found.second)
    {
      this->Points->InsertNextPoint(&middle.x);
    }
    return found.first->second;
  }

  std::vector<glm::dvec3> Corners;
  std::map<std::vector<int>, vtkIdType> Nodes;
  vtkNew<vtkPoints> Points;
};

// A cube with a pyramid on its top, a tetrahedron at a side of the pyramid, and a wedge at a side
// of the cube.
Grid MakeMixedMesh()
{
  Elevation mesh({ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 },
    { 1, 1, 1 }, { 0, 1, 1 }, { 0.5, 0.5, 2 }, { 0.5, -0.5, 1.5 }, { 2, 0, 0 }, { 2, 0, 1 } });
  mesh.Add(VTK_QUADRATIC_HEXAHEDRON, { 0, 1, 2, 3, 4, 5, 6, 7 });
  mesh.Add(VTK_QUADRATIC_PYRAMID, { 4, 5, 6, 7, 8 });
  mesh.Add(VTK_QUADRATIC_TETRA, { 4, 9, 5, 8 });
  mesh.Add(VTK_QUADRATIC_WEDGE, { 1, 10, 2, 5, 11, 6 });
  return mesh.Mesh;
}

TEST(HigherOrderCells, Neighbors)
{
  // Cells of these types have the same nodes on the faces between them. The surface consists of
  // four faces of the cube, two triangles and two sides of the wedge, three sides of the pyramid,
  // and three sides of the tetrahedron.
  const glm::dvec3 a(0, 0, 1), b(1, 0, 1), c(0.5, 0.5, 2), d(0.5, -0.5, 1.5);
  const auto triangle = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r)
  { return 0.5 * glm::length(glm::cross(q - p, r - p)); };
  const double area = 4.0 + 1.0 + 1.0 + std::sqrt(2.0) + 3.0 * triangle(a, b, c) +
    triangle(a, b, d) + triangle(a, c, d) + triangle(b, c, d);
  const double tetrahedron = std::abs(glm::determinant(glm::dmat3(b - a, c - a, d - a))) / 6.0;
  CheckOrders("a mixed mesh", MakeMixedMesh(), 1.0 + 1.0 / 3.0 + 0.5 + tetrahedron, area, 50);
  // Cells whose faces have a node in their middle.
  for (const int hexahedron : { VTK_TRIQUADRATIC_HEXAHEDRON, VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON })
  {
    Elevation mesh({ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 },
      { 1, 1, 1 }, { 0, 1, 1 }, { 2, 0, 0 }, { 2, 0, 1 } });
    mesh.Add(hexahedron, { 0, 1, 2, 3, 4, 5, 6, 7 });
    mesh.Add(VTK_BIQUADRATIC_QUADRATIC_WEDGE, { 1, 8, 2, 5, 9, 6 });
    CheckOrders("hexahedron and wedge", mesh.Mesh, 1.5, 7.0 + std::sqrt(2.0), 50);
  }
  Elevation center({ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 },
    { 1, 1, 1 }, { 0, 1, 1 }, { 0.5, 0.5, 2 } });
  center.Add(VTK_TRIQUADRATIC_HEXAHEDRON, { 0, 1, 2, 3, 4, 5, 6, 7 });
  center.Add(VTK_TRIQUADRATIC_PYRAMID, { 4, 5, 6, 7, 8 });
  Elevation linear({ { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 }, { 0, 1, 1 },
    { 0, 0, 2 }, { 1, 0, 2 }, { 0, 1, 2 } });
  linear.Add(VTK_QUADRATIC_LINEAR_WEDGE, { 0, 1, 2, 3, 4, 5 });
  linear.Add(VTK_QUADRATIC_LINEAR_WEDGE, { 3, 4, 5, 6, 7, 8 });
  CheckOrders(
    "hexahedron and pyramid", center.Mesh, 1.0 + 1.0 / 3.0, 5.0 + 4.0 * triangle(a, b, c), 50);
  CheckOrders("linear wedges", linear.Mesh, 1.0, 1.0 + 4.0 + 2.0 * std::sqrt(2.0), 50);
}

Grid MakeBlocks(int type, int order, bool complete, int blocks)
{
  vtkNew<vtkCellTypeSource> source;
  source->SetCellType(type);
  source->SetCellOrder(order);
  source->SetCompleteQuadraticSimplicialElements(complete);
  source->SetBlocksDimensions(blocks, blocks, blocks);
  source->SetOutputPrecision(vtkAlgorithm::DOUBLE_PRECISION);
  source->Update();
  // Merge the points of neighboring cells. In cells of higher degrees they differ by rounding.
  Grid grid = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  std::map<std::array<long, 3>, vtkIdType> known;
  for (vtkIdType cell = 0; cell < source->GetOutput()->GetNumberOfCells(); ++cell)
  {
    vtkNew<vtkIdList> ids;
    source->GetOutput()->GetCellPoints(cell, ids);
    for (vtkIdType& id : *ids)
    {
      const glm::dvec3 point = GetPoint(source->GetOutput(), id);
      const auto found = known.emplace(std::array<long, 3>{ { std::lround(1e6 * point.x),
                                         std::lround(1e6 * point.y), std::lround(1e6 * point.z) } },
        points->GetNumberOfPoints());
      if (found.second)
      {
        points->InsertNextPoint(&point.x);
      }
      id = found.first->second;
    }
    grid->InsertNextCell(type, ids);
  }
  grid->SetPoints(points);
  return grid;
}

struct Shape
{
  const char* Name;
  int Type;
  int Order = 2;
  bool Complete = false;
};

const std::vector<Shape>& GetShapes()
{
  static const std::vector<Shape> shapes{ { "quadratic tetrahedra", VTK_QUADRATIC_TETRA },
    { "quadratic hexahedra", VTK_QUADRATIC_HEXAHEDRON },
    { "quadratic wedges", VTK_QUADRATIC_WEDGE }, { "quadratic pyramids", VTK_QUADRATIC_PYRAMID },
    { "Lagrange tetrahedra of degree 1", VTK_LAGRANGE_TETRAHEDRON, 1 },
    { "Lagrange tetrahedra of degree 2", VTK_LAGRANGE_TETRAHEDRON, 2 },
    { "Lagrange tetrahedra of 15 points", VTK_LAGRANGE_TETRAHEDRON, 2, true },
    { "Lagrange tetrahedra of degree 3", VTK_LAGRANGE_TETRAHEDRON, 3 },
    { "Lagrange tetrahedra of degree 5", VTK_LAGRANGE_TETRAHEDRON, 5 },
    { "Lagrange hexahedra of degree 1", VTK_LAGRANGE_HEXAHEDRON, 1 },
    { "Lagrange hexahedra of degree 2", VTK_LAGRANGE_HEXAHEDRON, 2 },
    { "Lagrange hexahedra of degree 4", VTK_LAGRANGE_HEXAHEDRON, 4 },
    { "Lagrange wedges of degree 1", VTK_LAGRANGE_WEDGE, 1 },
    { "Lagrange wedges of degree 2", VTK_LAGRANGE_WEDGE, 2 },
    { "Lagrange wedges of 21 points", VTK_LAGRANGE_WEDGE, 2, true },
    { "Lagrange wedges of degree 3", VTK_LAGRANGE_WEDGE, 3 } };
  return shapes;
}

TEST(HigherOrderCells, Blocks)
{
  for (const Shape& shape : GetShapes())
  {
    CheckOrders(shape.Name, MakeBlocks(shape.Type, shape.Order, shape.Complete, 2), 8.0, 24.0, 5);
  }
}

// Checks that the cells of a grid cannot be read, with an error that contains these words.
void ExpectError(vtkUnstructuredGrid* grid, const std::string& words)
{
  try
  {
    deformvolume::ReadCells({ grid }, { grid });
    ADD_FAILURE() << "expected the error \"" << words << "\", but there was none";
  }
  catch (const deformvolume::Error& error)
  {
    EXPECT_TRUE(HasPart(error.what(), words));
  }
}

// Lagrange cells with a different degree along each axis. The degrees are a cell array.
TEST(HigherOrderCells, Degrees)
{
  const struct
  {
    int Type;
    std::array<int, 3> Degrees;
    double Volume, Area;
  } cells[] = { { VTK_LAGRANGE_HEXAHEDRON, { { 2, 1, 3 } }, 1.0, 6.0 },
    { VTK_LAGRANGE_HEXAHEDRON, { { 1, 4, 2 } }, 1.0, 6.0 },
    { VTK_LAGRANGE_WEDGE, { { 2, 2, 1 } }, 0.5, 3.0 + std::sqrt(2.0) },
    { VTK_LAGRANGE_WEDGE, { { 1, 1, 4 } }, 0.5, 3.0 + std::sqrt(2.0) },
    { VTK_LAGRANGE_WEDGE, { { 3, 3, 2 } }, 0.5, 3.0 + std::sqrt(2.0) } };
  for (const auto& expected : cells)
  {
    const std::array<int, 3>& n = expected.Degrees;
    const int count = expected.Type == VTK_LAGRANGE_HEXAHEDRON
      ? (n[0] + 1) * (n[1] + 1) * (n[2] + 1)
      : (n[0] + 1) * (n[0] + 2) / 2 * (n[2] + 1);
    Grid grid = Grid::New();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(count);
    grid->SetPoints(points);
    std::vector<vtkIdType> ids(static_cast<std::size_t>(count));
    std::iota(ids.begin(), ids.end(), 0);
    grid->InsertNextCell(expected.Type, count, ids.data());
    vtkNew<vtkDoubleArray> degrees;
    degrees->SetName("degrees");
    degrees->SetNumberOfComponents(3);
    degrees->InsertNextTuple3(n[0], n[1], n[2]);
    grid->GetCellData()->SetHigherOrderDegrees(degrees);
    const double* coordinates = grid->GetCell(0)->GetParametricCoords();
    for (vtkIdType id = 0; id < count; ++id)
    {
      points->SetPoint(id, coordinates + 3 * id);
    }
    CheckFilled("a cell of several degrees", grid, expected.Volume, expected.Area);
    degrees->SetNumberOfTuples(0);
    ExpectError(grid, "0 tuples of 3 components for 1 cells");
  }
}

glm::dvec3 Curve(const glm::dvec3& p)
{
  return p + 0.04 * glm::dvec3(std::sin(3.0 * p.y), std::sin(2.5 * p.z + 1.0), std::cos(3.0 * p.x));
}
glm::dvec3 Move(const glm::dvec3& p)
{
  return glm::dvec3(
    std::sin(2.0 * p.x + p.y), std::cos(2.0 * p.y - p.z), std::sin(1.5 * p.z + p.x));
}

// The root mean square of the differences between displacements by tetrahedra and by shape
// functions, at random points of curved cells in a unit cube.
double FindDifference(const Shape& shape, int blocks)
{
  const Grid grid = MakeBlocks(shape.Type, shape.Order, shape.Complete, blocks);
  std::vector<glm::dvec3> displacements;
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = Curve(GetPoint(grid, id) / static_cast<double>(blocks));
    grid->GetPoints()->SetPoint(id, &point.x);
    displacements.push_back(Move(point));
  }
  const deformvolume::MeshCells cells = deformvolume::ReadCells({ grid }, { grid });
  const std::vector<Tetrahedron>& tetrahedra = cells.Tetrahedra;
  const std::vector<glm::dvec3> points = GetPoints(grid, cells);
  displacements = AddDerived(displacements, cells);
  std::vector<glm::dmat3> inverses;
  for (const Tetrahedron& nodes : tetrahedra)
  {
    const glm::dvec3 last = points[nodes[3]];
    inverses.push_back(glm::inverse(
      glm::dmat3(points[nodes[0]] - last, points[nodes[1]] - last, points[nodes[2]] - last)));
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double sum = 0.0;
  int found = 0;
  for (int sample = 0; sample < 600; ++sample)
  {
    const auto id =
      static_cast<vtkIdType>(unit(random) * static_cast<double>(grid->GetNumberOfCells()));
    vtkCell* cell = grid->GetCell(std::min(id, grid->GetNumberOfCells() - 1));
    glm::dvec3 place(unit(random), unit(random), unit(random));
    const bool simplex = cell->GetNumberOfFaces() == 4;
    if ((simplex && place.x + place.y + place.z > 1.0) ||
      (cell->GetNumberOfFaces() == 5 && cell->GetNumberOfEdges() == 9 && place.x + place.y > 1.0))
    {
      continue;
    }
    int subId = 0;
    glm::dvec3 position;
    std::vector<double> weights(static_cast<std::size_t>(cell->GetNumberOfPoints()));
    cell->EvaluateLocation(subId, &place.x, &position.x, weights.data());
    glm::dvec3 expected(0.0);
    for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i)
    {
      expected += weights[i] * displacements[cell->GetPointId(static_cast<int>(i))];
    }
    for (std::size_t t = 0; t < tetrahedra.size(); ++t)
    {
      const Tetrahedron& nodes = tetrahedra[t];
      const glm::dvec3 w = inverses[t] * (position - points[nodes[3]]);
      const double last = 1.0 - w.x - w.y - w.z;
      if (std::min({ w.x, w.y, w.z, last }) >= -1e-9)
      {
        const glm::dvec3 actual = w.x * displacements[nodes[0]] + w.y * displacements[nodes[1]] +
          w.z * displacements[nodes[2]] + last * displacements[nodes[3]];
        sum += glm::dot(actual - expected, actual - expected);
        ++found;
        break;
      }
    }
  }
  // Other samples are between a curved boundary and its triangles, or outside the cell.
  EXPECT_GT(found, 80);
  return std::sqrt(sum / found);
}

TEST(HigherOrderCells, Convergence)
{
  for (const Shape& shape : GetShapes())
  {
    const double coarse = FindDifference(shape, 2);
    const double fine = FindDifference(shape, 4);
    std::cout << shape.Name << ": the error is " << coarse << ", and " << fine
              << " with cells of half the size: order " << std::log2(coarse / fine) << '\n';
    // The order is less than 2, since terms of higher order matter in cells of this size. Linear
    // cells are exact.
    const bool linear = shape.Type == VTK_LAGRANGE_TETRAHEDRON && shape.Order == 1;
    EXPECT_LT(fine, linear ? 1e-12 : 0.05) << shape.Name;
    EXPECT_TRUE(linear || std::log2(coarse / fine) > 1.7) << shape.Name;
  }
}

void ExpectError(int type, vtkIdType count, const std::string& words)
{
  SCOPED_TRACE(testing::Message() << "a cell of type " << type << " with " << count << " points");
  Grid grid = Grid::New();
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(200);
  grid->SetPoints(points);
  std::vector<vtkIdType> ids(200);
  std::iota(ids.begin(), ids.end(), 0);
  grid->InsertNextCell(type, count, ids.data());
  ExpectError(grid, words);
}

TEST(HigherOrderCells, Errors)
{
  ExpectError(VTK_QUADRATIC_TETRA, 9, "quadratic tetra with 9 points instead of 10");
  ExpectError(VTK_QUADRATIC_HEXAHEDRON, 8, "quadratic hexahedron with 8 points instead of 20");
  ExpectError(VTK_TRIQUADRATIC_PYRAMID, 20, "with 20 points instead of 19");
  for (const vtkIdType count : { 0, 1, 11, 14, 16 })
  {
    ExpectError(VTK_LAGRANGE_TETRAHEDRON, count, "points, which does not fit its degree");
  }
  ExpectError(VTK_LAGRANGE_HEXAHEDRON, 26, "lagrange hexahedron with 26 points, which does not");
  ExpectError(VTK_LAGRANGE_WEDGE, 20, "lagrange wedge with 20 points, which does not");
  for (const int type : { VTK_BEZIER_TETRAHEDRON, VTK_BEZIER_HEXAHEDRON, VTK_BEZIER_WEDGE })
  {
    ExpectError(type, 10, "convert the mesh");
  }
}

// A volume that a cube of twelve tetrahedra bends. The reference is the exact inverse map.
TEST(HigherOrderCells, Volume)
{
  auto volume = MakeImage({ { 0, 20, 0, 20, 0, 20 } });
  const auto value = [](const glm::dvec3& p) { return 3.0 * p.x + 5.0 * p.y - 2.0 * p.z; };
  AddScalars<float>(volume, "value", value);
  const auto bend = [](const glm::dvec3& p)
  { return glm::dvec3(0.006 * p.y * p.y, 0.004 * p.z * p.z, -0.005 * p.x * p.y); };
  double worst[2];
  for (const bool midsides : { true, false })
  {
    const Grid grid = MakeBlocks(midsides ? VTK_QUADRATIC_TETRA : VTK_TETRA, 1, false, 1);
    MovePoints(grid, [](const glm::dvec3& p) { return 20.0 * p; });
    SetDisplacements(grid, [&](const glm::dvec3& p) { return p + bend(p); });
    Deformed deformed(volume, grid);
    vtkImageData* output = deformed.Update();
    EXPECT_GT(deformed.Filter->GetNumberOfCoveredVoxels(), 8000);
    double& most = worst[midsides ? 0 : 1];
    most = 0.0;
    for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
    {
      const glm::dvec3 point = GetPoint(output, id);
      glm::dvec3 rest = point;
      for (int i = 0; i < 100; ++i)
      {
        rest = point - bend(rest);
      }
      if (deformed.IsCovered(id))
      {
        most = std::max(most, std::abs(deformed.GetValues()->GetComponent(id, 0) - value(rest)));
      }
    }
  }
  std::cout << "Largest error of a bent volume: " << worst[0] << ", without mid-side nodes "
            << worst[1] << '\n';
  // Linear interpolation of displacements with second derivatives up to 0.012 over tetrahedra with
  // edges up to 10 sqrt 2 voxels is off by no more than 3 / 16 * 0.012 * 200 voxels, and values
  // change by up to 6.2 a voxel.
  EXPECT_LT(worst[0], 3.0 / 16.0 * 0.012 * 200.0 * 6.2);
  EXPECT_LT(worst[0], 0.5 * worst[1]);
}

// Polyhedra, which are defined by their faces. A seed decides the order of the points.
class PolyhedralMesh
{
public:
  PolyhedralMesh(const std::vector<glm::dvec3>& points, unsigned int seed)
    : Places(points.size())
  {
    std::iota(this->Places.begin(), this->Places.end(), 0);
    std::mt19937 random(seed);
    std::shuffle(this->Places.begin(), this->Places.end(), random);
    vtkNew<vtkPoints> all;
    all->SetDataTypeToDouble();
    all->SetNumberOfPoints(static_cast<vtkIdType>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      all->SetPoint(this->Places[i], &points[i].x);
    }
    this->Mesh->SetPoints(all);
  }

  // The points of a face may be in clockwise or counterclockwise order.
  void Add(const std::vector<std::vector<int>>& faces)
  {
    vtkNew<vtkIdList> stream;
    stream->InsertNextId(static_cast<vtkIdType>(faces.size()));
    for (const std::vector<int>& face : faces)
    {
      stream->InsertNextId(static_cast<vtkIdType>(face.size()));
      for (const int point : face)
      {
        stream->InsertNextId(this->Places[static_cast<std::size_t>(point)]);
      }
    }
    this->Mesh->InsertNextCell(VTK_POLYHEDRON, stream);
  }

  Grid Mesh = Grid::New();

private:
  std::vector<vtkIdType> Places;
};

using Polygon = std::vector<std::array<double, 2>>;

// Prisms over a polygon, one above another. separated: each prism has points of its own.
Grid MakePrisms(const Polygon& polygon, int layers, unsigned int seed, bool separated = false)
{
  const auto count = static_cast<int>(polygon.size());
  std::vector<glm::dvec3> points;
  for (int ring = 0; ring < (separated ? 2 * layers : layers + 1); ++ring)
  {
    for (const auto& corner : polygon)
    {
      points.emplace_back(corner[0], corner[1], separated ? (ring + 1) / 2 : ring);
    }
  }
  PolyhedralMesh mesh(points, seed);
  for (int layer = 0; layer < layers; ++layer)
  {
    const int first = (separated ? 2 * layer : layer) * count;
    std::vector<std::vector<int>> faces(2);
    for (int i = 0; i < count; ++i)
    {
      faces[0].push_back(first + i);
      faces[1].push_back(first + count + i);
      const int next = (i + 1) % count;
      faces.push_back({ first + i, first + next, first + count + next, first + count + i });
    }
    mesh.Add(faces);
  }
  return mesh.Mesh;
}

double GetArea(const Polygon& polygon)
{
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return area;
}

double GetLength(const Polygon& polygon)
{
  double length = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    length += std::hypot(a[0] - b[0], a[1] - b[1]);
  }
  return length;
}

Polygon MakeStar()
{
  Polygon star;
  for (int i = 0; i < 10; ++i)
  {
    const double angle = 0.6283185307179586 * i;
    const double radius = i % 2 == 0 ? 2.0 : 0.8;
    star.push_back({ { radius * std::cos(angle), radius * std::sin(angle) } });
  }
  return star;
}

TEST(HigherOrderCells, ConcavePolyhedra)
{
  const Polygon angle{ { { 0, 0 }, { 3, 0 }, { 3, 1 }, { 1, 1 }, { 1, 2 }, { 0, 2 } } };
  const Polygon arrow{ { { 0, 0 }, { 2, 1 }, { 0, 2 }, { 0.6, 1 } } };
  for (const Polygon& polygon : { angle, arrow, MakeStar() })
  {
    const double area = GetArea(polygon);
    const double length = GetLength(polygon);
    for (unsigned int seed = 0; seed < 60; ++seed)
    {
      CheckFilled("a concave prism", MakePrisms(polygon, 1, seed), area, 2.0 * area + length);
      CheckFilled(
        "concave prisms", MakePrisms(polygon, 3, seed), 3.0 * area, 2.0 * area + 3.0 * length);
      CheckFilled("separated concave prisms", MakePrisms(polygon, 3, seed, true), 3.0 * area,
        2.0 * area + 3.0 * length);
    }
  }
  // Spikes on the faces of a cube.
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 8; ++i)
  {
    points.emplace_back(i % 2, i / 2 % 2, i / 4);
  }
  const std::vector<std::vector<int>> sides{ { 0, 1, 3, 2 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
    { 2, 3, 7, 6 }, { 0, 2, 6, 4 }, { 1, 3, 7, 5 } };
  std::vector<std::vector<int>> faces;
  for (const std::vector<int>& side : sides)
  {
    glm::dvec3 middle(0.0);
    for (const int corner : side)
    {
      middle += 0.25 * points[static_cast<std::size_t>(corner)];
    }
    for (int i = 0; i < 4; ++i)
    {
      faces.push_back({ side[i], side[(i + 1) % 4], static_cast<int>(points.size()) });
    }
    points.push_back(middle + 3.0 * (middle - glm::dvec3(0.5)));
  }
  for (unsigned int seed = 0; seed < 60; ++seed)
  {
    PolyhedralMesh spikes(points, seed);
    spikes.Add(faces);
    CheckFilled(
      "a cube with spikes", spikes.Mesh, 1.0 + 6.0 * 1.5 / 3.0, 24.0 * 0.5 * std::hypot(1.5, 0.5));
  }
  // This polyhedron cannot be split around one point: none is visible from all faces.
  const Polygon cup{ { { 0, 0 }, { 3, 0 }, { 3, 3 }, { 2, 3 }, { 2, 1 }, { 1, 1 }, { 1, 3 },
    { 0, 3 } } };
  for (unsigned int seed = 0; seed < 5; ++seed)
  {
    ExpectError(MakePrisms(cup, 1, seed),
      "Cell 0 of the deformation mesh is a concave polyhedron with 16 points");
  }
  // Faces that do not close: a side is missing, or another side is there twice instead.
  const std::vector<std::vector<int>> angular = { { 0, 1, 2, 3, 4, 5 }, { 6, 7, 8, 9, 10, 11 },
    { 0, 1, 7, 6 }, { 1, 2, 8, 7 }, { 2, 3, 9, 8 }, { 3, 4, 10, 9 }, { 4, 5, 11, 10 },
    { 5, 0, 6, 11 } };
  const auto makeOpen = [](std::vector<std::vector<int>> sides, std::size_t missing, bool isTwice)
  {
    sides[missing] = sides[(missing + 1) % sides.size()];
    if (!isTwice)
    {
      sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(missing));
    }
    return sides;
  };
  std::vector<glm::dvec3> ofAngle;
  for (const double z : { 0.0, 1.0 })
  {
    for (const auto& corner : angle)
    {
      ofAngle.emplace_back(corner[0], corner[1], z);
    }
  }
  const std::vector<glm::dvec3> ofCube(points.begin(), points.begin() + 8);
  for (const bool isTwice : { false, true })
  {
    for (unsigned int missing = 0; missing < 6; ++missing)
    {
      PolyhedralMesh cube(ofCube, missing);
      cube.Add(makeOpen(sides, missing, isTwice));
      ExpectError(cube.Mesh, "and faces that do not close");
      PolyhedralMesh open(ofAngle, missing);
      open.Add(makeOpen(angular, missing, isTwice));
      ExpectError(open.Mesh, "and faces that do not close");
    }
  }
  // A cube without a height is closed.
  std::vector<glm::dvec3> flat = ofCube;
  for (glm::dvec3& point : flat)
  {
    point.z = 0.0;
  }
  PolyhedralMesh cube(flat, 0);
  cube.Add(sides);
  EXPECT_FALSE(deformvolume::ReadCells({ cube.Mesh }, { cube.Mesh }).Tetrahedra.empty());
  // Repeated nodes and faces do not change a cell.
  std::vector<std::vector<int>> repeated = angular;
  repeated.push_back(angular[4]);
  for (std::vector<int>& face : repeated)
  {
    face.push_back(face.front());
    face.insert(face.begin() + 2, face[1]);
  }
  for (unsigned int seed = 0; seed < 10; ++seed)
  {
    PolyhedralMesh mesh(ofAngle, seed);
    mesh.Add(repeated);
    CheckFilled(
      "repeated nodes", mesh.Mesh, GetArea(angle), 2.0 * GetArea(angle) + GetLength(angle));
  }
  // Convex cells are split without derived nodes: all their tetrahedra have the node of lowest id.
  Polygon round;
  for (int i = 0; i < 7; ++i)
  {
    round.push_back({ { std::cos(0.8975979 * i), std::sin(0.8975979 * i) } });
  }
  round.push_back({ { 0.5 * (round[6][0] + round[0][0]), 0.5 * (round[6][1] + round[0][1]) } });
  for (unsigned int seed = 0; seed < 20; ++seed)
  {
    const Grid mesh = MakePrisms(round, 1, seed);
    const deformvolume::MeshCells cells = deformvolume::ReadCells({ mesh }, { mesh });
    EXPECT_EQ(cells.Derived.GetCount(), 0U);
    EXPECT_TRUE(std::all_of(cells.Tetrahedra.begin(), cells.Tetrahedra.end(),
      [](const Tetrahedron& nodes) { return nodes[0] == 0; }));
  }
}

// A concave cell inside a volume covers all of its voxels, with any order of points.
TEST(HigherOrderCells, ConcaveVolume)
{
  const auto volume = MakeVolume({ { 0, 12, 0, 12, 0, 12 } });
  Polygon angle{ { { 0, 0 }, { 12, 0 }, { 12, 4 }, { 4, 4 }, { 4, 8 }, { 0, 8 } } };
  for (auto& corner : angle)
  {
    corner[0] += 0.5;
    corner[1] += 0.5;
  }
  for (unsigned int seed = 0; seed < 8; ++seed)
  {
    const Grid mesh = MakePrisms(angle, 1, seed);
    MovePoints(mesh, [](const glm::dvec3& p) { return glm::dvec3(p.x, p.y, 0.5 + 8.0 * p.z); });
    // An affine displacement of the nodes is an affine displacement of the whole cell.
    SetDisplacements(mesh, [](const glm::dvec3& p) { return p + glm::dvec3(1.0, 2.0, p.x / 3.0); });
    Deformed deformed(volume, mesh);
    deformed.Filter->SetResamplerToMeshRasterization();
    deformed.Update();
    EXPECT_EQ(deformed.Filter->GetNumberOfCoveredVoxels(), (12 * 4 + 4 * 4) * 8);
    // When its nodes at rest are moved so that it is convex, the cell is split without a derived
    // node.
    MovePoints(mesh,
      [](const glm::dvec3& p)
      {
        const glm::dvec3 point = p + glm::dvec3(p.x == 4.5 && p.y == 4.5 ? 4.0 : 0.0);
        return glm::dvec3(point.x, point.y, std::min(point.z, 8.5));
      });
    Deformed fresh(volume, mesh);
    fresh.Filter->SetResamplerToMeshRasterization();
    EXPECT_TRUE(AreEqual(deformed.Update(), fresh.Update()));
  }
}

// The engine's tables of cell types are equal to VTK's.
TEST(HigherOrderCells, Tables)
{
  const std::set<int> linear{ VTK_HEXAHEDRON, VTK_WEDGE, VTK_PYRAMID, VTK_PENTAGONAL_PRISM,
    VTK_HEXAGONAL_PRISM };
  int found = 0;
  for (int type = 0; type < 256; ++type)
  {
    const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
    const deformvolume::CellFaces* faces = deformvolume::GetCellFaces(type);
    EXPECT_EQ(faces != nullptr, linear.count(type) > 0);
    if (faces)
    {
      auto* solid = vtkCell3D::SafeDownCast(cell);
      EXPECT_EQ(static_cast<int>(faces->size()), solid->GetNumberOfFaces());
      for (std::size_t face = 0; face < faces->size(); ++face)
      {
        const vtkIdType* points = nullptr;
        const vtkIdType count = solid->GetFacePoints(static_cast<vtkIdType>(face), points);
        EXPECT_EQ(std::vector<int>(points, points + count), (*faces)[face]);
      }
    }
    const int size = deformvolume::GetNumberOfCellPoints(type);
    EXPECT_TRUE(size == 0 || (cell && size == cell->GetNumberOfPoints()));
    found += size > 0 ? 1 : 0;
    std::vector<std::array<int, 3>> edges;
    for (vtkIdType i = 0; size > 0 && i < cell->GetNumberOfPoints(); ++i)
    {
      cell->PointIds->SetId(i, i);
    }
    for (int edge = 0; size > 0 && edge < cell->GetNumberOfEdges(); ++edge)
    {
      vtkIdList* ids = cell->GetEdge(edge)->GetPointIds();
      if (ids->GetNumberOfIds() == 3)
      {
        edges.push_back({ { static_cast<int>(ids->GetId(0)), static_cast<int>(ids->GetId(1)),
          static_cast<int>(ids->GetId(2)) } });
      }
    }
    EXPECT_EQ(edges, deformvolume::HigherOrderCells::GetMidSides(type));
    EXPECT_TRUE(!cell || deformvolume::GetCellName(type) != "cell of unknown type");
  }
  EXPECT_EQ(found, 16);
}

// The order of the nodes of Lagrange cells is equal to VTK's.
TEST(HigherOrderCells, Lattices)
{
  int wrong = 0;
  int nodes = 0;
  const auto check = [&](const deformvolume::NodeAt& at, int i, int j, int k, vtkIdType expected)
  {
    wrong += at(i, j, k) == expected ? 0 : 1;
    ++nodes;
  };
  for (int x = 1; x <= 5; ++x)
  {
    for (int y = 1; y <= 4; ++y)
    {
      for (int z = 1; z <= 4; ++z)
      {
        const deformvolume::NodeAt at = deformvolume::NumberHexahedron({ { x, y, z } });
        const int order[4] = { x, y, z, (x + 1) * (y + 1) * (z + 1) };
        for (int node = 0; node < order[3]; ++node)
        {
          const int i = node % (x + 1);
          const int j = node / (x + 1) % (y + 1);
          const int k = node / (x + 1) / (y + 1);
          check(at, i, j, k, vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order));
        }
      }
    }
  }
  for (int degree = 1; degree <= 8; ++degree)
  {
    const deformvolume::NodeAt inTetrahedron = deformvolume::NumberTetrahedron(degree);
    for (int k = 0; k <= degree; ++k)
    {
      for (int j = 0; j + k <= degree; ++j)
      {
        for (int i = 0; i + j + k <= degree; ++i)
        {
          const vtkIdType indices[4] = { i, j, k, degree - i - j - k };
          check(inTetrahedron, i, j, k, vtkHigherOrderTetra::Index(indices, degree));
        }
      }
    }
    for (int layers = 1; layers <= 4; ++layers)
    {
      const deformvolume::NodeAt inWedge = deformvolume::NumberWedge(degree, layers);
      const int order[4] = { degree, degree, layers,
        (degree + 1) * (degree + 2) / 2 * (layers + 1) };
      // VTK treats wedges of 21 nodes as quadratic ones with additional nodes.
      for (int k = 0; k <= layers && order[3] != 21; ++k)
      {
        for (int j = 0; j <= degree; ++j)
        {
          for (int i = 0; i + j <= degree; ++i)
          {
            check(inWedge, i, j, k, vtkHigherOrderWedge::PointIndexFromIJK(i, j, k, order));
          }
        }
      }
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(nodes, 5000);
}

} // namespace
