// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePicture_h
#define DeformVolumePicture_h

#include "Volume.h"

#include <array>
#include <string>

class Messages;

struct PictureOptions
{
  /// Values from about here on are shown.
  double Threshold = 0.0;
  /// Where the viewer stands as seen from the middle of the volume, in world coordinates.
  std::array<double, 3> View{ { 0.0, 1.0, 0.0 } };
};

/// A threshold that shows the skin in most images of a body: a fifth of the way from the smallest
/// to the greatest value.
double FindThreshold(vtkImageData* image);

/// The direction from which a face looks at the viewer, a little from its side, as far as the axes
/// of the world are known.
std::array<double, 3> GetFaceView(WorldAxes axes);

/// Throws a Failure where there is no display to draw on. VTK would end the program.
void CheckDisplay();

/// Writes a PNG file, 1400 by 700 pixels: the volume before the deformation on the left and after
/// it on the right, volume rendered with gradient shading, with the same camera and colours.
void WritePicture(vtkImageData* before, vtkImageData* after, const PictureOptions& options,
  const std::string& path, Messages& messages);

#endif
