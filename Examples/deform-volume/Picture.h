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
  /// Approximate minimum of the values that are shown.
  double Threshold = 0.0;
  /// Direction from the volume to the viewer, in world coordinates.
  std::array<double, 3> View{ { 0.0, 1.0, 0.0 } };
};

/// A threshold that shows the skin in most images of a body: the minimum plus a fifth of the range
/// of values.
double FindThreshold(vtkImageData* image);

/// Direction from a head to a viewer in front of it and slightly to its side. Unknown axes are
/// taken as right, anterior, superior.
std::array<double, 3> GetFaceView(WorldAxes axes);

/// Throws a Failure if there is no X display, without which VTK would exit the program.
void CheckDisplay();

/// A picture of 1400 x 700 pixels: a volume before a deformation on the left, and after it on the
/// right, with the same camera and colors. Volume rendering with gradient shading.
class Picture
{
public:
  Picture(vtkImageData* before, const PictureOptions& options);

  enum class Aim
  {
    Tight, // as close as possible to all visible voxels of both volumes
    Fixed  // the camera of the first call, with a margin around the undeformed volume
  };
  /// Draws both volumes. The returned image is valid until the next call.
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
