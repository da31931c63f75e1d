// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeChangeTracker_h
#define DeformVolumeChangeTracker_h

#include "BrickPoints.h"
#include "DisplacementBounds.h"
#include "Extent.h"
#include "IndexBounds.h"
#include "PointSet.h"
#include "Tetrahedron.h"
#include "VoxelGrid.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace deformvolume
{

/// Finds the parts of an output that must be updated after a change of the deformation or the
/// masks.
///
/// A sub-brick of cells changes if a point that moves its vertices changes, or a mask near it. All
/// voxels that it wrote or will write lie in a box: its box at rest, widened by the least and the
/// greatest displacement of its points, and by their difference where a smooth cut continues
/// displacements across the sheet. Patches of the output that intersect the boxes of changed
/// sub-bricks, before or after the change, are cleared. Then all sections are resampled that have a
/// sub-brick whose box intersects a cleared patch. Outside the cleared patches these sections write
/// the same values as before. (If the volume overlaps itself, ExactResampler::UpdateOutput keeps
/// the other patches unchanged.)
///
/// If all vertices of the changed sub-bricks are inside the sampling mesh, nothing is cleared, and
/// only the changed sub-bricks are resampled. Their cells fill the same space as before, between
/// cells that do not change, so they own the same voxels. Inverted cells are an exception, which
/// the counts of writes reveal.
class ChangeTracker
{
public:
  /// The parts to update.
  struct Plan
  {
    std::vector<std::uint32_t> Bricks;  // in the format of DEFORMVOLUME_BRICK_BITS
    std::vector<std::uint32_t> Patches; // numbered along x, then y, then z
  };

  /// Records that the whole output of this extent was made.
  void Start(const BrickGrid& bricks, const VoxelGrid& voxelGrid, const Extent& output);
  /// Set how far bricks depend on vertices beyond them (BrickGrid::Halo).
  void SetHalo(int halo);
  /// Set the vertices of cells that a smooth cut crosses, after Start.
  void SetCut(const std::vector<CutVertex>& vertices);
  /// Set the vertices of a new cut while changes are tracked and the last output has the previous
  /// cut. Returns for each sub-brick whether it has vertices of the new cut; empty if none has.
  std::vector<unsigned char> AddCut(const std::vector<CutVertex>& vertices);
  /// Discards the last output.
  void Invalidate() { this->Tracking = false; }
  /// Records that the last output was updated.
  void Finish();

  /// Whether changes are tracked: as long as there is a last output.
  bool IsTracking() const { return this->Tracking; }
  /// Returns the largest number of changed points, of numberOfPoints, that are worth tracking. If
  /// more points change, call MoveAll().
  std::size_t GetMaxMoved(std::size_t numberOfPoints) const;

  /// Whether the points that move each sub-brick are known, as MovePoints() needs. False at first
  /// and after InvalidateMapping().
  bool HasPoints() const { return !this->Points.IsEmpty(); }
  /// Set the points that move each sub-brick.
  void SetPoints(BrickPoints&& points);
  /// Call this if the mapping from points to vertices has changed.
  void InvalidateMapping();

  /// Whether the boxes of all sub-bricks are known. If so, MovePoints() does not need the
  /// displacements before the change, and may be called after it.
  bool HasAllBoxes() const;
  /// Records that points will change. last: displacements before the change, four floats per point;
  /// null: the points have already changed (HasAllBoxes()).
  void MovePoints(const PointSet& changed, const float* last);
  /// Records that the nodes of tetrahedra will change. last: as in MovePoints(). Returns boxes that
  /// contain all vertices in these tetrahedra; empty if they are not known.
  std::optional<std::vector<Extent>> ChangeTetrahedra(
    const std::vector<TetrahedronChange>& changes, const float* last);
  /// Records that points have changed. after: bounds of the new displacements of at least these
  /// points. The bounds of all points only grow until all points change.
  void AddMoved(const DisplacementBounds& after);
  /// Records that all points may have changed, and discards the last output. after: bounds of all
  /// new displacements, if they are known.
  void MoveAll(const std::optional<DisplacementBounds>& after);

  /// Returns a box of the vertices of all sub-bricks with moved points, in local indices.
  Extent GetMovedVertices() const;
  /// Whether only sub-bricks with moved points changed, and all of their vertices are inside the
  /// sampling mesh. state: the states (VertexState.cl) of the vertices in a box, which must contain
  /// the vertices of these sub-bricks; null if all vertices have a position and all cells are
  /// active.
  bool IsChangeInterior(const unsigned char* state, const Extent& box) const;

  /// Whether the boxes that PlanUpdate needs are known.
  bool HasPlanBoxes() const { return this->PlanBoxesKnown; }
  /// Finds the boxes that PlanUpdate() needs. displacements: of numberOfPoints points, after the
  /// change.
  void FindPlanBoxes(const Displacements& displacements, std::size_t numberOfPoints);
  /// Finds the boxes of all sub-bricks. displacements: the displacements of the last output.
  void FindAllBoxes(const Displacements& displacements);
  /// Finds the boxes of the changed sub-bricks only.
  void FindChangedBoxes(const Displacements& displacements);

  /// Records that a mask of vertices or cells changed in some boxes.
  void ChangeMask(const std::vector<Extent>& changes, bool ofCells);

  /// Plans the update. Returns false if a full update is faster. inside: the result of
  /// IsChangeInterior(); if true, no boxes are needed.
  bool PlanUpdate(bool inside, Plan& plan);

  /// Returns a box of the output voxels that may change, in structured indices: the union of the
  /// boxes of changed sub-bricks, before and after the change. These boxes must be known.
  Extent GetChangedExtent() const;
  /// Returns the patches of the output that contain these voxels.
  std::vector<std::uint32_t> GetChangedPatches() const;

  const Extent& GetOutputExtent() const { return this->OutputExtent; }

private:
  using Box = IndexBounds;                     // in output voxels, relative to the first one
  static constexpr std::size_t StepSize = 256; // sub-bricks for each task of a thread

  /// Calls body(sub-brick) for all sub-bricks with vertices in a box, enlarged by `halo` voxels.
  /// ofCells: whether the box is one of cells, which have vertices up to one index beyond it.
  template <typename Body>
  void ForSubBricks(const Extent& box, bool ofCells, int halo, Body&& body) const;
  /// Records that the points of a sub-brick are about to change.
  void Move(std::size_t subBrick, const float* last);
  DisplacementBounds ComputeBounds(std::size_t subBrick, const Displacements& displacements) const;
  Box MakeBox(std::size_t subBrick, const DisplacementBounds& bounds) const;
  DisplacementBounds ComputeAllBounds(
    const Displacements& displacements, std::size_t numberOfPoints) const;
  /// Finds those boxes that are not known yet, of the sub-bricks that a predicate selects.
  template <typename IsWanted>
  void FindBoxesOf(const IsWanted& isWanted, const Displacements& displacements);
  /// Returns the voxels of the output in a box, relative to the first one; false if there are none.
  bool GetVoxels(const Box& box, Extent& voxels) const;
  /// False for sub-bricks entirely outside the volume: the last bricks can extend beyond it.
  bool HasCells(std::size_t subBrick) const
  {
    return GetNumberOfCells(this->SubBricks.GetVertices(subBrick, 0)) > 0;
  }
  bool IsChanged(std::size_t subBrick) const
  {
    return this->Moved[subBrick] || this->Masked[subBrick];
  }
  /// Calls body(box) for the boxes of all changed sub-bricks, before and after the change.
  template <typename Body>
  void ForChangedBoxes(Body&& body) const
  {
    for (std::size_t subBrick = 0; subBrick < this->Moved.size(); ++subBrick)
    {
      if (this->IsChanged(subBrick))
      {
        body(this->Boxes[subBrick]);
        if (this->Moved[subBrick])
        {
          body(this->LastBoxes[subBrick]);
        }
      }
    }
  }
  /// Returns a box of all patches that intersect boxes of changed sub-bricks, before or after the
  /// change.
  Box GetDirtyBox() const;
  bool AreVerticesInterior(
    std::size_t subBrick, const unsigned char* state, const Extent& box) const;
  /// Calls body(first, end) for the rows of the patches that a box intersects, until it returns
  /// true. Returns whether it did.
  template <typename Body>
  bool AnyRowOfPatches(const Box& box, Body&& body) const;
  /// Returns for each patch whether it intersects the box of a changed sub-brick, before or after
  /// the change.
  std::vector<unsigned char> FindDirtyPatches() const;
  /// Adds the sections of sub-bricks that intersect dirty patches.
  void AddSections(
    const std::vector<unsigned char>& dirty, std::vector<std::uint32_t>& toResample) const;

  bool Tracking = false;
  BrickGrid Bricks;
  BrickGrid SubBricks; // all members below refer to these
  VoxelGrid Voxels;
  Extent OutputExtent = EmptyExtent;
  std::array<int, 3> PatchCount{ { 0, 0, 0 } };
  BrickPoints Points;
  BrickPoints PointsOfBricks;
  // The brick and the section of each sub-brick (BrickGrid::GetBrick).
  std::vector<std::pair<std::size_t, std::uint32_t>> Sections;
  std::vector<Box> Boxes; // valid where Known
  std::vector<unsigned char> Known;
  // Whether the boxes of changed sub-bricks, and of those that may share patches with these, are
  // known.
  bool PlanBoxesKnown = false;
  std::optional<DisplacementBounds> AllBounds; // of all points, possibly wider
  std::vector<Box> LastBoxes;                  // valid where Moved
  std::vector<unsigned char> Moved;
  std::vector<unsigned char> Masked;
  std::vector<unsigned char> IsCut; // by the current cut or by the cut of the last output
};

} // namespace deformvolume

#endif
