// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMeshStamp_h
#define DeformVolumeMeshStamp_h

#include "DeformationMesh.h"

#include <array>
#include <vector>

class vtkAbstractArray;
class vtkDataSet;

namespace deformvolume
{

/// The arrays that mark cells as SkippedCells; null for those that do not exist.
std::array<vtkAbstractArray*, 3> FindMasks(vtkDataSet* grid);
/// Adds these arrays to a stamp.
void AddMasks(Stamp& stamp, vtkDataSet* grid);

/// Stamp of all arrays of the cells of a mesh: arrays, modification times and sizes.
Stamp GetCellArraysStamp(const MeshParts& parts);

/// Identifies the cells or the points of a mesh without reading them: by their arrays, with
/// modification times and sizes. Of filters, another grid with the same arrays has the same cells:
/// filters that pass their input on make such grids. If a grid that no filter has made is modified,
/// or is new, its owner may have written to its arrays, and the stamps differ.
class MeshStamp
{
public:
  MeshStamp() = default; // equals no other stamp
  /// made: whether a filter has made the mesh. False for data that were set directly.
  static MeshStamp OfCells(const MeshParts& parts, bool made);
  static MeshStamp OfPoints(const MeshParts& parts, bool made);

  /// Whether the mesh has certainly not changed since the other stamp was taken.
  bool IsThatOf(const MeshStamp& last) const;
  /// Whether both stamps have the same arrays.
  bool HasArraysOf(const MeshStamp& other) const { return this->Arrays == other.Arrays; }

private:
  void Add(vtkUnstructuredGrid* grid, bool made);

  Stamp Arrays;
  std::vector<vtkMTimeType> Times; // of the grids; 0: not compared
};

} // namespace deformvolume

#endif
