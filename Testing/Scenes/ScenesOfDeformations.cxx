// SPDX-License-Identifier: BSD-3-Clause
// Scenes of outputs of vtkDeformVolumeFilter: values, surfaces, slices, labels and folds.
#include "SceneTesting.h"

#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkLookupTable.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRTAnalyticSource.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

using namespace sceneTesting;

namespace
{

const std::vector<glm::dvec3> Warm = { { 0.1, 0.2, 0.5 }, { 0.3, 0.6, 0.8 }, { 0.95, 0.9, 0.7 },
  { 0.9, 0.5, 0.2 }, { 0.5, 0.1, 0.1 } };

// Returns a cube around the origin with waves around a bump, with values from 37 to 277.
vtkSmartPointer<vtkImageData> MakeWaves(int halfWidth)
{
  vtkNew<vtkRTAnalyticSource> source;
  source->SetWholeExtent(-halfWidth, halfWidth, -halfWidth, halfWidth, -halfWidth, halfWidth);
  source->SetXFreq(25.0);
  source->SetYFreq(20.0);
  source->SetZFreq(22.0);
  source->Update();
  return source->GetOutput();
}

// Returns a rotation about z, whose angle grows with the distance from the axis or, for a twist,
// along the axis.
WorldMap Turn(double radiansPerUnit, bool isTwist)
{
  return [=](const glm::dvec3& p)
  {
    const double angle = radiansPerUnit * (isTwist ? p.z : std::hypot(p.x, p.y));
    return glm::dvec3(p.x * std::cos(angle) - p.y * std::sin(angle),
      p.x * std::sin(angle) + p.y * std::cos(angle), p.z);
  };
}

// Returns a filter that deforms a volume by a map, with its own mesh or field.
vtkSmartPointer<vtkDeformVolumeFilter> Deform(
  vtkImageData* volume, vtkDataSet* deformation, const WorldMap& map, Version version)
{
  SetDisplacements(deformation, map);
  auto filter = vtkSmartPointer<vtkDeformVolumeFilter>::New();
  filter->SetInputData(volume);
  filter->SetDeformationData(Shifted(deformation, version));
  return filter;
}

} // namespace

