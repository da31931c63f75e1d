// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeResamplerChoice_h
#define DeformVolumeResamplerChoice_h

#include "DeformRequest.h"
#include "DeformVolumeExport.h"
#include "OutsideVoxels.h"

#include <functional>
#include <optional>

namespace deformvolume
{

/// What is asked for.
struct ResamplerWish
{
  enum class Kinds
  {
    Mesh,
    ForwardField,
    InverseField
  };
  Kinds Deformation = Kinds::Mesh;
  std::optional<Resampling> Method; // none: the choice is free
  OutsideVoxels Outside;
  bool HasSmoothCut = false;  // of the volume, which Exact alone knows
  bool NeedsJacobian = false; // of the deformation, which a mesh has with Exact alone
  bool CountsFolds = false;   // the same
};

/// The resampler for a deformation. fits tells whether the memory suffices for one. Throws an Error
/// where what is asked for does not go together.
///
/// Where the choice is free: Exact, because its values are those of the deformed sampling mesh,
/// except where the memory does not suffice for Exact, whose sampling mesh takes some 20 bytes a
/// voxel, but does for MeshRasterization, and that can do the deformation: a mesh, with what is
/// outside discarded, without a smooth cut, Jacobians and fold counts.
DEFORMVOLUME_EXPORT Resampling ChooseResampler(
  const ResamplerWish& wish, const std::function<bool(Resampling)>& fits);

} // namespace deformvolume

#endif
