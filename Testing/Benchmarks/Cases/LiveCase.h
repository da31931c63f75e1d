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

/// A volume in a lattice that changes as simulations, cuts and hands do it: where it moves, and
/// what is connected.
class LiveCase
{
public:
  /// logged: whether logs tell the filter what is written (vtkArrayChanges); else it compares.
  LiveCase(const std::array<int, 3>& dimensions, int nodesPerAxis, bool logged);
  ~LiveCase();

  /// Moves all nodes, or those in a box whose edges have these fractions of the volume's.
  void MoveAll();
  void MoveSome(const std::array<double, 3>& fractions);
  /// So many tetrahedra beside a plane of the lattice, another one each time, get at most so many
  /// nodes of their own, which move a little.
  void Split(int tetrahedra, int nodes);
  /// Changes the rest position of a node, so that the static mapping is rebuilt.
  void MoveAtRest();
  /// Switches tetrahedra off, and others on again, in a box of so many cells.
  void ChangeMask(const std::array<int, 3>& cells);
  /// Marks the mesh as modified without a change.
  void Touch();

  /// Seconds of an update. Throws where the filter fails.
  double Update();

  vtkDeformVolumeFilter* GetFilter() { return this->Filter; }

private:
  /// Tuples of an array were written. Not logged, the array is modified once all are.
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
