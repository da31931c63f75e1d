// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeStyleOverlay_h
#define DeformVolumeStyleOverlay_h

#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

#include <glm/vec3.hpp>

#include <array>
#include <string>
#include <vector>

class vtkActor2D;
class vtkCallbackCommand;
class vtkPolyData;
class vtkRenderer;
class vtkTextActor;

namespace deformvolume
{

/// What a style draws over the volume: points and lines at places of the world, and texts.
class StyleOverlay
{
public:
  StyleOverlay();
  ~StyleOverlay();
  StyleOverlay(const StyleOverlay&) = delete;
  void operator=(const StyleOverlay&) = delete;

  /// Where it is drawn; null: nowhere.
  void SetRenderer(vtkRenderer* renderer);

  using Colour = std::array<unsigned char, 3>;
  ///@{
  /// They are the same until they are cleared.
  void ClearMarks();
  void AddPoint(const glm::dvec3& position, const Colour& colour);
  void AddLine(const std::vector<glm::dvec3>& positions, const Colour& colour);
  ///@}

  ///@{
  /// Once there is a renderer. At the lower and at the upper left; "" for none. Returns whether it
  /// is another one.
  bool SetStatus(const std::string& text);
  bool SetHelp(const std::string& text);
  ///@}

private:
  struct Mark
  {
    std::vector<glm::dvec3> Positions; // one for a point
    Colour Paint;
  };

  void PutMarks();

  vtkWeakPointer<vtkRenderer> Renderer;
  unsigned long ObserverTag = 0;
  vtkNew<vtkCallbackCommand> Observer;
  std::vector<Mark> Marks;
  vtkNew<vtkPolyData> Drawn;
  vtkNew<vtkActor2D> MarkActor;
  // Made with the first renderer: VTK needs its module RenderingFreeType for them.
  vtkSmartPointer<vtkTextActor> Status;
  vtkSmartPointer<vtkTextActor> Help;
};

} // namespace deformvolume

#endif
