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

/// The sizes that the demands on speed and memory are stated for.
inline constexpr std::array<int, 3> BenchmarkVolume{ { 189, 305, 229 } };
/// Half as many voxels.
inline constexpr std::array<int, 3> HalfVolume{ { 150, 242, 182 } };
inline constexpr std::array<int, 3> HeadVolume{ { 301, 370, 316 } };
inline constexpr int CoarseNodes = 13; // on each axis: 2,197 nodes
inline constexpr int FineNodes = 80;   // on each axis: 512,000 nodes
/// Instead of nodes: a displacement field with a vector for each voxel.
inline constexpr int DenseField = 0;

/// What the filter gets when nodes have moved.
enum class Grid
{
  /// The grid that it has, with other displacements.
  Same,
  /// Another grid with the same arrays, as filters give it that pass a mesh on.
  SharingArrays
};

/// A synthetic volume, waves along each axis. type: VTK_UNSIGNED_SHORT or VTK_UNSIGNED_CHAR.
vtkSmartPointer<vtkImageData> MakeVolume(
  const std::array<int, 3>& dimensions, int type = VTK_UNSIGNED_SHORT);

/// Wall-clock seconds of one update, as a whole, and what of them the filter reports.
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
  /// nodesPerAxis: of a lattice of tetrahedra, or DenseField.
  BenchmarkCase(
    vtkImageData* volume, int nodesPerAxis, int resampler = vtkDeformVolumeFilter::EXACT);
  ~BenchmarkCase();

  /// Instead of displacements: deformed positions, and another grid with equal cells for the rest
  /// configuration.
  void ConnectRest();

  /// Moves the nodes to the next step of a pose. Not part of what is measured.
  void Move(Pose pose, Grid grid = Grid::Same);

  /// Brings the filter up to date. Throws the filter's error where it fails.
  UpdateTimes Update();

  vtkDeformVolumeFilter* GetFilter() { return this->Filter; }
  int GetStep() const { return this->Step; }
  vtkIdType GetNumberOfVoxels() const;
  /// Of the deformation mesh; 0 with a displacement field.
  vtkIdType GetNumberOfTetrahedra() const;

private:
  std::array<int, 3> Dimensions;
  vtkNew<vtkDeformVolumeFilter> Filter;
  /// The lattice or the displacement field.
  vtkSmartPointer<vtkDataSet> Deformation;
  vtkSmartPointer<vtkDataArray> Displacements;
  /// Null where there are displacements.
  vtkSmartPointer<vtkUnstructuredGrid> Rest;
  int Step = 0;
  /// Error messages of the filter.
  std::string Error;
};

#endif
