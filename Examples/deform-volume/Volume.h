// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolume_h
#define DeformVolumeVolume_h

#include <vtkImageData.h>
#include <vtkNIFTIImageHeader.h>
#include <vtkSmartPointer.h>

/// What the axes of the world point to, as far as the file says it.
enum class WorldAxes
{
  Unknown,
  /// x to the right, y to the front, z to the head: NIfTI.
  RightAnteriorSuperior,
  /// x to the left, y to the back, z to the head: DICOM, MetaImage, and most NRRD files.
  LeftPosteriorSuperior
};

/// An image and what vtkImageData has no room for.
struct Volume
{
  vtkSmartPointer<vtkImageData> Image;
  WorldAxes Axes = WorldAxes::Unknown;
  /// Stored value times slope plus intercept is the measured value; carried through, not applied.
  double RescaleSlope = 1.0;
  double RescaleIntercept = 0.0;
  /// False where the axes that the file gives could not be used.
  bool IsPlaced = true;
  /// Null for other formats.
  vtkSmartPointer<vtkNIFTIImageHeader> NIfTIHeader;
};

#endif
