// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePartialUpdate_h
#define DeformVolumePartialUpdate_h

#include "Extent.h"

#include <vector>

namespace deformvolume
{

/// Base of data of a volume on the device of which an update computes only a part: the data around
/// vertices and cells that have changed. Boxes have local indices.
class PartialUpdate
{
public:
  /// Makes the next update compute all data.
  void Invalidate()
  {
    this->Current = false;
    this->Known = false;
  }

  ///@{
  /// Reports changed vertices or cells.
  void ChangeVertices(const std::vector<Extent>& boxes) { this->Add(this->Vertices, boxes); }
  void ChangeCells(const std::vector<Extent>& boxes) { this->Add(this->Cells, boxes); }
  ///@}

  /// Reports the same changes to other data.
  void Report(PartialUpdate& other) const
  {
    if (!this->Known)
    {
      other.Invalidate();
    }
    other.ChangeVertices(this->Vertices);
    other.ChangeCells(this->Cells);
  }

  /// Whether the data are up to date.
  bool IsCurrent() const { return this->Current; }

  /// Call this after the data of all chunks have been updated.
  void Finish()
  {
    this->Current = true;
    this->Known = true;
    this->Vertices.clear();
    this->Cells.clear();
  }

protected:
  // Whether the data have been computed. Since then, only these vertices and cells have changed.
  bool Known = false;
  std::vector<Extent> Vertices;
  std::vector<Extent> Cells;

private:
  void Add(std::vector<Extent>& all, const std::vector<Extent>& boxes)
  {
    all.insert(all.end(), boxes.begin(), boxes.end());
    this->Current = this->Current && boxes.empty();
  }

  bool Current = false;
};

} // namespace deformvolume

#endif
