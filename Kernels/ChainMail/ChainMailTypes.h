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

/// The limits of the links of a voxel, as fractions of the spacing. A link between two materials
/// has the mean of their limits. The default is a soft tissue. All limits are engineering values,
/// not measurements.
struct ChainMailMaterial
{
  /// The shortest length of a link along its axis, 0 to 1.
  double MinimumStretch = 0.5;
  /// The longest length of a link along its axis, 1 to 1000.
  double MaximumStretch = 1.5;
  /// The largest displacement of the ends of a link relative to each other, across its axis, 0 to
  /// 1000.
  double Shear = 0.5;
};

/// The default materials of vtkChainMailDeformation: air, soft tissue, muscle, cartilage, bone.
inline constexpr std::array<ChainMailMaterial, 5> DefaultChainMailMaterials{ { { 0.1, 2.0, 1.0 },
  { 0.5, 1.5, 0.5 }, { 0.8, 1.2, 0.2 }, { 0.95, 1.05, 0.05 }, { 0.99, 1.01, 0.01 } } };
/// The default material of voxels: soft tissue.
constexpr int DefaultChainMailMaterial = 1;

/// A group of voxels that are held together, and their displacement.
struct ChainMailHandle
{
  /// The rest position, in continuous structured indices.
  std::array<double, 3> RestPosition{ { 0, 0, 0 } };
  /// The radius, in world units. Voxels within this distance at rest are held; at least the nearest
  /// voxel is held.
  double Radius = 0.0;
  /// The prescribed displacement, in voxels on each axis.
  std::array<double, 3> Displacement{ { 0, 0, 0 } };
};

/// The input of ChainMailModel::Step().
struct ChainMailRequest
{
  /// The handles. If handles contradict each other, earlier ones have priority.
  std::vector<ChainMailHandle> Handles;
  /// The number of relaxation sweeps over the blocks that were moved in the last 30 steps; 0: none.
  int RelaxationSweeps = 0;
  /// The fraction of the distance to the mean of its neighbors that a voxel moves in a sweep, 0 to
  /// 1.
  double Elasticity = 1.0;
  /// Voxels closer to this mean than this fraction of the spacing do not relax. Each axis is
  /// decided independently.
  double PlasticityThreshold = 0.0;
  /// Called between launches. Return false to abort the step.
  std::function<bool()> Progress;
};

/// The result of a step for one handle.
struct ChainMailHandleReport
{
  /// The number of voxels held: elements that are neither pinned nor held by an earlier handle.
  std::int64_t NumberOfVoxels = 0;
  /// The reduction of the displacement so that pinned voxels and earlier handles do not move:
  /// requested minus applied displacement, in voxels.
  std::array<double, 3> Reduction{ { 0, 0, 0 } };
  /// False if there are no such voxels, or if they cannot be displaced together. They are not held
  /// then.
  bool IsHeld = true;
};

/// The output of ChainMailModel::Step().
struct ChainMailReport
{
  /// The number of rounds over active blocks plus the number of relaxation sweeps.
  std::int64_t NumberOfSweeps = 0;
  /// The number of voxels whose displacement changed in this step.
  std::int64_t NumberOfMovedVoxels = 0;
  /// The largest violation of a limit by a moved voxel, as a fraction of the spacing.
  double LargestViolation = 0.0;
  /// The results of the handles, in the order of the request.
  std::vector<ChainMailHandleReport> Handles;
  /// Whether all displacements were set to 0 since the last step: by Reset(), or because they would
  /// violate new links or materials.
  bool WasReset = false;
  /// The blocks of 8 x 8 x 8 voxels, or rows of such blocks, in which the output changed since the
  /// last step, as extents in structured indices.
  std::vector<Extent> Changes;
  /// The bounding box of all Changes, in structured indices; empty if there are none.
  Extent ChangedExtent = EmptyExtent;

  /// Returns the number of handles whose displacement was reduced.
  int CountReducedHandles() const
  {
    return static_cast<int>(std::count_if(this->Handles.begin(), this->Handles.end(),
      [](const ChainMailHandleReport& handle)
      {
        return std::any_of(handle.Reduction.begin(), handle.Reduction.end(),
          [](double reduction) { return reduction != 0.0; });
      }));
  }
  /// Returns the number of handles that were released.
  int CountReleasedHandles() const
  {
    return static_cast<int>(std::count_if(this->Handles.begin(), this->Handles.end(),
      [](const ChainMailHandleReport& handle) { return !handle.IsHeld; }));
  }
};

} // namespace deformvolume

#endif
