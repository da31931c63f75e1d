// SPDX-License-Identifier: BSD-3-Clause
#include "StyleOverlay.h"

#include "vtkActor2D.h"
#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkCoordinate.h"
#include "vtkInteractorObserver.h"
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
  // Project marks before each frame, because the camera may have moved.
  this->Observer->SetClientData(this);
  this->Observer->SetCallback([](vtkObject*, unsigned long, void* overlay, void*)
    { static_cast<StyleOverlay*>(overlay)->PutMarks(); });
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(this->Drawn);
  mapper->SetScalarModeToUseCellData();
  this->MarkActor->SetMapper(mapper);
  this->MarkActor->GetProperty()->SetPointSize(9.0F);
  this->MarkActor->GetProperty()->SetLineWidth(2.0F);
  this->PutMarks();
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
  if (this->Renderer)
  {
    this->Renderer->RemoveObserver(this->ObserverTag);
  }
  this->Renderer = renderer;
  if (renderer)
  {
    this->ObserverTag = renderer->AddObserver(vtkCommand::StartEvent, this->Observer);
  }
}

void StyleOverlay::ClearMarks()
{
  this->Marks.clear();
}

void StyleOverlay::AddPoint(const glm::dvec3& position, const Color& color)
{
  this->Marks.push_back({ { position }, color });
}

void StyleOverlay::AddLine(const std::vector<glm::dvec3>& positions, const Color& color)
{
  if (positions.size() > 1)
  {
    this->Marks.push_back({ positions, color });
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

void StyleOverlay::PutMarks()
{
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> vertices;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  const auto put = [&](const Mark& mark, vtkCellArray* cells)
  {
    cells->InsertNextCell(static_cast<int>(mark.Positions.size()));
    const int* origin = this->Renderer->GetOrigin();
    for (const glm::dvec3& position : mark.Positions)
    {
      double at[3];
      vtkInteractorObserver::ComputeWorldToDisplay(
        this->Renderer, position.x, position.y, position.z, at);
      cells->InsertCellPoint(points->InsertNextPoint(at[0] - origin[0], at[1] - origin[1], 0.0));
    }
    colors->InsertNextTypedTuple(mark.Paint.data());
  };
  if (this->Renderer)
  {
    // Cell data are in VTK's order of cells: vertices before lines.
    for (const Mark& mark : this->Marks)
    {
      if (mark.Positions.size() == 1)
      {
        put(mark, vertices);
      }
    }
    for (const Mark& mark : this->Marks)
    {
      if (mark.Positions.size() > 1)
      {
        put(mark, lines);
      }
    }
  }
  this->Drawn->Initialize();
  this->Drawn->SetPoints(points);
  this->Drawn->SetVerts(vertices);
  this->Drawn->SetLines(lines);
  this->Drawn->GetCellData()->SetScalars(colors);
}

} // namespace deformvolume
