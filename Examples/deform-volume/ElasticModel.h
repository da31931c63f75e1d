// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElasticModel_h
#define DeformVolumeElasticModel_h

#include "FrameTaker.h"

#include <array>
#include <optional>
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

/// The material of the voxels with values from Minimum on, less than Maximum.
struct MaterialOfValues
{
  double Minimum = 0.0;
  double Maximum = 0.0;
  double YoungModulus = 0.0;
  std::optional<double> PoissonRatio; // without them those of the options
  std::optional<double> Density;
};

/// Deforms a mesh by the pulls, fixations and gravity of the options: to equilibrium by finite
/// elements, or for some time by springs. The sheets of the options cut it first, at rest.
/// takeFrame is called for each frame with the deformation that it has led to.
void DeformByElasticModel(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  Messages& messages, Deformation& deformation, const FrameTaker& takeFrame);

#endif
