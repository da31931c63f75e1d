// SPDX-License-Identifier: BSD-3-Clause
#include "BodySurface.h"

#include "ClosedSurface.h"
#include "SincWindow.h"
#include "TetGenProcess.h"

#include "vtkCellData.h"
#include "vtkFloatArray.h"
#include "vtkFlyingEdges3D.h"
#include "vtkGenericCell.h"
#include "vtkImageData.h"
#include "vtkImageEuclideanDistance.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataNormals.h"
#include "vtkStaticCellLocator.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWindowedSincPolyDataFilter.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace deformvolume
{
namespace
{

constexpr double MaximumNumberOfNodes = 5e8;
// Least distance of a vertex of the surface from a node of the grid, as a part of the grid spacing.
// Without it, several vertices could nearly coincide, and TetGen would have to keep the tiny
// triangles between them.
constexpr float LeastValue = 0.1f;
// The largest number of voxels that GrowAround() uses.
constexpr std::size_t SomeVoxels = 30000;

/// A grid with the same spacing on all axes.
struct Grid
{
  double Distance; // from node to node
  int Size[3];
  int Border[3]; // nodes before the first voxel
  vtkNew<vtkImageData> Image;

  vtkIdType Count() const { return this->Image->GetNumberOfPoints(); }
};

void MakeGrid(Grid& grid, const BodyVoxels& body, const SurfaceParameters& parameters)
{
  const glm::dvec3 lengths = body.Spacing * glm::dvec3(body.Size[0], body.Size[1], body.Size[2]);
  const double voxel = std::cbrt(body.Spacing.x * body.Spacing.y * body.Spacing.z);
  grid.Distance = std::max(voxel, std::min(parameters.Resolution, 0.25 * glm::length(lengths)));
  // A voxel extends half a spacing beyond its center.
  const double widest = std::max({ body.Spacing.x, body.Spacing.y, body.Spacing.z });
  const double border = std::ceil((parameters.Margin + 0.5 * widest) / grid.Distance) + 3.0;
  double count = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double size = std::ceil(lengths[axis] / grid.Distance) + 1.0 + 2.0 * border;
    count *= size;
    if (!(count <= MaximumNumberOfNodes))
    {
      std::ostringstream text;
      text << "The body's surface cannot be moved out by a margin of " << parameters.Margin
           << " world units: that takes a grid of more than 500 million nodes, " << grid.Distance
           << " apart. Use another margin or edge length.";
      throw Error(text.str());
    }
    grid.Border[axis] = static_cast<int>(border);
    grid.Size[axis] = static_cast<int>(size);
  }
  const double origin = -border * grid.Distance;
  grid.Image->SetDimensions(grid.Size);
  grid.Image->SetSpacing(grid.Distance, grid.Distance, grid.Distance);
  grid.Image->SetOrigin(origin, origin, origin);
}

/// Marks the nodes of the body with 0, and all others with 1. Nodes of the body are those in its
/// voxels, and the nearest node of each voxel without nodes. With wholeCells, they are all nodes of
/// the cells that contain centers of voxels.
vtkSmartPointer<vtkUnsignedCharArray> MarkNodes(
  const Grid& grid, const BodyVoxels& body, bool wholeCells)
{
  auto marks = vtkSmartPointer<vtkUnsignedCharArray>::New();
  marks->SetNumberOfValues(grid.Count());
  marks->Fill(1);
  // The first and the last node for the voxels from begin to end - 1 on an axis.
  const auto nodes = [&](int begin, int end, int axis) -> std::array<int, 2>
  {
    const double unit = body.Spacing[axis] / grid.Distance;
    double first = std::ceil((begin - 0.5) * unit);
    double last = std::floor((end - 0.5) * unit);
    if (first > last)
    {
      first = last = std::round(0.5 * (begin + end - 1) * unit);
    }
    if (wholeCells)
    {
      first = std::floor(begin * unit);
      last = std::floor((end - 1) * unit) + 1.0;
    }
    return { { grid.Border[axis] + static_cast<int>(first),
      grid.Border[axis] + static_cast<int>(last) } };
  };
  for (vtkIdType row = 0; row < body.NumberOfRows(); ++row)
  {
    const int y = static_cast<int>(row % body.Size[1]);
    const int z = static_cast<int>(row / body.Size[1]);
    const auto rows = nodes(y, y + 1, 1);
    const auto slices = nodes(z, z + 1, 2);
    for (vtkIdType i = body.RowStarts[row]; i < body.RowStarts[row + 1]; ++i)
    {
      const VoxelRun& run = body.Runs[i];
      if (body.Pieces[run.Piece] != PieceKind::Meshed)
      {
        continue;
      }
      const auto columns = nodes(run.Begin, run.End, 0);
      for (int k = slices[0]; k <= slices[1]; ++k)
      {
        for (int j = rows[0]; j <= rows[1]; ++j)
        {
          unsigned char* line = marks->GetPointer((vtkIdType(k) * grid.Size[1] + j) * grid.Size[0]);
          std::fill(line + columns[0], line + columns[1] + 1, 0);
        }
      }
    }
  }
  return marks;
}

/// Squared distances from the nodes to the nearest node with the mark 0, in units of the grid
/// spacing.
// The image has the spacing 1, because vtkImageEuclideanDistance is wrong with other spacings.
vtkSmartPointer<vtkDataArray> SquaredDistances(const Grid& grid, vtkUnsignedCharArray* marks)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(grid.Size);
  image->GetPointData()->SetScalars(marks);
  vtkNew<vtkImageEuclideanDistance> distance;
  distance->SetInputData(image);
  distance->Update();
  return distance->GetOutput()->GetPointData()->GetScalars();
}

