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
class vtkCellArray;
class vtkPolyData;
class vtkRenderer;
class vtkTextActor;

namespace deformvolume
{

/// Draws points and lines at world positions, and texts, over the volume.
class StyleOverlay
{
public:
  StyleOverlay();
  ~StyleOverlay();
  StyleOverlay(const StyleOverlay&) = delete;
  void operator=(const StyleOverlay&) = delete;

  /// Set the renderer; null: nothing is drawn.
  void SetRenderer(vtkRenderer* renderer);

  using Color = std::array<unsigned char, 3>;
  ///@{
  /// Marks stay until they are cleared.
  void ClearMarks();
  void AddPoint(const glm::dvec3& position, const Color& color);
  void AddLine(const std::vector<glm::dvec3>& positions, const Color& color);
  ///@}

  ///@{
  /// Set the text at the lower left (status) or at the upper left (help); "": none. Returns whether
  /// the text has changed. Call these methods after SetRenderer().
  bool SetStatus(const std::string& text);
  bool SetHelp(const std::string& text);
  ///@}

private:
  void AddMark(const std::vector<glm::dvec3>& positions, const Color& color, vtkCellArray* cells);

  vtkWeakPointer<vtkRenderer> Renderer;
  vtkNew<vtkPolyData> Marks; // at world positions
  vtkNew<vtkActor2D> MarkActor;
  // Created with the first renderer, because they need VTK's module RenderingFreeType.
  vtkSmartPointer<vtkTextActor> Status;
  vtkSmartPointer<vtkTextActor> Help;
};

} // namespace deformvolume

#endif
