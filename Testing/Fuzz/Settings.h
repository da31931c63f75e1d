// SPDX-License-Identifier: BSD-3-Clause
// All properties of vtkDeformVolumeFilter in one structure.
#ifndef Fuzz_Settings_h
#define Fuzz_Settings_h

#include "Random.h"
#include "RandomVolume.h"

#include "vtkDeformVolumeFilter.h"

#include <array>
#include <ostream>
#include <set>
#include <string>

namespace fuzz
{

struct Settings
{
  double DisplacementScale = 1.0;
  int OutputBoundsMode = vtkDeformVolumeFilter::DEFORMED_BOUNDS;
  std::array<double, 6> CustomBounds{ { -1.0, 1.0, -1.0, 1.0, -1.0, 1.0 } };
  int Padding = 0;
  int OutputSpacingMode = vtkDeformVolumeFilter::VOLUME_SPACING;
  std::array<double, 3> CustomSpacing{ { 1.0, 1.0, 1.0 } };
  double BackgroundValue = 0.0;
  int OutsideMode = vtkDeformVolumeFilter::DISCARD;
  double FadeDistance = 0.0;
  std::set<std::string> CategoricalArrays{ "label" };
  /// Rest positions, Jacobians and fold counts.
  bool HasExtraArrays = false;
  /// Whether the array "value" is a density.
  bool HasDensity = false;
  int Resampler = vtkDeformVolumeFilter::AUTOMATIC;
  int Interpolation = vtkDeformVolumeFilter::LINEAR_INTERPOLATION;
  bool Incremental = true;
  int SamplingFactor = 1;
  bool OpenSplits = false;
  bool FieldIsInverse = false;
  bool PointsAreDeformed = false;
  std::string Device;
  vtkTypeInt64 MemoryLimit = 0;
  /// The name of the array of displacements. With "" no array is set, and the filter chooses one.
  std::string Displacements;
};

/// Changes one property, or a few related ones.
void EditSettings(
  Settings& settings, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log);

void Apply(const Settings& settings, vtkDeformVolumeFilter* filter);

/// Whether the values of an array are not interpolated.
bool IsCategorical(const Settings& settings, const std::string& name);

} // namespace fuzz

#endif