/// Approximate distances from the surface of the body, which is enlarged by the margin. Positive
/// inside.
std::vector<float> MakeLevelSet(
  const Grid& grid, const BodyVoxels& body, const SurfaceParameters& parameters)
{
  // On average, the body ends a quarter of the grid spacing outside the marked nodes; with whole
  // cells, a quarter of the grid spacing inside them.
  const double margin = parameters.Margin / grid.Distance;
  const double offset = parameters.WholeCells ? std::max(0.5, margin - 0.25) : margin + 0.25;
  const auto marks = MarkNodes(grid, body, parameters.WholeCells);
  const auto outer = SquaredDistances(grid, marks);
  for (vtkIdType i = 0; i < grid.Count(); ++i)
  {
    marks->SetValue(i, 1 - marks->GetValue(i));
  }
  const auto inner = SquaredDistances(grid, marks);
  std::vector<float> values(grid.Count());
  for (vtkIdType i = 0; i < grid.Count(); ++i)
  {
    const double out = std::sqrt(outer->GetComponent(i, 0));
    const double in = std::sqrt(inner->GetComponent(i, 0));
    const float value = static_cast<float>(offset + (out > 0.0 ? -out : in - 1.0));
    values[i] = std::copysign(std::max(std::abs(value), LeastValue), value);
  }
  return values;
}

// If two diagonally opposite corners of a face are inside and the two others are outside, an
// isosurface can have edges with four triangles. Moves one of the outside corners inside.
void SeparateSheets(const Grid& grid, std::vector<float>& values)
{
  const vtkIdType strides[3] = { 1, grid.Size[0], vtkIdType(grid.Size[0]) * grid.Size[1] };
  bool changed = true;
  while (changed)
  {
    changed = false;
    for (int axis = 0; axis < 3; ++axis)
    {
      const vtkIdType u = strides[axis];
      const vtkIdType v = strides[(axis + 1) % 3];
      // Nodes at the border are outside, so that an index beyond a row's end does no harm.
      for (vtkIdType i = 0; i + u + v < grid.Count(); ++i)
      {
        const bool first = values[i] > 0.0f;
        if (first != (values[i + u + v] > 0.0f) || first == (values[i + u] > 0.0f) ||
          first == (values[i + v] > 0.0f))
        {
          continue;
        }
        const vtkIdType a = first ? i + u : i;
        const vtkIdType b = first ? i + v : i + u + v;
        values[values[a] >= values[b] ? a : b] = LeastValue;
        changed = true;
      }
    }
  }
}

// Moves nodes inside that no path of outside nodes connects with the border of the grid.
void FillCavities(const Grid& grid, std::vector<float>& values)
{
  std::vector<unsigned char> isOuter(values.size(), 0);
  std::vector<vtkIdType> stack(1, 0);
  isOuter[0] = 1;
  const vtkIdType strides[3] = { 1, grid.Size[0], vtkIdType(grid.Size[0]) * grid.Size[1] };
  while (!stack.empty())
  {
    const vtkIdType node = stack.back();
    stack.pop_back();
    for (const vtkIdType stride : strides)
    {
      for (const vtkIdType neighbor : { node - stride, node + stride })
      {
        if (neighbor >= 0 && neighbor < grid.Count() && !isOuter[neighbor] &&
          values[neighbor] < 0.0f)
        {
          isOuter[neighbor] = 1;
          stack.push_back(neighbor);
        }
      }
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = isOuter[i] ? values[i] : std::abs(values[i]);
  }
}

// The surface with unit normals of points and cells that point outwards.
vtkSmartPointer<vtkPolyData> FindNormals(vtkPolyData* surface)
{
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(surface);
  normals->ComputeCellNormalsOn();
  normals->AutoOrientNormalsOn();
  normals->SplittingOff();
  normals->Update();
  return normals->GetOutput();
}

} // namespace

