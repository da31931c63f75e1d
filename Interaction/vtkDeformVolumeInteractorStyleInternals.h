// SPDX-License-Identifier: BSD-3-Clause
#ifndef vtkDeformVolumeInteractorStyleInternals_h
#define vtkDeformVolumeInteractorStyleInternals_h

#include "StyleOverlay.h"
#include "VisiblePositions.h"
#include "vtkDeformVolumeInteractorStyle.h"
#include "vtkDeformVolumeSession.h"

#include "vtkCallbackCommand.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkVolume.h"

#include <glm/vec3.hpp>

#include <array>
#include <utility>
#include <vector>

class vtkDeformVolumeInteractorStyle::vtkInternals
{
public:
  vtkSmartPointer<vtkDeformVolumeSession> Session;
  vtkSmartPointer<vtkVolume> Volume;
  vtkNew<vtkCallbackCommand> SessionObserver;
  vtkSmartPointer<vtkImageData> Output;
  vtkSmartPointer<vtkImageData> Shown;
  std::vector<deformvolume::SlicePlane> Planes;
  deformvolume::StyleOverlay Overlay;
  int TimerId = -1;
  bool IsChanged = true; // since it was drawn
  bool WasBusy = false;
  int WantedModel = -1; // -1: the session's

  // The tool while the button is pressed.
  bool IsPressed = false;
  int Handle = -1; // that is dragged
  glm::dvec3 Held{ 0.0 };
  std::array<int, 2> Cursor{ { 0, 0 } }; // where it was held last
  std::vector<std::array<int, 2>> Stroke;
  vtkSmartPointer<vtkImageData> CarvedImage; // as it was when the stroke began
  glm::dvec3 Carved{ 0.0 };

  std::vector<glm::dvec3> Measured;
  std::vector<glm::dvec3> Sphere; // under the cursor: none or its centre

  int GetModel() const
  {
    return this->WantedModel >= 0 ? this->WantedModel : this->Session->GetModel();
  }

  /// Numbers and places of all handles that the session has.
  std::vector<std::pair<int, glm::dvec3>> GetHandles() const;
  /// Has nothing to do with the button any more.
  void EndPress();

  /// What a style picks on a line of sight; -1 where nothing is visible.
  vtkIdType FindVoxel(const vtkDeformVolumeInteractorStyle* style, vtkImageData* image,
    const deformvolume::LineOfSight& line) const;
};

#endif
