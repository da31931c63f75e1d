// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePush_h
#define DeformVolumePush_h

#include <array>
#include <vector>

class vtkUnstructuredGrid;

/// A smooth local displacement: a node at the distance r from Center moves by
/// (1 - (r / Radius)^2)^2 times Displacement if r < Radius, otherwise not at all. World units.
struct Push
{
  std::array<double, 3> Center{ { 0.0, 0.0, 0.0 } };
  std::array<double, 3> Displacement{ { 0.0, 0.0, 0.0 } };
  double Radius = 1.0;

  /// Whether space folds over, because the push is too strong for its radius: Displacement is at
  /// least as long as Radius divided by the steepest slope of the profile.
  bool Folds() const;

  /// The maximum edge length of tetrahedra with which the displaced volume looks smooth.
  double GetEdgeLength() const { return this->Radius / 6.0; }
};

/// Name of the point array that ApplyPushes adds.
inline constexpr const char* PushArrayName = "Displacement";

/// Adds the sum of the pushes to the mesh, as a vector point array. Returns the number of nodes
/// that move.
long long ApplyPushes(const std::vector<Push>& pushes, vtkUnstructuredGrid* mesh);

/// The length of the longest edge of the mesh with at least one end within the radius of a push; 0
/// if there is no such edge.
double GetLongestEdge(const Push& push, vtkUnstructuredGrid* mesh);

#endif
