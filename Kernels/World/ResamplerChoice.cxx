// SPDX-License-Identifier: BSD-3-Clause
#include "ResamplerChoice.h"

#include "Error.h"
#include "IndexDeformation.h"
#include "MemoryError.h"

#include <optional>
#include <string>

namespace deformvolume
{
namespace
{

/// What mesh rasterization cannot do, and how it becomes possible.
struct Obstacle
{
  const char* Subject;
  const char* Remedy;
};

std::optional<Obstacle> FindObstacle(
  const IndexDeformation& deformation, const ResamplerRequest& request)
{
  if (deformation.IsField())
  {
    return Obstacle{ "forward displacement fields", "connect a tetrahedral mesh" };
  }
  if (request.Outside.AreExtrapolated())
  {
    return Obstacle{ "the outside mode EXTRAPOLATE", "OutsideMode to DISCARD" };
  }
  if (request.Outside.AreKept())
  {
    return Obstacle{ "the outside mode KEEP", "OutsideMode to DISCARD" };
  }
  if (request.HasSmoothCut)
  {
    return Obstacle{ "smooth cuts", "SmoothCut of vtkCutVolume to off" };
  }
  if (request.NeedsJacobian)
  {
    return Obstacle{ "Jacobians of meshes", "GenerateJacobian to off and no density arrays" };
  }
  if (request.CountsFolds)
  {
    return Obstacle{ "fold counts of meshes", "GenerateFoldCount to off" };
  }
  return std::nullopt;
}

} // namespace

Resampling ChooseResampler(const IndexDeformation& deformation, const ResamplerRequest& request,
  const std::function<void(Resampling)>& checkMemory)
{
  if (deformation.IsInverseField())
  {
    if (request.Method && *request.Method != Resampling::MeshRasterization)
    {
      throw Error(
        "An inverse displacement field leads from the output to the volume, so that there "
        "is no sampling mesh to deform. Set Resampler to AUTOMATIC or "
        "MESH_RASTERIZATION.");
    }
    if (request.HasSmoothCut)
    {
      throw Error("An inverse displacement field cannot open smooth cuts, since it does not say "
                  "where the two sides go. Set SmoothCut of vtkCutVolume to off, or take a mesh or "
                  "a forward field.");
    }
    return Resampling::MeshRasterization;
  }
  const std::optional<Obstacle> obstacle = FindObstacle(deformation, request);
  if (obstacle && request.Method == Resampling::MeshRasterization)
  {
    throw Error(std::string("The resampler MESH_RASTERIZATION cannot do ") + obstacle->Subject +
      ". Set Resampler to EXACT, or " + obstacle->Remedy + ".");
  }
  if (request.Method)
  {
    return *request.Method;
  }
  const auto fits = [&](Resampling method)
  {
    try
    {
      checkMemory(method);
      return true;
    }
    catch (const MemoryError&)
    {
      return false;
    }
  };
  return !obstacle && !fits(Resampling::Exact) && fits(Resampling::MeshRasterization)
    ? Resampling::MeshRasterization
    : Resampling::Exact;
}

} // namespace deformvolume
