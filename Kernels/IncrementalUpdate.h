// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeIncrementalUpdate_h
#define DeformVolumeIncrementalUpdate_h

#include "BrickPoints.h"
#include "VolumeDeformer.h"

#include <cstdint>
#include <vector>

namespace deformvolume
{

/// Finds out which part of an output has to be made anew after a change of the deformation or of
/// the masks.
///
/// A part of a brick of cells changes when a point that moves its vertices does, or a mask near it.
/// All that it wrote, and all that it will write, lies within a box: its box at rest, widened by
/// the least and the greatest displacement of its points. Patches of the output that the boxes of
/// changed parts touch, before or after the change, are cleared, and of all bricks with a part
/// whose box touches such a patch the sections that these parts lie in are run: what they write
/// outside these patches they wrote before, since nobody else writes there.
class IncrementalUpdate
{
public:
  /// What there is to do.
  struct Plan
  {
    std::vector<std::uint32_t> Bricks;  // as DEFORMVOLUME_BRICK_BITS says
    std::vector<std::uint32_t> Patches; // counted along x, then y, then z
  };

  /// Whether the last output can serve, so that what changes has to be told.
  bool IsTracking() const { return this->Tracking; }

  /// An output of this extent was made, wholly, of what is set now.
  void Start(const BrickGrid& bricks, const Lattice& lattice, const Extent& output);
  /// The last output is of no use any more.
  void Forget() { this->Tracking = false; }
  /// All points change; the last output is of no use any more.
  void MoveAll();
  /// The last output was brought up to date.
  void Finish();

  /// The points of the parts of bricks; found when they are needed first, and forgotten with the
  /// mapping.
  bool HasPoints() const { return !this->Points.IsEmpty(); }
  void SetPoints(BrickPoints&& points) { this->Points = std::move(points); }
  void ForgetMapping();

  /// Points will change: nonzero where they do. last: four floats a point, the displacements before
  /// the change.
  void MovePoints(const std::vector<unsigned char>& changed, const float* last);

  /// A mask will change: of vertices, one byte each, or of cells. Null stands for a mask that is
  /// the given value everywhere.
  void ChangeMask(
    const unsigned char* last, const unsigned char* next, unsigned char value, bool ofCells);

  /// displacements: four floats a point. False where it is better to make all anew.
  bool MakePlan(const float* displacements, Plan& plan);

  const Extent& GetOutputExtent() const { return this->OutputExtent; }

private:
  /// In output voxels, counted from the first one; empty where Min > Max.
  struct Box
  {
    std::array<double, 3> Min;
    std::array<double, 3> Max;
  };
  using Patches = std::array<int, 6>; // first and last patch on each axis

  Box ComputeBox(std::size_t part, const float* displacements) const;
  bool IsChanged(std::size_t part) const { return this->Moved[part] || this->Masked[part]; }
  Patches GetPatches(const Box& box) const;

  bool Tracking = false;
  BrickGrid Bricks;
  BrickGrid Grid; // of their parts, which all that follows is about
  Lattice Shape;
  Extent OutputExtent{ { 0, -1, 0, -1, 0, -1 } };
  std::array<int, 3> PatchCount{ { 0, 0, 0 } };
  BrickPoints Points;
  std::vector<Box> Boxes; // as far as they are known
  std::vector<unsigned char> Known;
  std::vector<Box> LastBoxes; // of those that were moved
  std::vector<unsigned char> Moved;
  std::vector<unsigned char> Masked;
};

} // namespace deformvolume

#endif
