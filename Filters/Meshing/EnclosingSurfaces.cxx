// SPDX-License-Identifier: BSD-3-Clause
#include "EnclosingSurfaces.h"

#include "BodyLevelSet.h"
#include "BodySurface.h"
#include "ClosedSurface.h"
#include "SurfaceGrowth.h"

#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace deformvolume
{
namespace
{

// Nodes of a grid that is finer than the edges ask for.
constexpr double FineNodes = 3e5;

// Rounds positions, so that what is meant to be plane, as where the volume's border cuts the body,
// is so exactly: otherwise TetGen puts tetrahedra of almost no volume there.
void RoundPositions(vtkPolyData* surface, double length)
{
  const double unit = std::exp2(std::round(std::log2(length)) - 24.0);
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    double point[3];
    surface->GetPoint(i, point);
    for (double& coordinate : point)
    {
      coordinate = std::round(coordinate / unit) * unit;
    }
    surface->GetPoints()->SetPoint(i, point);
  }
  surface->GetPoints()->Modified();
}

} // namespace

EnclosingSurfaces::EnclosingSurfaces(const BodyVoxels& body, const glm::dvec3& spacing,
  const SurfaceParameters& parameters, std::function<void()> check)
  : Body(body)
  , Target(GetMeshedVoxels(body, parameters.Margin > 0.0))
  , Allowed(body.CountVoxels(PieceKind::Meshed) / 200000)
  , Spacing(spacing)
  , Parameters(parameters)
  , Check(std::move(check))
{
  const double length = parameters.EdgeLength;
  if (parameters.Decimation)
  {
    this->Attempts.push_back(
      { this->FineResolution(), parameters.SmoothingIterations, true, false });
  }
  for (int iterations = parameters.SmoothingIterations; iterations > 0; iterations /= 4)
  {
    this->Attempts.push_back({ length / 1.5, iterations, false, false });
  }
  this->Attempts.push_back({ length / 1.5, 0, false, true });
  this->Attempts.push_back({ length, 0, false, true });
}

// A grid on which the distance of half an edge is more than the diagonal of a cell, so that parts
// of the body however thin are surrounded evenly, unless that takes too many nodes.
double EnclosingSurfaces::FineResolution() const
{
  double volume = 1.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    volume *= this->Body.Size[axis] * this->Spacing[axis] + 2.0 * this->Parameters.Margin;
  }
  const double length = this->Parameters.EdgeLength;
  return std::max(0.28 * length, std::min(length / 1.5, std::cbrt(volume / FineNodes)));
}

vtkSmartPointer<vtkPolyData> EnclosingSurfaces::Next()
{
  while (this->NextAttempt < this->Attempts.size())
  {
    if (auto surface = this->Try(this->Attempts[this->NextAttempt++]))
    {
      return surface;
    }
  }
  return nullptr;
}

vtkSmartPointer<vtkPolyData> EnclosingSurfaces::Try(const Attempt& attempt)
{
  const double length = this->Parameters.EdgeLength;
  const BodyVoxels meshed = GetMeshedVoxels(this->Body, false);
  BodyLevelSet grid =
    MakeGrid(this->Body, this->Spacing, attempt.Resolution, this->Parameters.Margin);
  SetDistances(
    grid, meshed, { this->Parameters.Margin, this->Parameters.Hull, attempt.WholeCells });
  this->Check();
  auto surface = Smooth(ExtractSurface(grid), attempt.SmoothingIterations);
  CheckClosedSurface(surface);
  this->Check();
  if (attempt.Decimation)
  {
    if (const auto decimated = Decimate(surface, length))
    {
      if (!IsClosedManifold(decimated))
      {
        return nullptr;
      }
      surface = decimated;
    }
  }
  const bool exact = attempt.WholeCells;
  if (!exact &&
    !GrowAroundBody(
      surface, meshed, this->Target, this->Spacing, 0.75 * length, this->Allowed, this->Check))
  {
    return nullptr;
  }
  RoundPositions(surface, length);
  return surface;
}

} // namespace deformvolume
