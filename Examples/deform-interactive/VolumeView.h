// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformInteractiveVolumeView_h
#define DeformInteractiveVolumeView_h

#include "Transfer.h"

#include <vtkNew.h>

#include <array>

class vtkActor;
class vtkDeformVolumeInteractorStyle;
class vtkFlyingEdges3D;
class vtkImageData;
class vtkImageSlice;
class vtkImageSliceMapper;
class vtkOpenGLGPUVolumeRayCastMapper;
class vtkPolyDataMapper;
class vtkRenderer;
class vtkReverseSense;
class vtkVolume;

/// Shows the output of a style as a volume, as an isosurface, or on three slice planes.
class VolumeView
{
public:
  explicit VolumeView(vtkDeformVolumeInteractorStyle* style);
  ~VolumeView();
  VolumeView(const VolumeView&) = delete;
  void operator=(const VolumeView&) = delete;

  void AddTo(vtkRenderer* renderer);

  enum Display
  {
    VOLUME,
    SURFACE,
    SLICES,
    NUMBER_OF_DISPLAYS
  };
  void SetDisplay(Display display);
  Display GetDisplay() const { return this->Chosen; }

  void SetTransfer(const Transfer& transfer, const double range[2]);

  /// Shows a new output of the style. Returns the duration of the upload to the graphics device, in
  /// seconds; 0 if the upload happens only when the output is rendered.
  double Update(vtkRenderer* renderer);

  /// Renders with fewer rays and samples. Used during interaction.
  void SetCoarse(bool isCoarse);

  /// Moves the slice whose normal is closest to the view direction, by a fraction of the extent.
  void MoveSlice(vtkRenderer* renderer, double part);

private:
  void Choose();

  vtkDeformVolumeInteractorStyle* Style;
  Display Chosen = VOLUME;
  double Isovalue = 0.0;
  std::array<double, 3> SliceParts{ { 0.5, 0.5, 0.5 } }; // positions, as fractions of the extent
  bool IsDrawn = false;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> Mapper;
  vtkNew<vtkFlyingEdges3D> Surface;
  vtkNew<vtkReverseSense> ReversedSurface;
  vtkNew<vtkPolyDataMapper> SurfaceMapper;
  vtkNew<vtkActor> SurfaceActor;
  std::array<vtkNew<vtkImageSlice>, 3> Slices;
  std::array<vtkNew<vtkImageSliceMapper>, 3> SliceMappers;
};

#endif
