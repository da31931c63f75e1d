// SPDX-License-Identifier: BSD-3-Clause
#ifndef LiveCase_h
#define LiveCase_h

#include <vtkDeformVolumeFilter.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkType.h>

#include <array>
#include <vector>

class vtkDataArray;
class vtkFloatArray;
class vtkImageData;
class vtkUnsignedCharArray;
class vtkUnstructuredGrid;

/// A volume in a lattice whose nodes and connectivity change as in simulations, cuts and drags.
class LiveCase
{
public:
  /// logged: whether changes are logged (vtkArrayChanges). Otherwise the filter compares arrays.
  LiveCase(const std::array<int, 3>& dimensions, int nodesPerAxis, bool logged);
  ~LiveCase();

  /// Moves all nodes, or the nodes in a box. fractions: lengths of its edges relative to those of
  /// the volume.
  void MoveAll();
  void MoveSome(const std::array<double, 3>& fractions);
  /// Splits nodes on a plane of the lattice, another plane in each call. tetrahedra: the number of
  /// tetrahedra on one side that get new nodes. nodes: the largest number of new nodes, which move
  /// a little.
  void Split(int tetrahedra, int nodes);
  /// Changes the rest position of a node, so that the static mapping is rebuilt.
  void MoveAtRest();
  /// Switches the tetrahedra in a box off, and those in the previous box on again. cells: the size
  /// of the box.
  void ChangeMask(const std::array<int, 3>& cells);
  /// Marks the mesh as modified without a change.
  void Touch();

  /// Updates the filter, and returns the seconds. Throws if the filter fails.
  double Update();

  vtkDeformVolumeFilter* GetFilter() { return this->Filter; }

private:
  /// Logs that tuples of an array were written. Without logs, Finish() marks the array as modified.
  void Log(vtkDataArray* array, vtkIdType first, vtkIdType last);
  void Finish(vtkDataArray* array);

  std::array<int, 3> Dimensions;
  int NodesPerAxis;
  bool IsLogged;
  int Step = 0;
  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  vtkNew<vtkFloatArray> Displacements;
  vtkNew<vtkUnsignedCharArray> Active;
  vtkNew<vtkDeformVolumeFilter> Filter;
  bool HasFailed = false;
};

#endif
