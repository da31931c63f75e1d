// SPDX-License-Identifier: BSD-3-Clause
#include "ResamplerChoice.h"

#include "Error.h"

#include <string>

namespace deformvolume
{

Resampling ChooseResampler(const ResamplerWish& wish, const std::function<bool(Resampling)>& fits)
{
  if (wish.Deformation == ResamplerWish::Kinds::InverseField)
  {
    if (wish.Method && *wish.Method != Resampling::MeshRasterization)
    {
      throw Error(
        "An inverse displacement field leads from the output to the volume, so that there "
        "is no sampling mesh to deform. Set Resampler to AUTOMATIC or "
        "MESH_RASTERIZATION.");
    }
    if (wish.HasSmoothCut)
    {
      throw Error("An inverse displacement field cannot open smooth cuts, since it does not say "
                  "where the two sides go. Set SmoothCut of vtkCutVolume to off, or take a mesh or "
                  "a forward field.");
    }
    return Resampling::MeshRasterization;
  }
  const std::string obstacle = wish.Deformation == ResamplerWish::Kinds::ForwardField
    ? "forward displacement fields. Connect a tetrahedral mesh to input port 1"
    : wish.Outside.AreExtrapolated() ? "the outside mode EXTRAPOLATE. Set OutsideMode to DISCARD"
    : wish.Outside.AreKept()         ? "the outside mode KEEP. Set OutsideMode to DISCARD"
    : wish.HasSmoothCut              ? "smooth cuts. Set SmoothCut of vtkCutVolume to off"
    : wish.NeedsJacobian ? "Jacobians of meshes. Set GenerateJacobian off and remove density arrays"
    : wish.CountsFolds   ? "fold counts of meshes. Set GenerateFoldCount off"
                         : "";
  if (!obstacle.empty() && wish.Method == Resampling::MeshRasterization)
  {
    throw Error(
      "The resampler MESH_RASTERIZATION cannot do " + obstacle + ", or Resampler to EXACT.");
  }
  if (wish.Method)
  {
    return *wish.Method;
  }
  return obstacle.empty() && !fits(Resampling::Exact) && fits(Resampling::MeshRasterization)
    ? Resampling::MeshRasterization
    : Resampling::Exact;
}

} // namespace deformvolume
