// SPDX-License-Identifier: BSD-3-Clause
// Moves single points as a WorldDeformer moves its volume.
#include "WorldPoints.h"

#include "Error.h"
#include "Fading.h"
#include "FieldPointMap.h"
#include "MeshPointMap.h"
#include "ParallelFor.h"
#include "WorldDeformer.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

namespace deformvolume
{

namespace
{

constexpr std::size_t PointsPerPart = 512;
constexpr std::size_t PointsPerReport = 64 * PointsPerPart;

void CheckPoints(const VectorView& points)
{
  for (std::size_t i = 0; i < points.Count; ++i)
  {
    if (!IsFinite(points.Get(i)))
    {
      throw Error("Point " + std::to_string(i) + " is not finite. Remove NaN and infinity.");
    }
  }
}

} // namespace

PointsReport WorldDeformer::DeformPoints(const PointsRequest& request)
{
  const VectorView points{ request.Points, true, request.Count };
  CheckPoints(points);
  const bool isMesh = this->IsMesh();
  const bool isField = this->Deformation == Deformations::Field;
  const bool isInverted = request.IsInverse != this->IsInverse();
  std::vector<glm::dvec3> nodes;
  std::unique_ptr<PointMap> map; // null: the volume is at rest
  if (isMesh)
  {
    nodes = this->Mesh.GetWorldPoints();
    auto made = std::make_unique<MeshPointMap>(nodes, this->Mesh.GetCells().Tetrahedra);
    made->SetPointsAreFloats(request.AreFloats);
    made->Set(this->Mesh.GetWorldDisplacements(), this->Outside, isInverted);
    map = std::move(made);
  }
  else if (isField)
  {
    map = std::make_unique<FieldPointMap>(this->Field.GetWorldField(), this->Outside, isInverted);
  }
  std::atomic<std::int64_t> outside{ 0 };
  std::atomic<double> leastFading{ 0.0 }; // the negated largest displacement
  for (std::size_t begin = 0; begin < request.Count; begin += PointsPerReport)
  {
    if (request.Progress &&
      !request.Progress(static_cast<double>(begin) / static_cast<double>(request.Count)))
    {
      throw Aborted();
    }
    ParallelForParts(std::min(PointsPerReport, request.Count - begin), PointsPerPart,
      [&](std::size_t from, std::size_t to)
      {
        std::int64_t outsideHere = 0;
        double fadingHere = 0.0;
        for (std::size_t i = begin + from; i < begin + to; ++i)
        {
          PointMap::Image image;
          const bool isValid = MovePoint(map.get(), isInverted, points.Get(i), image);
          std::copy_n(&image.Point.x, 3, request.Moved + 3 * i);
          request.Valid[i] = isValid ? 1 : 0;
          outsideHere += isValid ? 0 : 1;
          fadingHere = std::max(fadingHere, image.FadingDisplacement);
        }
        outside += outsideHere;
        Lower(leastFading, -fadingHere);
      });
  }
  PointsReport report;
  report.NumberOfOutsidePoints = outside;
  const auto warn = [&](const std::string& warning)
  { report.Warnings += (report.Warnings.empty() || warning.empty() ? "" : " ") + warning; };
  if (outside > 0)
  {
    warn(std::to_string(outside) + " of " + std::to_string(request.Count) +
      " points lie outside the " + (isInverted ? "deformed " : "") +
      (isField ? "displacement field" : "mesh") + ", and do not move." +
      (this->Outside.AreExtrapolated() || this->Outside.AreKept()
          ? ""
          : " To move points outside, extrapolate the deformation, or let it fade."));
  }
  if (isMesh)
  {
    const MeshCells& cells = this->Mesh.GetCells();
    for (const std::string& warning : GetCellWarnings(cells.Ignored, cells.WrongOrder))
    {
      warn(warning);
    }
  }
  warn(GetFoldWarning(
    "border of the deformation moves", -leastFading.load(), this->Outside.FadeDistance));
  return report;
}

} // namespace deformvolume
