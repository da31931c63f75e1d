// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshStamp_h
#define DeformVolumeMeshStamp_h

#include "DeformationMesh.h"

#include <vector>

namespace deformvolume
{

/// What the cells of a grid are besides their connectivity: arrays with modification times and
/// sizes.
Stamp GetCellFormStamp(vtkUnstructuredGrid* grid);

/// The arrays of the cells of a mesh: their places, modification times and sizes.
Stamp GetCellArraysStamp(const MeshParts& parts);

/// What the cells or the points of a mesh are known by without a look at them: their arrays, with
/// modification times and sizes. Another grid with the same arrays has the same cells: that is what
/// filters give that pass them on, as a new grid or in the one that is their output. Where a grid
/// that no filter makes was modified, its owner may have written to its arrays, and stamps differ.
class MeshStamp
{
public:
  MeshStamp() = default; // of nothing
  /// made: whether the mesh is what a filter makes, and not data that somebody holds.
  static MeshStamp OfCells(const MeshParts& parts, bool made);
  static MeshStamp OfPoints(const MeshParts& parts, bool made);

  /// Whether a mesh is as it was, for certain, when the other stamp was taken.
  bool IsThatOf(const MeshStamp& last) const;
  /// Whether both are of the same arrays.
  bool HasArraysOf(const MeshStamp& other) const { return this->Arrays == other.Arrays; }

private:
  struct Grid
  {
    const void* Object;
    vtkMTimeType Modified; // 0 where it does not matter
  };

  void Add(vtkUnstructuredGrid* grid, bool made);

  Stamp Arrays;
  std::vector<Grid> Grids;
};

} // namespace deformvolume

#endif
