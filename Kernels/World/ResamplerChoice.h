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

class IndexDeformation;

/// The input for the choice of a resampler.
struct ResamplerRequest
{
  /// The requested resampler; none: automatic choice.
  std::optional<Resampling> Method;
  /// The treatment of voxels outside the mesh or the field.
  OutsideVoxels Outside;
  /// Whether the volume has a smooth cut, which only Exact supports.
  bool HasSmoothCut = false;
  /// Whether Jacobians are requested. For a mesh, only Exact supports these.
  bool NeedsJacobian = false;
  /// Whether fold counts are requested. For a mesh, only Exact supports these.
  bool CountsFolds = false;
};

/// Returns the resampler for a deformation. checkMemory: throws a MemoryError if the memory does
/// not suffice for a resampler. Throws an Error if the requested options cannot be combined.
///
/// The automatic choice is Exact, because its values are those of the deformed sampling mesh. It is
/// MeshRasterization if the memory suffices only for that (the sampling mesh of Exact takes about
/// 20 bytes per voxel), and if it supports the deformation: a mesh, with voxels outside it
/// discarded, without smooth cuts, Jacobians and fold counts.
DEFORMVOLUME_EXPORT Resampling ChooseResampler(const IndexDeformation& deformation,
  const ResamplerRequest& request, const std::function<void(Resampling)>& checkMemory);

} // namespace deformvolume

#endif
