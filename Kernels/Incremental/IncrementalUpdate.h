// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeIncrementalUpdate_h
#define DeformVolumeIncrementalUpdate_h

#include "BrickPoints.h"
#include "DisplacementBounds.h"
#include "DisplacementObserver.h"
#include "Extent.h"
#include "PointSet.h"
#include "VoxelGrid.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace deformvolume
{

/// Finds out which part of an output has to be made anew after a change of the deformation or of
/// the masks.
///
/// A sub-brick of cells changes when a point that moves its vertices does, or a mask near it.
/// All that it wrote, and all that it will write, lies within a box: its box at rest, widened by
/// the least and the greatest displacement of its points, and by their difference where a smooth
/// cut continues displacements across the sheet. Patches of the output that the boxes of
/// changed sub-bricks touch, before or after the change, are cleared, and of all bricks with a
/// sub-brick whose box touches such a patch the sections that these sub-bricks lie in are run: what
/// they write outside these patches they wrote before, since nobody else writes there. (Where the
/// volume is folded over, ExactResampler::MakeAgain keeps these patches as they are.)
///
/// Where all vertices of the changed sub-bricks are inside the sampling mesh, nothing is cleared
/// and only changed sub-bricks are run: their cells fill the same space as before, between cells
/// that stay, so that together they own the same voxels, unless some are inverted, which the counts
/// tell.
class IncrementalUpdate : public DisplacementObserver
{
public:
  /// What there is to do.
  struct Plan
  {
    std::vector<std::uint32_t> Bricks;  // as DEFORMVOLUME_BRICK_BITS says
    std::vector<std::uint32_t> Patches; // counted along x, then y, then z
  };

  /// An output of this extent was made, wholly, of what is set now.
  void Start(const BrickGrid& bricks, const VoxelGrid& voxelGrid, const Extent& output);
  /// How far bricks look from now on (BrickGrid::Halo).
  void SetHalo(int halo);
  /// The vertices of cells that a smooth cut crosses, since there is another one: after Start.
  void SetCut(const std::vector<CutVertex>& vertices);
  /// The same while it is tracked what changes: the last output still is that with the cut before.
  /// Returns whether sub-bricks have vertices of the cut now; empty: none has.
  std::vector<unsigned char> AddCut(const std::vector<CutVertex>& vertices);
  /// The last output is of no use any more.
  void Forget() { this->Tracking = false; }
  /// The last output was brought up to date.
  void Finish();

  ///@{
  /// See DisplacementObserver. As long as the last output can serve it is tracked what changes;
  /// where all points change it is of no use any more. The bounds of all points only grow as long
  /// as not all change.
  bool IsTracking() const override { return this->Tracking; }
  std::size_t GetMostMoved(std::size_t numberOfPoints) const override;
  bool HasPoints() const override { return !this->Points.IsEmpty(); }
  void SetPoints(BrickPoints&& points) override;
  void ForgetMapping() override;
  bool KnowsAllBoxes() const override;
  void MovePoints(const PointSet& changed, const float* last) override;
  std::optional<std::vector<Extent>> ChangeTetrahedra(
    const std::vector<TetrahedronChange>& changes, const float* last) override;
  void AddMoved(const DisplacementBounds& after) override;
  void MoveAll(const std::optional<DisplacementBounds>& after) override;
  ///@}

  /// A box round the vertices of the sub-bricks of which points moved, in local indices.
  Extent GetMovedVertices() const;
  /// Whether all that changed are sub-bricks of which points moved and all vertices are inside the
  /// sampling mesh. state: of the vertices in a box that holds these (VertexState.cl), null where
  /// all have a position and all cells are active.
  bool IsInside(const unsigned char* state, const Extent& box) const;

  /// Whether it is known where sub-bricks lie, as far as MakePlan wants it.
  bool HasBoxes() const { return this->BoxesKnown; }
  /// Finds that out. displacements: of so many points, after the change.
  void FindBoxes(const Displacements& displacements, std::size_t numberOfPoints);
  /// Finds out where all sub-bricks lie. displacements: as for the last output.
  void FindAllBoxes(const Displacements& displacements);
  /// Finds out where the changed sub-bricks lie, and no others.
  void FindChangedBoxes(const Displacements& displacements);

  /// A mask of vertices, or of cells, changes in some boxes of these.
  void ChangeMask(const std::vector<Extent>& changes, bool ofCells);

  /// False where it is better to make all anew. inside: see IsInside; boxes are not needed then.
  bool MakePlan(bool inside, Plan& plan);

  /// The output voxels that may change, in structured indices: those in the boxes of changed
  /// sub-bricks, before and after the change. These boxes must be known.
  Extent GetChangedExtent() const;
  /// The patches of the output that these voxels lie in.
  std::vector<std::uint32_t> GetChangedPatches() const;

  const Extent& GetOutputExtent() const { return this->OutputExtent; }

private:
  /// In output voxels, counted from the first one; empty where Min > Max.
  struct Box
  {
    std::array<double, 3> Min;
    std::array<double, 3> Max;
  };
  using Patches = std::array<int, 6>;          // first and last patch on each axis
  static constexpr std::size_t StepSize = 256; // sub-bricks that a thread takes at a time

  /// Calls body(sub-brick) for those that have vertices of a box, or with more = 1 of cells of it,
  /// or so many voxels beyond.
  template <typename Body>
  void ForSubBricks(const Extent& box, int more, int halo, Body&& body) const;
  /// A sub-brick is about to change by its points.
  void Move(std::size_t subBrick, const float* last);
  DisplacementBounds ComputeBounds(std::size_t subBrick, const Displacements& displacements) const;
  Box MakeBox(std::size_t subBrick, const DisplacementBounds& bounds) const;
  DisplacementBounds ComputeAllBounds(
    const Displacements& displacements, std::size_t numberOfPoints) const;
  /// Finds the boxes of the sub-bricks that a function wants, where they are not known.
  template <typename IsWanted>
  void FindBoxesOf(const IsWanted& isWanted, const Displacements& displacements);
  /// The voxels in a box, within the output and counted from its first one; false without such.
  bool GetVoxels(const Box& box, Extent& voxels) const;
  /// Whether sub-bricks have vertices of a cut; empty: none has.
  std::vector<unsigned char> FindCutBricks(const std::vector<CutVertex>& vertices) const;
  /// Bricks may reach beyond the volume.
  bool HasCells(std::size_t subBrick) const
  {
    return GetNumberOfCells(this->Grid.GetVertices(subBrick, 0)) > 0;
  }
  bool IsChanged(std::size_t subBrick) const
  {
    return this->Moved[subBrick] || this->Masked[subBrick];
  }
  /// A box round the patches that the boxes of changed sub-bricks touch, before or after the
  /// change.
  Box GetDirtyBox() const;
  static bool IsApart(const Box& a, const Box& b);
  bool HasOnlyInterior(std::size_t subBrick, const unsigned char* state, const Extent& box) const;
  Patches GetPatches(const Box& box) const;
  void MarkPatches(const Box& box, std::vector<unsigned char>& dirty) const;
  std::vector<unsigned char> MakeFlagsOfPatches() const;
  static std::vector<std::uint32_t> ListPatches(const std::vector<unsigned char>& dirty);
  /// Marks those that a changed sub-brick touches, before or after the change.
  void MarkChangedPatches(std::size_t subBrick, std::vector<unsigned char>& dirty) const;
  /// Finds the patches to clear, and adds the sub-bricks that touch them to the sections to run.
  void PlanPatches(const std::vector<std::size_t>& changed, std::vector<std::uint32_t>& run,
    std::vector<unsigned char>& dirty) const;
  bool TouchesPatches(const Box& box, const std::vector<unsigned char>& dirty) const;

  bool Tracking = false;
  BrickGrid Bricks;
  BrickGrid Grid; // of their sub-bricks, which all that follows is about
  VoxelGrid Shape;
  Extent OutputExtent{ { 0, -1, 0, -1, 0, -1 } };
  std::array<int, 3> PatchCount{ { 0, 0, 0 } };
  BrickPoints Points;
  BrickPoints PointsOfBricks;
  // The brick and the section of each sub-brick: see BrickGrid::GetBrick.
  std::vector<std::pair<std::size_t, std::uint32_t>> Places;
  std::vector<Box> Boxes; // as far as they are known
  std::vector<unsigned char> Known;
  bool BoxesKnown = false; // all that changed, and all that may touch what these touch
  std::optional<DisplacementBounds> AllBounds; // of all points, or wider
  std::vector<Box> LastBoxes;                  // of those that were moved
  std::vector<unsigned char> Moved;
  std::vector<unsigned char> Masked;
  std::vector<unsigned char> IsCut; // by the cut now, or that of the last output; see FindCutBricks
};

} // namespace deformvolume

#endif
