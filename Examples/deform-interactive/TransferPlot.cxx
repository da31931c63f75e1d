// SPDX-License-Identifier: BSD-3-Clause
#include "TransferPlot.h"

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

TransferPlot::TransferPlot()
{
  vtkNew<vtkPolyDataMapper2D> mapper;
  mapper->SetInputData(this->Lines);
  mapper->SetScalarModeToUseCellData();
  this->Actor->SetMapper(mapper);
}

TransferPlot::~TransferPlot() = default;

void TransferPlot::AddTo(vtkRenderer* renderer)
{
  renderer->AddViewProp(this->Actor);
}

void TransferPlot::SetVisible(bool isVisible)
{
  this->Actor->SetVisibility(isVisible ? 1 : 0);
}

bool TransferPlot::Contains(vtkRenderer* renderer, int x, int y) const
{
  const int left = renderer->GetSize()[0] - Width - Margin;
  return this->Actor->GetVisibility() != 0 && x >= left && x <= left + Width && y >= Bottom &&
    y <= Bottom + Height;
}

void TransferPlot::Draw(vtkRenderer* renderer, const Histogram& histogram, const Transfer& transfer)
{
  this->Actor->SetPosition(renderer->GetSize()[0] - Width - Margin, Bottom);
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  const auto addLine = [&](std::initializer_list<std::pair<double, double>> places,
                         unsigned char red, unsigned char green, unsigned char blue)
  {
    lines->InsertNextCell(static_cast<int>(places.size()));
    for (const auto& place : places)
    {
      lines->InsertCellPoint(
        points->InsertNextPoint(place.first, std::clamp<double>(place.second, 0.0, Height), 0.0));
    }
    const unsigned char color[3] = { red, green, blue };
    colors->InsertNextTypedTuple(color);
  };
  addLine({ { 0, 0 }, { Width, 0 }, { Width, Height }, { 0, Height }, { 0, 0 } }, 120, 125, 135);
  const double most =
    std::log1p(*std::max_element(histogram.Counts.begin(), histogram.Counts.end()));
  const double bins = static_cast<double>(histogram.Counts.size());
  for (std::size_t bin = 0; bin < histogram.Counts.size(); ++bin)
  {
    const double x = Width * (static_cast<double>(bin) + 0.5) / bins;
    addLine({ { x, 0 }, { x, Height * std::log1p(histogram.Counts[bin]) / std::max(most, 1.0) } },
      70, 80, 100);
  }
  const auto getX = [&](double value)
  {
    return std::clamp(
      Width * (value - histogram.Range[0]) / (histogram.Range[1] - histogram.Range[0]), 0.0,
      static_cast<double>(Width));
  };
  const double low = getX(transfer.Level - 0.5 * transfer.Width);
  const double high = getX(transfer.Level + 0.5 * transfer.Width);
  const double top = Height * transfer.Most;
  addLine({ { 0, Height * transfer.GetOpacity(histogram.Range[0]) }, { low, 0 }, { high, top },
            { Width, Height * transfer.GetOpacity(histogram.Range[1]) } },
    255, 215, 90);
  this->Lines->Initialize();
  this->Lines->SetPoints(points);
  this->Lines->SetLines(lines);
  this->Lines->GetCellData()->SetScalars(colors);
}