namespace sceneTesting
{

// Shading by gradients makes steps between voxels visible. SPOILED: samples have the values of
// single voxels.
void DrawVolumeRendering(vtkRenderWindow* window, Version version)
{
  const auto waves = MakeWaves(16);
  auto filter = Deform(waves, MakeMesh(waves, 13), Turn(0.04, true), version);
  SetSampling(filter, 0.5);
  if (version == Version::SPOILED)
  {
    filter->AddCategoricalArray("RTData");
  }
  // Ray casting on the CPU gives the same pictures with all OpenGL drivers.
  vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
  mapper->SetInputConnection(filter->GetOutputPort());
  mapper->AutoAdjustSampleDistancesOff();
  mapper->SetSampleDistance(0.25);
  mapper->SetImageSampleDistance(1.0);
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(150.0, 0.0);
  opacity->AddPoint(165.0, 0.8);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(150.0, 0.5, 0.75, 0.9);
  color->AddRGBPoint(160.0, 0.95, 0.8, 0.6);
  color->AddRGBPoint(175.0, 0.95, 0.5, 0.2);
  vtkNew<vtkVolume> shown;
  shown->SetMapper(mapper);
  shown->GetProperty()->SetScalarOpacity(opacity);
  shown->GetProperty()->SetColor(color);
  shown->GetProperty()->SetInterpolationTypeToLinear();
  shown->GetProperty()->ShadeOn();
  shown->GetProperty()->SetAmbient(0.2);
  shown->GetProperty()->SetDiffuse(1.0);
  shown->GetProperty()->SetSpecular(0.0); // highlights differ between versions of VTK
  AddRenderer(window, glm::dvec3(0.0), glm::dvec3(30.0, -80.0, 50.0), 42.0)->AddViewProp(shown);
}

// SPOILED: the volume is twisted in the opposite direction.
void DrawIsosurface(vtkRenderWindow* window, Version version)
{
  auto volume = MakeImage({ { -15, 15, -15, 15, -20, 20 } });
  AddValues<float>(volume, "height", [](const glm::dvec3& p) { return p.z; });
  AddValues<short>(volume, "value",
    [](const glm::dvec3& p)
    {
      // Four bars around the axis, and two plates at their ends.
      const glm::dvec2 corner(std::abs(p.x) - 8.0, std::abs(p.y) - 8.0);
      const double bar = std::max(glm::length(corner), std::abs(p.z) - 12.0);
      const double plate = std::max(
        std::abs(std::abs(p.z) - 16.0) + 1.5, 0.3 * std::max(std::abs(p.x), std::abs(p.y)));
      return 50.0 + 25.0 * (4.0 - std::min(bar, plate));
    });
  const double turn = version == Version::SPOILED ? -0.05 : 0.05;
  auto filter = Deform(volume, MakeMesh(volume, 13), Turn(turn, true), version);
  SetSampling(filter, 0.5, -20.0);
  AddSurface(AddRenderer(window, glm::dvec3(0.0), glm::dvec3(30.0, -80.0, 40.0), 46.0),
    filter->GetOutputPort(), "height", MakeColors(-20.0, 20.0, Warm));
}

// SPOILED: a forward field is used as an inverse one.
void DrawSlice(vtkRenderWindow* window, Version version)
{
  const auto waves = MakeWaves(20);
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(waves);
  auto filter = Deform(waves, field, Turn(0.04, false), version);
  SetSampling(filter, 0.25, -1.0);
  filter->SetFieldIsInverse(version == Version::SPOILED);
  filter->Update();
  AddSlice(AddRenderer(window, glm::dvec3(0.0), glm::dvec3(0.0, 0.0, 90.0), 58.0),
    filter->GetOutput(), "RTData", MakeColors(40.0, 280.0, Warm));
}

// Labels (left) and values (right). SPOILED: labels are interpolated, which gives other labels at
// their borders.
void DrawLabels(vtkRenderWindow* window, Version version)
{
  auto volume = MakeImage({ { -8, 8, -18, 18, -1, 1 } });
  AddValues<unsigned char>(volume, "label",
    [](const glm::dvec3& p)
    {
      const auto isInside = [&p](double x, double y, double width, double height)
      { return std::hypot((p.x - x) / width, (p.y - y) / height) < 1.0; };
      return isInside(0.0, 10.0, 3.5, 5.0) ? 5.0
        : isInside(2.0, -9.0, 4.0, 6.0)    ? 4.0
        : isInside(-1.0, -3.0, 5.5, 3.5)   ? 3.0
        : isInside(0.0, 0.0, 8.0, 18.0)    ? 2.0
                                           : 1.0;
    });
  AddValues<float>(volume, "value",
    [](const glm::dvec3& p) { return 50.0 + 50.0 * std::sin(0.5 * p.x) * std::cos(0.35 * p.y); });
  const auto bend = [](const glm::dvec3& p)
  { return glm::dvec3(p.x + 4.0 * std::cos(0.15 * p.y), p.y + 0.15 * p.x, p.z); };
  auto filter = Deform(volume, MakeMesh(volume, 13), bend, version);
  SetSampling(filter, 0.125, -1.0);
  if (version != Version::SPOILED)
  {
    filter->AddCategoricalArray("label");
  }
  filter->Update();
  const auto labels = MakeColors(0.5, 5.5,
    { { 0.35, 0.35, 0.4 }, { 0.95, 0.8, 0.6 }, { 0.3, 0.7, 0.4 }, { 0.8, 0.3, 0.3 },
      { 0.3, 0.4, 0.9 } },
    5);
  for (const bool isValue : { false, true })
  {
    AddSlice(AddRenderer(window, glm::dvec3(1.0, 0.0, 0.0), glm::dvec3(0.0, 0.0, 90.0), 42.0,
               isValue ? 1 : 0, 2),
      filter->GetOutput(), isValue ? "value" : "label",
      isValue ? MakeColors(0.0, 100.0, Warm) : labels);
  }
}

// A bulge that is pushed over the tissue beside it. Where two upright parts overlap, the cells
// with lower indices are drawn. SPOILED: indices are reversed, so that the other part is drawn.
void DrawFold(vtkRenderWindow* window, Version version)
{
  auto volume = MakeImage({ { -20, 20, -16, 16, -1, 1 } });
  if (version == Version::SPOILED)
  {
    volume->SetDirectionMatrix(-1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0);
  }
  AddValues<float>(volume, "value",
    [](const glm::dvec3& p)
    {
      const bool isLine =
        std::min(std::abs(std::remainder(p.x, 4.0)), std::abs(std::remainder(p.y, 4.0))) < 0.5;
      return isLine ? 0.0 : p.x + 20.5;
    });
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(volume);
  const auto push = [](const glm::dvec3& p)
  {
    const double x = (p.x + 7.0) / 5.0;
    const double y = p.y / 8.0;
    return p + glm::dvec3(17.0 * std::exp(-x * x - y * y), 0.0, 0.0);
  };
  auto filter = Deform(volume, field, push, version);
  SetSampling(filter, 0.125, -1.0);
  filter->Update();
  AddSlice(AddRenderer(window, glm::dvec3(0.0), glm::dvec3(0.0, 0.0, 90.0), 44.0),
    filter->GetOutput(), "value", MakeColors(0.0, 41.0, Warm));
}

} // namespace sceneTesting
