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
  /// What deforms the volume.
  enum class Kinds
  {
    Mesh,
    ForwardField,
    InverseField
  };
  /// What deforms the volume.
  Kinds Deformation = Kinds::Mesh;
  /// The resampler that is asked for; none: the choice is free.
  std::optional<Resampling> Method;
  /// What becomes of voxels outside.
  OutsideVoxels Outside;
  /// Whether the volume has a smooth cut, which Exact alone knows.
  bool HasSmoothCut = false;
  /// Whether the Jacobian is asked for, which a mesh has with Exact alone.
  bool NeedsJacobian = false;
  /// Whether folds are counted, which a mesh has with Exact alone.
  bool CountsFolds = false;
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
