// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveTransfer_h
#define DeformInteractiveTransfer_h

#include <string>
#include <vector>

class vtkImageData;
class vtkVolumeProperty;

/// Histogram of the values of the voxels: 256 bins from the minimum to the maximum.
struct Histogram
{
  explicit Histogram(vtkImageData* image);

  /// The value at the lower bound of a bin, or at a fraction of it.
  double GetValue(double bin) const;
  /// The value that best divides the voxels into two classes, by the method of Otsu.
  double FindThreshold() const;
  /// Percentile of the values that are at least `least`. part: 0 to 1.
  double FindPercentile(double least, double part) const;

  double Range[2] = { 0.0, 1.0 };
  std::vector<double> Counts;
};

/// Opacities and colors of values. The opacity rises from 0 at Level - Width / 2 to Most at Level +
/// Width / 2.
struct Transfer
{
  enum Preset
  {
    AUTOMATIC, // a surface at the threshold of the histogram
    CT_BONE,
    CT_SOFT_TISSUE,
    MR, // translucent: the inside is visible, too
    NUMBER_OF_PRESETS
  };

  Transfer() = default;
  Transfer(Preset preset, const Histogram& histogram);

  std::string GetName() const;
  void Apply(vtkVolumeProperty* property, const double range[2]) const;

  Preset Chosen = AUTOMATIC;
  double Level = 0.5;
  double Width = 0.5;
  double Most = 1.0; // maximum opacity
};

#endif
