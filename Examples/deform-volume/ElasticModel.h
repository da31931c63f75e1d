// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElasticModel_h
#define DeformVolumeElasticModel_h

#include <array>
#include <string>

class Messages;
class vtkUnstructuredGrid;
struct Deformation;
struct Options;
struct Volume;

/// Which nodes stay where they are.
struct Fixation
{
  enum class Kind
  {
    Box,   // those within Bounds: x min, x max, y min, y max, z min, z max
    Below, // those with a z of at most Value
    Label  // those whose nearest voxel has the value Value
  };
  Kind Which = Kind::Box;
  std::array<double, 6> Bounds{};
  double Value = 0.0;
  std::string Text; // as it was given
};

/// Deforms a mesh by the pulls, fixations and gravity of the options: to equilibrium by finite
/// elements, or for some time by springs.
void DeformByElasticModel(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  Messages& messages, Deformation& deformation);

#endif
