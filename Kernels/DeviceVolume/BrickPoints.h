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

/// Which points of the deformation, nodes of the mesh or points of the field, move the vertices
/// that a brick depends on.
class BrickPoints
{
public:
  BrickPoints() = default;
  /// The tetrahedra of a mesh as on the device (DEFORMVOLUME_NODE_PLACES).
  struct Mesh
  {
    const Tetrahedron* Tetrahedra;
    std::size_t NumberOfTetrahedra;
    std::size_t NumberOfNodes;
    /// For each brick of the grid those that move cells at the boundary of the mesh in it; or none.
    const std::vector<std::vector<std::int32_t>>& Boundary;
  };
  /// Runs as on the device, see RunMapping.cl and RunEvaluation.cl.
  struct Runs
  {
    const VertexRun* First;
    const std::uint32_t* RowRanges;
    const double* Rest;
    const std::int32_t* Owners;
  };
  ///@{
  static BrickPoints FromLinks(const BrickGrid& grid, const VertexLink* links, const Mesh& mesh);
  static BrickPoints FromRuns(const BrickGrid& grid, const Runs& runs, const Mesh& mesh);
  ///@}
  /// boundary: for each brick of the grid a box of points of the field that move cells at the
  /// boundary of the field in it, maybe empty; or none at all.
  static BrickPoints FromField(
    const BrickGrid& grid, const FieldParameters& field, const std::vector<Extent>& boundary);
  /// Of sets of bricks: the points that any of a set has. They are for AnyOf and IsApart only.
  BrickPoints Join(const std::vector<std::vector<std::size_t>>& sets) const;

  bool IsEmpty() const { return this->Begins.empty() && this->Boxes.empty(); }

  /// Which of some changes each node had a part in, and how many nodes each change has.
  struct NodesBefore
  {
    explicit NodesBefore(const std::vector<TetrahedronChange>& changes);
    std::vector<std::pair<std::int32_t, std::uint32_t>> Users; // nodes and changes, sorted
    std::vector<int> NumbersOfNodes;                           // of each change
    PointSet Used;
  };
  /// The bricks that depend on one of some tetrahedra by the nodes that it had, of those that
  /// isNear(brick) is true for; each with its tetrahedra, by their places in the list. The bricks
  /// of other tetrahedra with the same nodes may be among them.
  using ChangesOfBrick = std::pair<std::size_t, std::vector<std::size_t>>;
  std::vector<ChangesOfBrick> FindBricks(
    const NodesBefore& nodes, const std::function<bool(std::size_t)>& isNear) const;
  /// Bricks, none of them twice, depend on the nodes that their tetrahedra have got as well from
  /// now on.
  void AddPoints(
    const std::vector<ChangesOfBrick>& bricks, const std::vector<TetrahedronChange>& changes);
  /// Whether so many were added that all are better found anew.
  bool AreOverloaded() const { return this->NumberOfAdded > this->Ranges.size() / 2 + 4096; }

  /// Whether body(begin, end) was true for one of the ranges that a brick's points are; no more are
  /// asked then.
  template <typename Body>
  bool AnyOf(std::size_t brick, Body&& body) const
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

  /// Of a field: the box of points of each brick.
  const std::vector<Extent>& GetBoxes() const { return this->Boxes; }

  /// Whether all of a brick's points lie before one, or from another one on, for certain.
  bool IsApart(std::size_t brick, std::size_t begin, std::size_t end) const
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

  /// The largest sum of the negative weights of one of the brick's vertices, as a positive number:
  /// a vertex moves by no more than the greatest displacement of its points and so many times the
  /// difference to the least.
  double GetExcess(std::size_t brick) const
  {
    return this->Excess.empty() ? 0.0 : this->Excess[brick];
  }

  /// Whether a brick may have vertices that move by less than all of its points: outside a field
  /// whose displacement fades there.
  bool IsFading() const { return this->Fades; }

private:
  struct Needs;
  template <typename Visit>
  void Collect(const BrickGrid& grid, const Mesh& mesh, Visit&& visit);
  /// Takes the points of the next brick, in ascending order.
  void Append(const Needs& needs);
  /// Returns how many nodes are new to the brick.
  std::size_t AddPoints(const ChangesOfBrick& brick, const std::vector<TetrahedronChange>& changes);

  // Points with numbers that follow each other: in meshes that are lattices they are many.
  struct Range
  {
    std::int32_t Begin;
    std::int32_t End;
  };

  std::vector<std::size_t> Begins; // the ranges of each brick, in Ranges: the first one
  std::vector<std::size_t> Ends;   // and one past the last
  std::vector<Range> Ranges;
  std::vector<double> Excess;
  std::vector<std::vector<std::int32_t>> Added; // of each brick, in no order; or none at all
  std::size_t NumberOfAdded = 0;
  // Or, of a field, a box of points for each.
  std::vector<Extent> Boxes;
  bool Fades = false;
  std::array<std::int64_t, 3> FieldSize{ { 0, 0, 0 } };
};

} // namespace deformvolume

#endif
