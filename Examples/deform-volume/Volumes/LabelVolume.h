// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeLabelVolume_h
#define DeformVolumeLabelVolume_h

#include "Volume.h"

#include <string>
#include <vector>

class Messages;
class vtkDeformVolumeFilter;
struct Options;

/// The labels of --label-volume. They are deformed as additional arrays of the volume, and then
/// separated from it.
class LabelVolume
{
public:
  /// Reads Options::LabelVolume; "": there are no labels. Throws a Failure if the labels are not
  /// integers, are not on the grid of the volume, or cannot be written in the format of an output.
  LabelVolume(const Options& options, const Volume& volume, Messages& messages);

  /// Whether there are no labels.
  bool IsEmpty() const { return this->Arrays.empty(); }

  /// The labels, or the active array of several; null if there are no labels.
  vtkDataArray* GetScalars() const;

  /// Returns a copy of the volume with the labels, which become categorical arrays of the filter;
  /// the volume itself if there are no labels.
  vtkSmartPointer<vtkImageData> AddTo(vtkImageData* volume, vtkDeformVolumeFilter* filter) const;

  /// Returns the labels of a deformed volume, and removes them from it. Labels of voxels outside
  /// the deformed volume are 0.
  vtkSmartPointer<vtkImageData> TakeFrom(vtkSmartPointer<vtkImageData>& deformed) const;

  /// Returns the labels that no voxel of a deformed volume has, such as "3, 7"; "": none.
  std::string DescribeLost(vtkImageData* deformed) const;

  /// The names and types of the arrays of labels.
  std::string Describe() const;

private:
  struct LabelArray
  {
    vtkSmartPointer<vtkDataArray> Values;
    /// Name in the file.
    std::string Name;
  };
  std::vector<LabelArray> Arrays;
  std::string ActiveName; ///< the array that becomes the scalars of TakeFrom()
};

#endif
