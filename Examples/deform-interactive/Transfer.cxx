// SPDX-License-Identifier: BSD-3-Clause
#include "Transfer.h"

#include "OtsuThreshold.h"

#include <vtkArrayDispatch.h>
#include <vtkColorTransferFunction.h>
#include <vtkDataArray.h>
#include <vtkDataArrayRange.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace
{
constexpr int NumberOfBins = 256;

struct Counting
{
  const double* Range;
  std::vector<double>& Counts;

  template <typename ArrayT>
  void operator()(ArrayT* array)
  {
    const double scale = NumberOfBins / (this->Range[1] - this->Range[0]);
    for (const auto tuple : vtk::DataArrayTupleRange(array))
    {
      const double bin = scale * (static_cast<double>(tuple[0]) - this->Range[0]);
      if (std::isfinite(bin))
      {
        ++this->Counts[static_cast<std::size_t>(std::clamp(bin, 0.0, NumberOfBins - 1.0))];
      }
    }
  }
};

struct ColorPoint
{
  double Part; // position: 0 at Level - Width / 2, 1 at the maximum value
  double Red;
  double Green;
  double Blue;
};

std::vector<ColorPoint> GetColors(Transfer::Preset preset)
{
  switch (preset)
  {
    case Transfer::CT_BONE:
      return { { 0.0, 0.75, 0.45, 0.35 }, { 0.15, 0.93, 0.86, 0.70 }, { 1.0, 1.0, 1.0, 0.95 } };
    case Transfer::CT_SOFT_TISSUE:
      return { { 0.0, 0.85, 0.62, 0.50 }, { 0.06, 0.75, 0.35, 0.30 }, { 0.2, 0.95, 0.90, 0.80 },
        { 1.0, 1.0, 1.0, 0.95 } };
    case Transfer::MR:
      return { { 0.0, 0.20, 0.25, 0.35 }, { 0.4, 0.75, 0.62, 0.58 }, { 1.0, 1.0, 0.97, 0.92 } };
    default:
      return { { 0.0, 0.87, 0.62, 0.51 }, { 0.5, 0.96, 0.82, 0.72 }, { 1.0, 1.0, 1.0, 0.98 } };
  }
}
}

Histogram::Histogram(vtkImageData* image)
  : Counts(NumberOfBins, 0.0)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  scalars->GetFiniteRange(this->Range, 0);
  this->Range[1] = this->Range[1] > this->Range[0] ? this->Range[1] : this->Range[0] + 1.0;
  Counting counting{ this->Range, this->Counts };
  if (!vtkArrayDispatch::Dispatch::Execute(scalars, counting))
  {
    counting(scalars);
  }
}

double Histogram::GetValue(double bin) const
{
  return this->Range[0] + (this->Range[1] - this->Range[0]) * bin / NumberOfBins;
}

double Histogram::FindThreshold() const
{
  return this->GetValue(deformvolume::FindOtsuThreshold(this->Counts));
}

double Histogram::FindPercentile(double least, double part) const
{
  double all = 0.0;
  for (int bin = 0; bin < NumberOfBins; ++bin)
  {
    all += this->GetValue(bin) >= least ? this->Counts[static_cast<std::size_t>(bin)] : 0.0;
  }
  double below = 0.0;
  for (int bin = 0; bin < NumberOfBins; ++bin)
  {
    below += this->GetValue(bin) >= least ? this->Counts[static_cast<std::size_t>(bin)] : 0.0;
    if (below >= part * all && below > 0.0)
    {
      return this->GetValue(bin + 1);
    }
  }
  return this->Range[1];
}

Transfer::Transfer(Preset preset, const Histogram& histogram)
  : Chosen(preset)
{
  const double threshold = histogram.FindThreshold();
  switch (preset)
  {
    case CT_BONE: // in Hounsfield units
      this->Level = 300.0;
      this->Width = 250.0;
      break;
    case CT_SOFT_TISSUE:
      this->Level = -50.0;
      this->Width = 200.0;
      this->Most = 0.6;
      break;
    case MR:
    {
      const double bright = histogram.FindPercentile(threshold, 0.9);
      this->Level = 0.5 * (threshold + bright);
      this->Width = bright - threshold;
      this->Most = 0.12;
      break;
    }
    default:
      this->Width = 0.5 * (threshold - histogram.Range[0]);
      this->Level = threshold - 0.5 * this->Width;
  }
  this->Width = std::max(this->Width, 1e-3 * (histogram.Range[1] - histogram.Range[0]));
}

std::string Transfer::GetName() const
{
  constexpr std::array<const char*, NUMBER_OF_PRESETS> names = { { "automatic", "CT bone",
    "CT soft tissue", "MR" } };
  return names[static_cast<std::size_t>(this->Chosen)];
}

void Transfer::Apply(vtkVolumeProperty* property, const double range[2]) const
{
  const double low = this->Level - 0.5 * this->Width;
  const double high = this->Level + 0.5 * this->Width;
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(std::min(low - this->Width, range[0]), 0.0);
  opacity->AddPoint(low, 0.0);
  opacity->AddPoint(high, this->Most);
  opacity->AddPoint(std::max(high + this->Width, range[1]), this->Most);
  vtkNew<vtkColorTransferFunction> color;
  const double most = std::max(high, range[1]);
  for (const ColorPoint& point : GetColors(this->Chosen))
  {
    color->AddRGBPoint(low + point.Part * (most - low), point.Red, point.Green, point.Blue);
  }
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetScalarOpacityUnitDistance(1.0);
  property->SetInterpolationTypeToLinear();
  property->ShadeOn();
  property->SetAmbient(0.2);
  property->SetDiffuse(0.8);
  property->SetSpecular(0.1);
}
