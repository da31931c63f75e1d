// SPDX-License-Identifier: BSD-3-Clause
// How vtkTetGenMesher meshes the body in a volume.
#include "vtkTetGenMesher.h"

#include "BodyCoverage.h"
#include "BodyIsovalue.h"
#include "BodySurface.h"
#include "ClosedSurface.h"
#include "MeshRefinement.h"
#include "TetGenProcess.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace
{

// Warn if at least this part of the body's voxels is outside the mesh.
constexpr double WarningShare = 0.001;
// Largest number of nodes of a grid that is finer than the edge length requires.
constexpr double FineNodes = 3e5;
// Largest number of rounds in which a surface grows around voxels outside of it.
constexpr int MaximumNumberOfRounds = 20;
double DiagonalOf(vtkImageData* volume)
{
  int dimensions[3];
  volume->GetDimensions(dimensions);
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = (dimensions[axis] - 1) * volume->GetSpacing()[axis];
    square += length * length;
  }
  return std::sqrt(square);
}

deformvolume::Error NoBody(vtkDataArray* array, const deformvolume::BodyCriterion& criterion)
{
  std::ostringstream text;
  double range[2];
  array->GetFiniteRange(range, 0);
  if (range[0] > range[1])
  {
    text << "No body: all values of the volume are infinite or NaN.";
  }
  else if (criterion.ByLabels)
  {
    text << "No body: the volume has no voxel with "
         << (criterion.Labels.empty() ? "a label other than 0" : "one of the labels to mesh")
         << " that is not hidden.";
  }
  else
  {
    text << "No body: the volume has no value of at least " << criterion.Isovalue
         << ", the isovalue, that is not hidden. Its values range from " << range[0] << " to "
         << range[1] << ". Use another isovalue.";
  }
  return deformvolume::Error(text.str());
}

glm::dvec3 FirstVoxel(vtkImageData* volume)
{
  int extent[6];
  volume->GetExtent(extent);
  return glm::dvec3(extent[0], extent[2], extent[4]);
}

glm::dvec3 ToOffset(const glm::dvec3& world, vtkImageData* volume, const glm::dvec3& spacing)
{
  glm::dvec3 index;
  volume->TransformPhysicalPointToContinuousIndex(&world.x, &index.x);
  return (index - FirstVoxel(volume)) * spacing;
}

// Converts points from offsets along the axes of the volume, relative to the first voxel of its
// extent. With offsets, faces at the border of the volume are exactly plane.
void MoveToWorld(vtkUnstructuredGrid* mesh, vtkImageData* volume, const glm::dvec3& spacing)
{
  const glm::dvec3 first = FirstVoxel(volume);
  vtkPoints* points = mesh->GetPoints();
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    glm::dvec3 point;
    points->GetPoint(i, &point.x);
    point = point / spacing + first;
    volume->TransformContinuousIndexToPhysicalPoint(&point.x, &point.x);
    points->SetPoint(i, &point.x);
  }
  points->Modified();
}

std::string WithCommas(vtkIdType number)
{
  std::string text = std::to_string(number);
  for (auto at = static_cast<int>(text.size()) - 3; at > 0; at -= 3)
  {
    text.insert(static_cast<std::size_t>(at), ",");
  }
  return text;
}

} // namespace

void vtkTetGenMesher::MeshVolume(
  vtkImageData* volume, vtkDataArray* array, const Spheres& spheres, vtkUnstructuredGrid* output)
{
  const double length =
    this->TargetEdgeLength > 0.0 ? this->TargetEdgeLength : DiagonalOf(volume) / 20.0;
  this->UsedTargetEdgeLength = length;
  deformvolume::BodyCriterion criterion;
  criterion.ByLabels = this->BodyMode == LABELS;
  criterion.Labels = this->Labels;
  if (!criterion.ByLabels)
  {
    criterion.Isovalue = this->AutomaticIsovalue
      ? deformvolume::FindIsovalue(volume, array, length / 1.5)
      : this->Isovalue;
  }
  this->UsedIsovalue = criterion.ByLabels ? 0.5 : criterion.Isovalue;
  this->CheckStep(0.1);
  deformvolume::BodyVoxels body = deformvolume::FindBodyVoxels(volume, array, criterion);
  if (body.Runs.empty())
  {
    throw NoBody(array, criterion);
  }
  deformvolume::FindPieces(body, this->SpeckSize, this->PieceMode == LARGEST_PIECE);
  this->CheckStep(0.2);

  const glm::dvec3& spacing = body.Spacing;
  const double margin = length * this->Margin;
  const double coarse = length / 1.5;
  // On the fine grid, half an edge length is more than the diagonal of a cell, so that even very
  // thin parts of the body are enclosed evenly. The grid is coarser if it would have too many
  // nodes.
  const glm::dvec3 size =
    spacing * glm::dvec3(body.Size[0], body.Size[1], body.Size[2]) + 2.0 * margin;
  const double fine =
    std::max(0.28 * length, std::min(coarse, std::cbrt(size.x * size.y * size.z / FineNodes)));
  // Decimation, smoothing and growth can make a surface intersect itself. Then the next attempt is
  // tried. The last one is a plain isosurface, which never intersects itself, and encloses the body
  // by construction.
  std::vector<deformvolume::SurfaceParameters> attempts;
  for (double decimated = length; this->Decimation && decimated > 0.75 * length;
       decimated -= 0.1 * length)
  {
    attempts.push_back({ fine, margin, this->SmoothingIterations, decimated, false });
  }
  attempts.push_back({ coarse, margin, this->SmoothingIterations, 0.0, false });
  attempts.push_back({ coarse, margin, 0, 0.0, true });
  Spheres moved = spheres;
  for (deformvolume::RefinementSphere& sphere : moved)
  {
    sphere.Center = ToOffset(sphere.Center, volume, body.Spacing);
  }
  using deformvolume::PieceKind;
  deformvolume::UncoveredVoxels uncovered;
  for (std::size_t i = 0; i < attempts.size(); ++i)
  {
    const bool isLast = i + 1 == attempts.size();
    try
    {
      uncovered = this->MeshBody(body, attempts[i], moved, isLast, output);
      break;
    }
    catch (const deformvolume::SurfaceRejected&)
    {
      if (isLast)
      {
        throw;
      }
    }
  }
  MoveToWorld(output, volume, spacing);
  this->NumberOfSpeckVoxels = body.CountVoxels(PieceKind::Speck);
  this->NumberOfBodyVoxels =
    body.CountVoxels(PieceKind::Meshed) + body.CountVoxels(PieceKind::LeftOut);
  this->NumberOfBodyVoxelsOutside = uncovered.OfBody;
  this->NumberOfPieces = body.CountPieces(PieceKind::Meshed) + body.CountPieces(PieceKind::LeftOut);
  this->WarnOfVoxelsOutside();
}

