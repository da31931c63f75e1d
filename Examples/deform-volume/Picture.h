// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumePicture_h
#define DeformVolumePicture_h

#include "Volume.h"

#include <vtkSmartPointer.h>

#include <array>
#include <string>

class Messages;
class vtkRenderWindow;
class vtkRenderer;
class vtkVolumeProperty;
class vtkWindowToImageFilter;

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

/// 1400 by 700 pixels: a volume before a deformation on the left and after it on the right, volume
/// rendered with gradient shading, with the same camera and colours.
class Picture
{
public:
  Picture(vtkImageData* before, const PictureOptions& options);

  enum class Aim
  {
    Tight, // all that both show is seen, as near as possible
    Fixed  // the view stays, with room round the volume before
  };
  /// Draws both. The image lives until the next call.
  vtkImageData* Draw(vtkImageData* after, Aim aim, Messages& messages);

private:
  PictureOptions Options;
  vtkSmartPointer<vtkImageData> Before;
  vtkSmartPointer<vtkVolumeProperty> Property;
  vtkSmartPointer<vtkRenderer> Left;
  vtkSmartPointer<vtkRenderer> Right;
  vtkSmartPointer<vtkRenderWindow> Window;
  vtkSmartPointer<vtkWindowToImageFilter> Grab;
};

/// Writes an image to a PNG file.
void WritePNG(vtkImageData* image, const std::string& path, Messages& messages);

#endif
