// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveTransfer_h
#define DeformInteractiveTransfer_h

#include <string>
#include <vector>

class vtkImageData;
class vtkVolumeProperty;

/// How many voxels have which values: 256 bins between the least and the greatest value.
struct Histogram
{
  explicit Histogram(vtkImageData* image);

  double GetValue(double bin) const;
  /// The value that best divides the voxels into two classes, by the method of Otsu.
  double FindThreshold() const;
  /// The value below which there is a part of the voxels that have at least a value.
  double FindPercentile(double least, double part) const;

  double Range[2] = { 0.0, 1.0 };
  std::vector<double> Counts;
};

/// Opacity and colours of values: nothing below Level - Width / 2, all of it above Level + Width
/// / 2.
struct Transfer
{
  enum Preset
  {
    AUTOMATIC, // a surface at the threshold of the histogram
    CT_BONE,
    CT_SOFT_TISSUE,
    MR, // what is inside shines through
    NUMBER_OF_PRESETS
  };

  Transfer() = default;
  Transfer(Preset preset, const Histogram& histogram);

  std::string GetName() const;
  /// What a value absorbs in a millimetre; 0 to 1.
  double GetOpacity(double value) const;
  void Apply(vtkVolumeProperty* property, const double range[2]) const;

  Preset Chosen = AUTOMATIC;
  double Level = 0.5;
  double Width = 0.5;
  double Most = 1.0; // opacity
};

#endif
