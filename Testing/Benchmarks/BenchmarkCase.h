// SPDX-License-Identifier: BSD-3-Clause
#ifndef BenchmarkCase_h
#define BenchmarkCase_h

#include <vtkDeformVolumeFilter.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>

#include <array>

class vtkImageData;

/// The sizes that the demands on speed and memory are stated for.
inline constexpr std::array<int, 3> BenchmarkVolume{ { 189, 305, 229 } };
inline constexpr std::array<int, 3> HeadVolume{ { 301, 370, 316 } };
inline constexpr int CoarseNodes = 13; // on each axis: 2,197 nodes
inline constexpr int FineNodes = 80;   // on each axis: 512,000 nodes

enum class Pose
{
  /// A smooth displacement of up to 12 voxels.
  NearIdentity,
  /// Turned by 7 degrees round each axis, and scaled by 1.03.
  General
};

/// A synthetic volume of unsigned shorts with a lattice over it, and the filter that deforms it.
class BenchmarkCase
{
public:
  BenchmarkCase(const std::array<int, 3>& dimensions, int nodesPerAxis);

  /// Moves the nodes to a pose. phase: a small change that makes the poses differ.
  void Move(Pose pose, double phase);

  /// Brings the filter up to date. Returns its mapping and resampling time, in seconds. Throws
  /// where the filter fails.
  double Update();

  vtkDeformVolumeFilter* GetFilter() { return this->Filter; }
  double GetNumberOfVoxels() const;

private:
  std::array<int, 3> Dimensions;
  vtkNew<vtkDeformVolumeFilter> Filter;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  vtkNew<vtkDoubleArray> Displacements;
};

#endif
