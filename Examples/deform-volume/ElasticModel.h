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

/// Selects fixed nodes: an argument of --fix.
struct Fixation
{
  enum class Kind
  {
    Box,   // nodes within Bounds: x min, x max, y min, y max, z min, z max
    Below, // nodes whose z is at most Value
    Label  // the tissue of voxels with the label Value, see FixLabels() in ElasticModel.cxx
  };
  Kind Which = Kind::Box;
  std::array<double, 6> Bounds{};
  double Value = 0.0;
  std::string Text; // the argument
};

/// The material of voxels whose value is at least Minimum and less than Maximum.
struct MaterialOfValues
{
  bool IsOfLabel = false; // whether these are values of Volume::GetLabels()
  double Minimum = 0.0;
  double Maximum = 0.0;
  double YoungModulus = 0.0;
  std::optional<double> PoissonRatio; // if empty: Options::PoissonRatio
  std::optional<double> Density;      // if empty: Options::Density
};

/// Deforms a mesh by --pull, --fix and --gravity: finite elements compute the equilibrium,
/// mass-spring dynamics simulate --duration. The sheets of --cut cut the mesh at rest before that.
/// Calls takeFrame with the deformation of each frame. Throws a Failure if no equilibrium is found.
void DeformByElasticModel(const Options& options, const Volume& volume, vtkUnstructuredGrid* mesh,
  Messages& messages, Deformation& deformation, const FrameTaker& takeFrame);

#endif
