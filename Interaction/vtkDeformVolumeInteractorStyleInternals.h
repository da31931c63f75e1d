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
  vtkSmartPointer<vtkImageData> ShownImage;
  std::vector<deformvolume::SlicePlane> Planes;
  deformvolume::StyleOverlay Overlay;
  int TimerId = -1;
  bool IsChanged = true; // since the last frame
  bool WasBusy = false;
  int WantedModel = -1; // chosen, but not yet used by the session; -1: none

  // The tool while the button is pressed.
  bool IsPressed = false;
  int Handle = -1;                       // the handle that is dragged; -1: none
  glm::dvec3 GrabbedPosition{ 0.0 };     // position of this handle
  std::array<int, 2> Cursor{ { 0, 0 } }; // last position of the cursor, in pixels
  std::vector<std::array<int, 2>> Stroke;
  vtkSmartPointer<vtkImageData> CarvedImage; // the output before the stroke
  glm::dvec3 CarvePosition{ 0.0 };           // last position of the sphere

  std::vector<glm::dvec3> MeasuredPositions;
  std::vector<glm::dvec3> Sphere; // center of the sphere under the cursor, or empty

  int GetModel() const
  {
    return this->WantedModel >= 0 ? this->WantedModel : this->Session->GetModel();
  }

  /// Numbers and positions of all handles of the session.
  std::vector<std::pair<int, glm::dvec3>> GetHandles() const;
  /// Resets the state of the tool after the button was released.
  void EndPress();
  /// Releases the handle that is dragged, and forgets an unfinished stroke.
  void CancelPress();

  /// Returns the visible voxel on a line of sight, by the PickMode of a style; -1 if there is none.
  vtkIdType FindVoxel(const vtkDeformVolumeInteractorStyle* style, vtkImageData* image,
    const deformvolume::LineOfSight& line) const;
};

#endif
