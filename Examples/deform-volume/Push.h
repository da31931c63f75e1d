// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePush_h
#define DeformVolumePush_h

#include <array>
#include <vector>

class vtkUnstructuredGrid;

/// A smooth local displacement: a node at the distance r from Center moves by
/// (1 - (r / Radius)^2)^2 times Displacement, and stays where r is Radius or more. World units.
struct Push
{
  std::array<double, 3> Center{ { 0.0, 0.0, 0.0 } };
  std::array<double, 3> Displacement{ { 0.0, 0.0, 0.0 } };
  double Radius = 1.0;

  /// True where the push is so strong for its radius that the space it moves folds over: where the
  /// displacement is longer than Radius divided by the steepest slope of the profile.
  bool Folds() const;
};

/// Name of the point array that ApplyPushes adds.
inline constexpr const char* PushArrayName = "Displacement";

/// Adds the sum of the pushes to the mesh, as a vector point array. Returns the number of nodes
/// that move.
long long ApplyPushes(const std::vector<Push>& pushes, vtkUnstructuredGrid* mesh);

#endif
