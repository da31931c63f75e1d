// SPDX-License-Identifier: BSD-3-Clause
#include "ResamplerChoice.h"

#include "Error.h"

#include <string>

namespace deformvolume
{

Resampling ChooseResampler(const ResamplerWish& wish, const Deformation& deformation,
  const std::function<bool(Resampling)>& fits)
{
  const bool cubic = wish.Interpolation == Interpolation::Cubic;
  if (deformation.IsInverseField())
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
  if (cubic && wish.Method && *wish.Method != Resampling::MeshRasterization)
  {
    throw Error("The cubic interpolation is there only with the resampler MESH_RASTERIZATION. Set "
                "Resampler to AUTOMATIC or MESH_RASTERIZATION, or Interpolation to "
                "LINEAR_INTERPOLATION.");
  }
  const std::string obstacle = deformation.IsField()
    ? "forward displacement fields. Connect a tetrahedral mesh to input port 1"
    : wish.Outside.AreExtrapolated() ? "the outside mode EXTRAPOLATE. Set OutsideMode to DISCARD"
    : wish.Outside.AreKept()         ? "the outside mode KEEP. Set OutsideMode to DISCARD"
    : wish.HasSmoothCut              ? "smooth cuts. Set SmoothCut of vtkCutVolume to off"
                                     : "";
  if (!obstacle.empty() && (cubic || (wish.Method == Resampling::MeshRasterization)))
  {
    throw Error("The resampler MESH_RASTERIZATION" +
      std::string(cubic ? ", which cubic interpolation needs," : "") + " cannot do " + obstacle +
      (cubic ? ", or Interpolation to LINEAR_INTERPOLATION." : ", or Resampler to EXACT."));
  }
  if (wish.Method)
  {
    return *wish.Method;
  }
  if (cubic)
  {
    return Resampling::MeshRasterization;
  }
  return obstacle.empty() && !fits(Resampling::Exact) && fits(Resampling::MeshRasterization)
    ? Resampling::MeshRasterization
    : Resampling::Exact;
}

} // namespace deformvolume
