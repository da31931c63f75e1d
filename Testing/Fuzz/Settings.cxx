// SPDX-License-Identifier: BSD-3-Clause
#include "Settings.h"

#include <vtkDataObject.h>
#include <vtkDataSetAttributes.h>

#include <algorithm>
#include <limits>

namespace fuzz
{

namespace
{

// Returns a box in world coordinates, which is not too large, or rarely one that is an error.
std::array<double, 6> MakeBounds(vtkImageData* volume, Random& random)
{
  std::array<double, 6> bounds{ { 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 } };
  volume->GetBounds(bounds.data());
  for (int axis = 0; axis < 3; ++axis)
  {
    const double size = bounds[2 * axis + 1] - bounds[2 * axis];
    bounds[2 * axis] += size * random.Real(-0.4, 0.4);
    bounds[2 * axis + 1] += size * random.Real(-0.4, 0.4);
  }
  if (random.Chance(0.05))
  {
    bounds[0] = random.Pick({ 1e300, 1e7, std::numeric_limits<double>::quiet_NaN() });
  }
  return bounds;
}

void EditOutput(Settings& settings, vtkImageData* volume, Random& random, Geometry geometry)
{
  switch (random.Int(0, 3))
  {
    case 0:
      settings.OutputBoundsMode = random.Int(0, 2);
      settings.CustomBounds = MakeBounds(volume, random);
      break;
    case 1:
      settings.Padding = random.Int(0, 3);
      break;
    case 2:
      settings.OutputSpacingMode = random.Int(0, 1);
      for (int axis = 0; axis < 3; ++axis)
      {
        const double factor =
          geometry == Geometry::Exact ? random.Pick({ 0.5, 1.0, 2.0 }) : random.Real(0.4, 2.5);
        settings.CustomSpacing[axis] = std::abs(volume->GetSpacing()[axis]) * factor;
      }
      if (random.Chance(0.03))
      {
        settings.CustomSpacing[1] = random.Pick({ 0.0, -1.0, 1e-9 });
      }
      break;
    default:
      settings.BackgroundValue = random.Pick({ 0.0, -1.0, 77.0, 1e10,
        std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity() });
  }
}

void EditMethod(Settings& settings, Random& random)
{
  switch (random.Int(0, 12))
  {
    case 0:
      settings.OutsideMode = random.Int(0, 2);
      settings.FadeDistance = random.Pick({ 0.0, 1.0, 3.0, 10.0 });
      break;
    case 1:
      settings.Resampler = random.Pick({ 0, 0, 2, 3, 3 });
      break;
    case 2:
      settings.Interpolation = random.Pick({ 0, 0, 0, 1, 2 });
      break;
    case 3:
    case 4:
      settings.Incremental = random.Chance(0.7);
      break;
    case 5:
    case 9:
      settings.SamplingFactor = random.Pick({ 1, 2, 4 });
      break;
    case 6:
      settings.OpenSplits = random.Chance(0.5);
      break;
    case 7:
      settings.FieldIsInverse = random.Chance(0.4);
      break;
    case 8:
      settings.CategoricalArrays = random.Chance(0.8) ? std::set<std::string>{ "label" }
                                                      : std::set<std::string>{ "value", "absent" };
      break;
    case 10:
      settings.HasExtraArrays = random.Chance(0.7);
      settings.HasDensity = settings.HasExtraArrays && random.Chance(0.5);
      break;
    default:
      settings.DisplacementScale = random.Chance(0.03)
        ? random.Pick({ 1e12, std::numeric_limits<double>::quiet_NaN() })
        : random.Pick({ 1.0, 1.0, 0.5, 0.0, -1.0, 1.5 });
  }
}

void EditResources(Settings& settings, Random& random)
{
  switch (random.Int(0, 2))
  {
    case 0:
      settings.Device =
        random.Chance(0.1) ? "a device that nobody has" : random.Pick({ "", "cpu" });
      break;
    case 1:
      settings.MemoryLimit =
        random.Chance(0.3) ? random.Pick({ vtkTypeInt64(1000), vtkTypeInt64(300000) }) : 0;
      break;
    default:
      settings.Displacements = random.Chance(0.1) ? "absent" : random.Pick({ "", "U" });
  }
}

} // namespace

void EditSettings(
  Settings& settings, vtkImageData* volume, Random& random, Geometry geometry, std::ostream& log)
{
  switch (random.Int(0, 3))
  {
    case 0:
      EditOutput(settings, volume, random, geometry);
      break;
    case 1:
    case 2:
      EditMethod(settings, random);
      break;
    default:
      EditResources(settings, random);
  }
  const Settings& s = settings;
  log << "settings: scale " << s.DisplacementScale << " bounds mode " << s.OutputBoundsMode << " (";
  for (const double bound : s.CustomBounds)
  {
    log << bound << ' ';
  }
  log << ") padding " << s.Padding << " spacing mode " << s.OutputSpacingMode << " ("
      << s.CustomSpacing[0] << ' ' << s.CustomSpacing[1] << ' ' << s.CustomSpacing[2]
      << ") background " << s.BackgroundValue << " outside " << s.OutsideMode << " fading "
      << s.FadeDistance << " resampler " << s.Resampler << " interpolation " << s.Interpolation
      << " incremental " << s.Incremental << " factor " << s.SamplingFactor << " open splits "
      << s.OpenSplits << " inverse " << s.FieldIsInverse << " deformed points "
      << s.PointsAreDeformed << " device \"" << s.Device << "\" memory " << s.MemoryLimit
      << " displacements \"" << s.Displacements << "\" categorical "
      << *s.CategoricalArrays.rbegin() << " extra arrays " << s.HasExtraArrays << " density "
      << s.HasDensity << '\n';
}

void Apply(const Settings& settings, vtkDeformVolumeFilter* filter)
{
  filter->SetDisplacementScale(settings.DisplacementScale);
  filter->SetOutputBoundsMode(settings.OutputBoundsMode);
  filter->SetCustomBounds(settings.CustomBounds.data());
  filter->SetPadding(settings.Padding);
  filter->SetOutputSpacingMode(settings.OutputSpacingMode);
  filter->SetCustomSpacing(settings.CustomSpacing.data());
  filter->SetBackgroundValue(settings.BackgroundValue);
  filter->SetOutsideMode(settings.OutsideMode);
  filter->SetFadeDistance(settings.FadeDistance);
  for (int i = filter->GetNumberOfCategoricalArrays() - 1; i >= 0; --i)
  {
    const std::string name = filter->GetCategoricalArray(i);
    if (settings.CategoricalArrays.count(name) == 0)
    {
      filter->RemoveCategoricalArray(name.c_str());
    }
  }
  for (const std::string& name : settings.CategoricalArrays)
  {
    filter->AddCategoricalArray(name.c_str());
  }
  filter->SetGenerateRestPositions(settings.HasExtraArrays);
  filter->SetGenerateJacobian(settings.HasExtraArrays);
  filter->SetGenerateFoldCount(settings.HasDensity); // with either, the whole output is updated
  if (settings.HasDensity)
  {
    filter->AddDensityArray("value");
  }
  else
  {
    filter->ClearDensityArrays();
  }
  filter->SetResampler(settings.Resampler);
  filter->SetInterpolation(settings.Interpolation);
  filter->SetIncremental(settings.Incremental);
  filter->SetSamplingFactor(settings.SamplingFactor);
  filter->SetOpenSplits(settings.OpenSplits);
  filter->SetFieldIsInverse(settings.FieldIsInverse);
  filter->SetPointsAreDeformed(settings.PointsAreDeformed);
  filter->SetDevice(settings.Device);
  filter->SetMemoryLimit(settings.MemoryLimit);
  filter->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, settings.Displacements.c_str());
}

bool IsCategorical(const Settings& settings, const std::string& name)
{
  return settings.CategoricalArrays.count(name) > 0 ||
    settings.Interpolation == vtkDeformVolumeFilter::NEAREST_INTERPOLATION;
}

} // namespace fuzz
