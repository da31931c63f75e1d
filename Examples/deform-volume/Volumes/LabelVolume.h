// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLabelVolume_h
#define DeformVolumeLabelVolume_h

#include "Volume.h"

#include <string>
#include <vector>

class Messages;
class vtkDeformVolumeFilter;
struct Options;

/// Labels of the voxels of a volume, from a file of their own. They are deformed as further arrays
/// of the volume, and then taken apart again.
class LabelVolume
{
public:
  /// Reads Options::LabelVolume; without one there are no labels. Throws a Failure where the labels
  /// are not whole numbers, are not on the grid of the volume, or do not fit into an output.
  LabelVolume(const Options& options, const Volume& volume, Messages& messages);

  bool AreThere() const { return !this->Arrays.empty(); }

  /// A volume with the labels as categorical arrays of the filter; the volume itself without
  /// labels.
  vtkSmartPointer<vtkImageData> AddTo(vtkImageData* volume, vtkDeformVolumeFilter* filter) const;

  /// The labels of a deformed volume, 0 where that covers nothing. Takes them out of the image.
  vtkSmartPointer<vtkImageData> TakeFrom(vtkSmartPointer<vtkImageData>& deformed) const;

  /// Their number and type, in words.
  std::string Describe() const;

private:
  struct LabelArray
  {
    vtkSmartPointer<vtkDataArray> Values;
    /// In the file.
    std::string Name;
  };
  std::vector<LabelArray> Arrays;
  std::string Scalars;
};

#endif
