// SPDX-License-Identifier: BSD-3-Clause
#include "StyleOverlay.h"

#include "vtkActor2D.h"
#include "vtkCellArray.h"
#include "vtkCoordinate.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper2D.h"
#include "vtkProperty2D.h"
#include "vtkRenderer.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"
#include "vtkTextRenderer.h"
#include "vtkUnsignedCharArray.h"

namespace
{

vtkSmartPointer<vtkTextActor> MakeText(bool isTop)
{
  auto actor = vtkSmartPointer<vtkTextActor>::New();
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->SetPosition(0.01, isTop ? 0.99 : 0.01);
  vtkTextProperty* property = actor->GetTextProperty();
  property->SetFontSize(14);
  property->SetFontFamilyToCourier();
  property->SetBold(1);
  property->SetColor(1.0, 1.0, 0.9);
  property->SetShadow(1);
  property->SetLineSpacing(1.1);
  if (isTop)
  {
    property->SetVerticalJustificationToTop();
  }
  actor->VisibilityOff();
  return actor;
}

// actor: null if there is no text renderer.
bool SetText(vtkTextActor* actor, const std::string& text)
{
  if (!actor)
  {
    return false;
  }
  const char* former = actor->GetInput();
  const bool isNew = text != (former ? former : "");
  actor->SetInput(text.c_str());
  actor->SetVisibility(text.empty() ? 0 : 1);
  return isNew;
}

} // namespace

namespace deformvolume
{

StyleOverlay::StyleOverlay()
{
  vtkNew<vtkCoordinate> world;
  world->SetCoordinateSystemToWorld();
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(this->Marks);
  mapper->SetTransformCoordinate(world); // projects the marks when the camera has moved
  mapper->TransformCoordinateUseDoubleOn();
  this->MarkActor->SetMapper(mapper);
  this->MarkActor->GetProperty()->SetPointSize(9.0F);
  this->MarkActor->GetProperty()->SetLineWidth(2.0F);
  this->ClearMarks();
}

StyleOverlay::~StyleOverlay()
{
  this->SetRenderer(nullptr);
}

void StyleOverlay::SetRenderer(vtkRenderer* renderer)
{
  if (this->Renderer == renderer)
  {
    return;
  }
  // Without VTK's module RenderingFreeType, drawing a text would end the program.
  if (!this->Status && vtkTextRenderer::GetInstance())
  {
    this->Status = MakeText(false);
    this->Help = MakeText(true);
  }
  for (vtkActor2D* actor : { this->MarkActor.Get(), static_cast<vtkActor2D*>(this->Status),
         static_cast<vtkActor2D*>(this->Help) })
  {
    if (actor && this->Renderer)
    {
      this->Renderer->RemoveViewProp(actor);
    }
    if (actor && renderer)
    {
      renderer->AddViewProp(actor);
    }
  }
  this->Renderer = renderer;
}

void StyleOverlay::ClearMarks()
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  this->Marks->Initialize();
  this->Marks->SetPoints(points);
  this->Marks->SetVerts(vtkNew<vtkCellArray>());
  this->Marks->SetLines(vtkNew<vtkCellArray>());
  this->Marks->GetPointData()->SetScalars(colors);
}

void StyleOverlay::AddMark(
  const std::vector<glm::dvec3>& positions, const Color& color, vtkCellArray* cells)
{
  auto* colors = vtkUnsignedCharArray::SafeDownCast(this->Marks->GetPointData()->GetScalars());
  cells->InsertNextCell(static_cast<int>(positions.size()));
  for (const glm::dvec3& position : positions)
  {
    cells->InsertCellPoint(this->Marks->GetPoints()->InsertNextPoint(&position.x));
    colors->InsertNextTypedTuple(color.data());
  }
  this->Marks->Modified();
}

void StyleOverlay::AddPoint(const glm::dvec3& position, const Color& color)
{
  this->AddMark({ position }, color, this->Marks->GetVerts());
}

void StyleOverlay::AddLine(const std::vector<glm::dvec3>& positions, const Color& color)
{
  if (positions.size() > 1)
  {
    this->AddMark(positions, color, this->Marks->GetLines());
  }
}

bool StyleOverlay::SetStatus(const std::string& text)
{
  return SetText(this->Status, text);
}

bool StyleOverlay::SetHelp(const std::string& text)
{
  return SetText(this->Help, text);
}

} // namespace deformvolume