vtkSmartPointer<vtkPolyData> MakeBodySurface(
  const BodyVoxels& body, const SurfaceParameters& parameters)
{
  Grid grid;
  MakeGrid(grid, body, parameters);
  std::vector<float> values = MakeLevelSet(grid, body, parameters);
  SeparateSheets(grid, values);
  FillCavities(grid, values);
  vtkNew<vtkFloatArray> scalars;
  scalars->SetArray(values.data(), grid.Count(), 1);
  grid.Image->GetPointData()->SetScalars(scalars);
  vtkNew<vtkFlyingEdges3D> contour;
  contour->SetInputData(grid.Image);
  contour->SetValue(0, 0.0);
  contour->ComputeNormalsOff();
  contour->ComputeGradientsOff();
  contour->ComputeScalarsOff();
  contour->Update();
  auto surface = CleanTriangles(contour->GetOutput());
  if (parameters.SmoothingIterations > 0)
  {
    vtkNew<vtkWindowedSincPolyDataFilter> smoother;
    smoother->SetInputData(surface);
    smoother->SetNumberOfIterations(parameters.SmoothingIterations);
    smoother->SetPassBand(0.05);
    UseHammingWindow(smoother);
    smoother->BoundarySmoothingOff();
    smoother->FeatureEdgeSmoothingOff();
    smoother->NonManifoldSmoothingOn();
    smoother->NormalizeCoordinatesOn();
    smoother->Update();
    surface = CleanTriangles(smoother->GetOutput());
  }
  if (parameters.DecimatedLength > 0.0)
  {
    surface = Decimate(surface, parameters.DecimatedLength);
    if (!surface)
    {
      throw SurfaceRejected("Decimation has made the surface of the body non-manifold.");
    }
  }
  return surface;
}

void GrowAround(
  vtkPolyData* surface, const std::vector<glm::dvec3>& outside, double beyond, double limit)
{
  const vtkSmartPointer<vtkPolyData> normals = FindNormals(surface);
  vtkDataArray* outwards = normals->GetCellData()->GetNormals();
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(surface);
  locator->BuildLocator();
  vtkNew<vtkGenericCell> cell;
  // Each vertex makes the longest of the moves that voxels require.
  std::vector<glm::dvec3> moves(surface->GetNumberOfPoints(), glm::dvec3(0.0));
  const std::size_t stride = outside.size() / SomeVoxels + 1;
  for (std::size_t i = 0; i < outside.size(); i += stride)
  {
    const glm::dvec3& voxel = outside[i];
    glm::dvec3 closest;
    vtkIdType triangle = -1;
    int part = 0;
    double square = 0.0;
    double query[3] = { voxel.x, voxel.y, voxel.z };
    locator->FindClosestPoint(query, &closest.x, cell, triangle, part, square);
    if (!(square <= limit * limit))
    {
      throw SurfaceRejected("A part of the body lies too far outside the surface.");
    }
    double weights[3] = { 0.0, 0.0, 0.0 };
    double parametric[3];
    surface->GetCell(triangle, cell);
    cell->EvaluatePosition(&closest.x, nullptr, part, parametric, square, weights);
    const double distance = glm::distance(voxel, closest);
    glm::dvec3 direction = voxel - closest;
    if (distance > beyond)
    {
      direction /= distance;
    }
    else
    {
      outwards->GetTuple(triangle, &direction.x);
    }
    // The smallest moves of the corners that bring the closest point beyond the voxel.
    double squares = 0.0;
    for (double& weight : weights)
    {
      weight = std::max(0.0, weight);
      squares += weight * weight;
    }
    for (int k = 0; k < 3 && squares > 0.0; ++k)
    {
      const glm::dvec3 move = weights[k] / squares * (distance + beyond) * direction;
      glm::dvec3& longest = moves[cell->GetPointId(k)];
      longest = glm::length(move) > glm::length(longest) ? move : longest;
    }
  }
  for (std::size_t i = 0; i < moves.size(); ++i)
  {
    glm::dvec3 point;
    surface->GetPoint(static_cast<vtkIdType>(i), &point.x);
    point += moves[i];
    surface->GetPoints()->SetPoint(static_cast<vtkIdType>(i), &point.x);
  }
  surface->GetPoints()->Modified();
  surface->Modified();
}

vtkSmartPointer<vtkPolyData> Shrink(vtkPolyData* surface, double distance)
{
  const vtkSmartPointer<vtkPolyData> normals = FindNormals(surface);
  vtkDataArray* outwards = normals->GetPointData()->GetNormals();
  vtkNew<vtkPoints> points;
  points->DeepCopy(surface->GetPoints());
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    glm::dvec3 point;
    glm::dvec3 normal;
    points->GetPoint(i, &point.x);
    outwards->GetTuple(i, &normal.x);
    point -= distance * normal;
    points->SetPoint(i, &point.x);
  }
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->SetPoints(points);
  result->SetPolys(surface->GetPolys());
  return result;
}

} // namespace deformvolume
