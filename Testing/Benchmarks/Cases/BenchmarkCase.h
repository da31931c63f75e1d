// SPDX-License-Identifier: BSD-3-Clause
#ifndef BenchmarkCase_h
#define BenchmarkCase_h

#include "Pose.h"

#include <vtkDeformVolumeFilter.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkType.h>

#include <array>
#include <string>

class vtkDataArray;
class vtkDataSet;
class vtkImageData;
class vtkUnstructuredGrid;

/// The volume of most benchmarks, that of table 1.
inline constexpr std::array<int, 3> BenchmarkVolume{ { 189, 305, 229 } };
/// A volume with half as many voxels.
inline constexpr std::array<int, 3> HalfVolume{ { 150, 242, 182 } };
inline constexpr std::array<int, 3> HeadVolume{ { 301, 370, 316 } };
inline constexpr int CoarseNodes = 13; // nodes on each axis, 2,197 in all
inline constexpr int FineNodes = 80;   // nodes on each axis, 512,000 in all
/// Stands for a displacement field with a vector for each voxel, instead of a number of nodes.
inline constexpr int DenseField = 0;

/// The grid that the filter gets when nodes have moved.
enum class Grid
{
  /// The same grid, with other displacements.
  Same,
  /// Another grid with the same arrays, as from filters that pass a mesh on.
  SharingArrays
};

/// Returns a synthetic volume with waves along each axis. type: VTK_UNSIGNED_SHORT or
/// VTK_UNSIGNED_CHAR.
vtkSmartPointer<vtkImageData> MakeVolume(
  const std::array<int, 3>& dimensions, int type = VTK_UNSIGNED_SHORT);

/// Wall-clock seconds of one update, and the times of its parts that the filter reports.
struct UpdateTimes
{
  double Update = 0.0;
  double Mapping = 0.0;
  double Resampling = 0.0;
  double Transfer = 0.0;
  double Preprocessing = 0.0;

  double GetKernels() const { return this->Mapping + this->Resampling; }
};

/// A volume with a lattice or a displacement field over it, and the filter that deforms it.
class BenchmarkCase
{
public:
  /// nodesPerAxis: nodes of a lattice of tetrahedra on each axis, or DenseField.
  BenchmarkCase(
    vtkImageData* volume, int nodesPerAxis, int resampler = vtkDeformVolumeFilter::EXACT);
  ~BenchmarkCase();

  /// Replaces the displacements by deformed positions, and another grid with equal cells for the
  /// mesh at rest.
  void ConnectRest();

  /// Moves the nodes to the next step of a pose. This is not measured.
  void Move(Pose pose, Grid grid = Grid::Same);

  /// Updates the filter. Throws the filter's error if it fails.
  UpdateTimes Update();

  vtkDeformVolumeFilter* GetFilter() { return this->Filter; }
  int GetStep() const { return this->Step; }
  vtkIdType GetNumberOfVoxels() const;
  /// Returns the number of tetrahedra of the deformation mesh; 0 with a displacement field.
  vtkIdType GetNumberOfTetrahedra() const;

private:
  std::array<int, 3> Dimensions;
  vtkNew<vtkDeformVolumeFilter> Filter;
  /// The lattice or the displacement field.
  vtkSmartPointer<vtkDataSet> Deformation;
  vtkSmartPointer<vtkDataArray> Displacements;
  /// The mesh at rest. Null with displacements.
  vtkSmartPointer<vtkUnstructuredGrid> Rest;
  int Step = 0;
  /// Error messages of the filter.
  std::string Error;
};

#endif
