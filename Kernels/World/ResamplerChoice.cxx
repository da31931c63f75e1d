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
    ? "forward displacement fields. Set Resampler to EXACT, or connect a tetrahedral mesh"
    : wish.Outside.AreExtrapolated()
    ? "the outside mode EXTRAPOLATE. Set Resampler to EXACT, or OutsideMode to DISCARD"
    : wish.Outside.AreKept()
    ? "the outside mode KEEP. Set Resampler to EXACT, or OutsideMode to DISCARD"
    : wish.HasSmoothCut ? "smooth cuts. Set Resampler to EXACT, or SmoothCut of vtkCutVolume to off"
    : wish.NeedsJacobian
    ? "Jacobians of meshes. Set Resampler to EXACT, or GenerateJacobian to off and no density "
      "arrays"
    : wish.CountsFolds
    ? "fold counts of meshes. Set Resampler to EXACT, or GenerateFoldCount to off"
    : "";
  if (!obstacle.empty() && wish.Method == Resampling::MeshRasterization)
  {
    throw Error("The resampler MESH_RASTERIZATION cannot do " + obstacle + ".");
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
