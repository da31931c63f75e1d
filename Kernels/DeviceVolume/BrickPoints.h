// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBrickPoints_h
#define DeformVolumeBrickPoints_h

#include "BrickGrid.h"
#include "Extent.h"
#include "KernelParameters.h"
#include "PointSet.h"
#include "Tetrahedron.h"
#include "VertexLink.h"
#include "VertexRuns.h"

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace deformvolume
{

/// The points of the deformation (nodes of the mesh or points of the field) that move the vertices
/// on which each brick depends.
class BrickPoints
{
public:
  BrickPoints() = default;
  /// The tetrahedra of a mesh. Numbers of nodes are multiplied by DEFORMVOLUME_NODE_STRIDE, as in
  /// the buffer on the device.
  struct Mesh
  {
    const Tetrahedron* Tetrahedra;
    std::size_t NumberOfTetrahedra;
    std::size_t NumberOfNodes;
    /// For each brick of the grid, the tetrahedra that move its cells at the boundary of the mesh.
    /// May be empty.
    const std::vector<std::vector<std::int32_t>>& Boundary;
  };
  /// Runs, as on the device (RunMapping.cl, RunEvaluation.cl).
  struct Runs
  {
    const VertexRun* First;
    const std::uint32_t* RowRanges;
    const double* Rest;
    const std::int32_t* Owners;
  };
  ///@{
  /// Find the nodes of a mesh that move the vertices of each brick.
  static BrickPoints FromLinks(const BrickGrid& grid, const VertexLink* links, const Mesh& mesh);
  static BrickPoints FromRuns(const BrickGrid& grid, const Runs& runs, const Mesh& mesh);
  ///@}
  /// boundary: for each brick of the grid, the box of the points of the field that move its cells
  /// at the boundary of the field. The vector and each box may be empty.
  static BrickPoints FromField(
    const BrickGrid& grid, const FieldParameters& field, const std::vector<Extent>& boundary);
  /// Returns the points of sets of bricks, with one element for each set. Use the result for
  /// AnyRange() and IsOutside() only.
  BrickPoints Join(const std::vector<std::vector<std::size_t>>& sets) const;

  bool IsEmpty() const { return this->Begins.empty() && this->Boxes.empty(); }

  /// The previous nodes of changed tetrahedra.
  struct PreviousNodes
  {
    explicit PreviousNodes(const std::vector<TetrahedronChange>& changes);
    std::vector<std::pair<std::int32_t, std::uint32_t>> Users; // nodes and changes, sorted
    std::vector<int> NumbersOfNodes;                           // different nodes of each change
    PointSet Used;                                             // all previous nodes
  };
  /// Finds the bricks that depend on all previous nodes of a changed tetrahedron, among the bricks
  /// for which isNear(brick) is true. Returns each brick with its changes, as indices into the list
  /// of changes. A brick may be found that depends on these nodes by other tetrahedra only.
  using ChangesOfBrick = std::pair<std::size_t, std::vector<std::size_t>>;
  std::vector<ChangesOfBrick> FindBricks(
    const PreviousNodes& nodes, const std::function<bool(std::size_t)>& isNear) const;
  /// Adds the new nodes of the changed tetrahedra to the bricks. No brick may be listed twice.
  void AddPoints(
    const std::vector<ChangesOfBrick>& bricks, const std::vector<TetrahedronChange>& changes);
  /// Whether the lists of added points have become long, so that new BrickPoints are faster.
  bool ShouldRebuild() const { return this->NumberOfAdded > this->Ranges.size() / 2 + 4096; }

  /// Calls body(begin, end) for the ranges of the points of a brick, until body returns true.
  /// Returns whether body has returned true.
  template <typename Body>
  bool AnyRange(std::size_t brick, Body&& body) const
  {
    if (this->Boxes.empty())
    {
      for (std::size_t i = this->Begins[brick]; i < this->Ends[brick]; ++i)
      {
        const Range& range = this->Ranges[i];
        if (body(static_cast<std::size_t>(range.Begin), static_cast<std::size_t>(range.End)))
        {
          return true;
        }
      }
      if (!this->Added.empty())
      {
        for (const std::int32_t point : this->Added[brick])
        {
          if (body(static_cast<std::size_t>(point), static_cast<std::size_t>(point) + 1))
          {
            return true;
          }
        }
      }
      return false;
    }
    const Extent& box = this->Boxes[brick];
    for (std::int64_t z = box[4]; z <= box[5]; ++z)
    {
      for (std::int64_t y = box[2]; y <= box[3]; ++y)
      {
        const std::int64_t row = (z * this->FieldSize[1] + y) * this->FieldSize[0];
        if (body(
              static_cast<std::size_t>(row + box[0]), static_cast<std::size_t>(row + box[1] + 1)))
        {
          return true;
        }
      }
    }
    return false;
  }

  /// For a field: the box of points of each brick.
  const std::vector<Extent>& GetBoxes() const { return this->Boxes; }

  /// Whether all points of a brick are certainly outside the range from begin to end - 1.
  bool IsOutside(std::size_t brick, std::size_t begin, std::size_t end) const
  {
    if (!this->Boxes.empty())
    {
      const Extent& box = this->Boxes[brick];
      const auto plane = static_cast<std::size_t>(this->FieldSize[0] * this->FieldSize[1]);
      return plane * static_cast<std::size_t>(box[5] + 1) <= begin ||
        plane * static_cast<std::size_t>(box[4]) >= end;
    }
    const std::size_t first = this->Begins[brick];
    const std::size_t past = this->Ends[brick];
    if (!this->Added.empty() && !this->Added[brick].empty())
    {
      return false;
    }
    return first == past || static_cast<std::size_t>(this->Ranges[past - 1].End) <= begin ||
      static_cast<std::size_t>(this->Ranges[first].Begin) >= end;
  }

  /// Largest absolute sum of the negative weights of a vertex in the brick. The displacement of a
  /// vertex exceeds the range of the displacements of its points by at most this number times the
  /// size of the range.
  double GetNegativeWeightSum(std::size_t brick) const
  {
    return this->NegativeWeightSum.empty() ? 0.0 : this->NegativeWeightSum[brick];
  }

  /// Whether bricks may have vertices whose displacement fades outside a field, and therefore is
  /// smaller than the displacements of all points of their brick.
  bool IsFading() const { return this->Fades; }

private:
  struct BrickNodes;
  template <typename Visit>
  void Collect(const BrickGrid& grid, const Mesh& mesh, Visit&& visit);
  /// Appends the points of the next brick, which must be in ascending order.
  void Append(const BrickNodes& brickNodes);
  /// Returns the number of nodes that are new to the brick.
  std::size_t AddPoints(const ChangesOfBrick& brick, const std::vector<TetrahedronChange>& changes);

  // A range of consecutive points. Lattices have long ranges.
  struct Range
  {
    std::int32_t Begin;
    std::int32_t End;
  };

  std::vector<std::size_t> Begins; // for each brick, index of its first range in Ranges
  std::vector<std::size_t> Ends;   // for each brick, one past the index of its last range
  std::vector<Range> Ranges;
  std::vector<double> NegativeWeightSum;
  std::vector<std::vector<std::int32_t>> Added; // points of each brick, not sorted; may be empty
  std::size_t NumberOfAdded = 0;
  // For a field: the box of points of each brick.
  std::vector<Extent> Boxes;
  bool Fades = false;
  std::array<std::int64_t, 3> FieldSize{ { 0, 0, 0 } };
};

} // namespace deformvolume

#endif
