// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChainMailTypes_h
#define DeformVolumeChainMailTypes_h

#include "Extent.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace deformvolume
{

/// How far the links of a voxel give way, as fractions of the spacing. A link between two materials
/// has the mean of their limits. The default is a soft tissue. All of them are engineering values.
struct ChainMailMaterial
{
  /// The shortest that a link may be along its axis, 0 to 1.
  double MinimumStretch = 0.5;
  /// The longest, 1 to 1000.
  double MaximumStretch = 1.5;
  /// How far its ends may move past each other across its axis, 0 to 1000.
  double Shear = 0.5;
};

/// The materials of vtkChainMailDeformation by default: air, soft tissue, muscle, cartilage, bone.
inline constexpr std::array<ChainMailMaterial, 5> DefaultChainMailMaterials{ { { 0.1, 2.0, 1.0 },
  { 0.5, 1.5, 0.5 }, { 0.8, 1.2, 0.2 }, { 0.95, 1.05, 0.05 }, { 0.99, 1.01, 0.01 } } };
/// The one of voxels for which nothing else tells one: soft tissue.
constexpr int DefaultChainMailMaterial = 1;

/// Voxels that are held together, and where.
struct ChainMailHandle
{
  /// Continuous structured indices of the place at rest.
  std::array<double, 3> RestPosition{ { 0, 0, 0 } };
  /// Voxels within this distance at rest are held, in world units; at least the nearest one is.
  double Radius = 0.0;
  /// Where they are to be displaced to, in voxels on each axis.
  std::array<double, 3> Displacement{ { 0, 0, 0 } };
};

/// What a step of a ChainMailModel is to do.
struct ChainMailRequest
{
  /// The first ones come first where handles contradict each other.
  std::vector<ChainMailHandle> Handles;
  /// Passes of relaxation over the blocks that were moved in the last 30 steps; 0: none.
  int RelaxationSweeps = 0;
  /// How much of the way to the mean of its neighbours a voxel moves in a sweep, 0 to 1.
  double Elasticity = 1.0;
  /// Voxels that are nearer to it than this fraction of the spacing do not relax.
  double PlasticityThreshold = 0.0;
  /// Called between launches; returning false aborts the step.
  std::function<bool()> Progress;
};

/// What has become of a handle in a step.
struct ChainMailHandleReport
{
  /// Voxels that are held: elements that are neither pinned nor held by a handle before this one.
  std::int64_t NumberOfVoxels = 0;
  /// What was taken from the displacement so that pinned voxels, and handles before this one, stay:
  /// wanted minus applied, in voxels.
  std::array<double, 3> Reduction{ { 0, 0, 0 } };
  /// False: no displacement of these voxels as a whole is possible; they are not held.
  bool IsHeld = true;
};

/// What a step of a ChainMailModel has done.
struct ChainMailReport
{
  /// Rounds over the active blocks until no bound changed, and sweeps of relaxation.
  std::int64_t NumberOfSweeps = 0;
  /// Voxels whose displacement is not what it was before the step.
  std::int64_t NumberOfMovedVoxels = 0;
  /// The largest violation of a limit by a moved voxel, as a fraction of the spacing.
  double LargestViolation = 0.0;
  /// One for each handle of the request, in the same order.
  std::vector<ChainMailHandleReport> Handles;
  /// Whether all displacements were put to 0 since the last step: by Reset(), or because links or
  /// materials were set that they would violate.
  bool WasReset = false;
  /// Blocks of 8 x 8 x 8 voxels, or rows of these, in which the output was changed since the last
  /// step, as structured indices; and what holds all of them, empty if there are none.
  std::vector<Extent> Changes;
  /// Holds all of Changes, in structured indices; empty if there are none.
  Extent ChangedExtent{ { 0, -1, 0, -1, 0, -1 } };

  /// Handles whose displacement was reduced.
  int CountReducedHandles() const
  {
    return static_cast<int>(std::count_if(this->Handles.begin(), this->Handles.end(),
      [](const ChainMailHandleReport& handle)
      {
        return std::any_of(handle.Reduction.begin(), handle.Reduction.end(),
          [](double reduction) { return reduction != 0.0; });
      }));
  }
  /// Handles that were released.
  int CountReleasedHandles() const
  {
    return static_cast<int>(std::count_if(this->Handles.begin(), this->Handles.end(),
      [](const ChainMailHandleReport& handle) { return !handle.IsHeld; }));
  }
};

} // namespace deformvolume

#endif