deformvolume::UncoveredVoxels vtkTetGenMesher::MeshBody(const deformvolume::BodyVoxels& body,
  const deformvolume::SurfaceParameters& parameters, const Spheres& spheres, bool isLast,
  vtkUnstructuredGrid* output)
{
  const double length = this->UsedTargetEdgeLength;
  const double voxel = std::min({ body.Spacing.x, body.Spacing.y, body.Spacing.z });
  const auto surface = deformvolume::MakeBodySurface(body, parameters);
  this->CheckStep(0.5);
  try
  {
    deformvolume::CheckClosedSurface(surface);
  }
  catch (const deformvolume::Error& error)
  {
    throw deformvolume::SurfaceRejected(error.what()); // the next attempt may succeed
  }
  CheckSize(surface, length, spheres);
  for (int round = 0; !isLast; ++round)
  {
    // Voxels just inside the surface can be outside the mesh after positions are rounded.
    const auto shrunk = deformvolume::Shrink(surface, 0.02 * voxel);
    const auto mesh = this->Fill(shrunk, 0.0, {}, false);
    const std::vector<glm::dvec3> outside = deformvolume::FindUncovered(mesh, body).OfMeshed;
    if (outside.empty())
    {
      break;
    }
    if (round == MaximumNumberOfRounds)
    {
      throw deformvolume::SurfaceRejected("The surface does not enclose the body.");
    }
    deformvolume::GrowAround(surface, outside, 0.05 * voxel, 0.75 * length);
  }
  output->ShallowCopy(this->Fill(surface, length, spheres, isLast));
  deformvolume::UncoveredVoxels uncovered = deformvolume::FindUncovered(output, body);
  // Smoothing can collapse the surface of a few voxels to nearly a point, which Shrink() turns
  // inside out, so that the check above finds the voxels in a surface that is larger than this one.
  if (!isLast && !uncovered.OfMeshed.empty())
  {
    throw deformvolume::SurfaceRejected("The surface of a part of the body has collapsed.");
  }
  return uncovered;
}

void vtkTetGenMesher::WarnOfVoxelsOutside()
{
  const double share = static_cast<double>(this->NumberOfBodyVoxelsOutside) /
    static_cast<double>(this->NumberOfBodyVoxels);
  if (!(share >= WarningShare))
  {
    return;
  }
  std::ostringstream text;
  text.precision(share < 0.995 ? 2 : 3);
  text << WithCommas(this->NumberOfBodyVoxelsOutside) << " of the "
       << WithCommas(this->NumberOfBodyVoxels) << " voxels of the body (" << 100.0 * share
       << " %) lie outside the mesh.";
  if (this->PieceMode == LARGEST_PIECE && this->NumberOfPieces > 1)
  {
    text << " The body has " << WithCommas(this->NumberOfPieces)
         << " pieces, and only the largest is meshed. All pieces can be meshed instead.";
  }
  else
  {
    text << " Use a smaller edge length or a greater margin.";
  }
  vtkWarningMacro(<< text.str());
}

std::string vtkTetGenMesher::GetSummary()
{
  if (this->NumberOfBodyVoxels == 0)
  {
    return "";
  }
  std::ostringstream text;
  text << "Body voxels: " << WithCommas(this->NumberOfBodyVoxels) << "\n"
       << "Body voxels outside the mesh: " << WithCommas(this->NumberOfBodyVoxelsOutside) << "\n"
       << "Pieces: " << WithCommas(this->NumberOfPieces) << "\n"
       << "Voxels of specks: " << WithCommas(this->NumberOfSpeckVoxels);
  return text.str();
}
