// SPDX-License-Identifier: BSD-3-Clause
// DeformVolumeRendering: measures the time that VTK's volume mappers need for a frame of the MRI of
// a head, undeformed and deformed. Both images have the same size, and both are marked as modified
// before each frame. Options are --quick (few rounds, without the frames that take longest),
// --pictures=FOLDER and those of Google Benchmark. An X display is needed.
#include "Evaluation.h"
#include "Timing.h"

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkNIFTIImageReader.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <iostream>
#include <stdexcept>

namespace
{
const char* const HeadFile = "/usr/share/mricron/templates/ch2.nii.gz";

struct Viewport
{
  int Width;
  int Height;
};

enum class Mapper
{
  GPURayCast,
  FixedPoint
};

const char* GetName(Mapper mapper)
{
  return mapper == Mapper::GPURayCast ? "gpu-ray-cast" : "fixed-point-ray-cast";
}

vtkSmartPointer<vtkImageData> ReadHead()
{
  vtkNew<vtkNIFTIImageReader> reader;
  reader->SetFileName(HeadFile);
  reader->Update();
  vtkSmartPointer<vtkImageData> head = reader->GetOutput();
  // World coordinates are voxels, as in the poses.
  head->SetOrigin(0.0, 0.0, 0.0);
  head->SetSpacing(1.0, 1.0, 1.0);
  return head;
}

vtkSmartPointer<vtkVolumeMapper> MakeMapper(Mapper kind)
{
  if (kind == Mapper::GPURayCast)
  {
    auto mapper = vtkSmartPointer<vtkGPUVolumeRayCastMapper>::New();
    mapper->SetAutoAdjustSampleDistances(0);
    mapper->SetSampleDistance(1.0);
    return mapper;
  }
  auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
  mapper->SetAutoAdjustSampleDistances(0);
  mapper->SetSampleDistance(1.0);
  mapper->SetImageSampleDistance(1.0);
  return mapper;
}

vtkSmartPointer<vtkVolumeProperty> MakeProperty(bool shaded)
{
  vtkNew<vtkPiecewiseFunction> opacity;
  opacity->AddPoint(25.0, 0.0);
  opacity->AddPoint(60.0, 0.3);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(30.0, 0.85, 0.60, 0.50);
  color->AddRGBPoint(200.0, 1.0, 0.95, 0.90);
  auto property = vtkSmartPointer<vtkVolumeProperty>::New();
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetInterpolationTypeToLinear();
  property->SetShade(shaded);
  return property;
}

// A window with two volumes, one of which is shown at a time.
class RenderingStage
{
public:
  RenderingStage(Mapper kind, const Viewport& viewport, bool shaded)
    : Head(ReadHead())
    , Deformed(Head, CoarseNodes)
  {
    this->Deformed.GetFilter()->SetOutputBoundsModeToVolumeBounds();
    this->Window->SetOffScreenRendering(1);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(viewport.Width, viewport.Height);
    this->Window->AddRenderer(this->Renderer);
    this->Renderer->SetBackground(0.10, 0.12, 0.15);
    const auto property = MakeProperty(shaded);
    for (vtkVolume* volume : { this->Before.Get(), this->After.Get() })
    {
      volume->SetMapper(MakeMapper(kind));
      volume->SetProperty(property);
      this->Renderer->AddVolume(volume);
    }
    vtkVolumeMapper::SafeDownCast(this->Before->GetMapper())->SetInputData(this->Head);
    this->After->GetMapper()->SetInputConnection(this->Deformed.GetFilter()->GetOutputPort());
    int dimensions[3];
    this->Head->GetDimensions(dimensions);
    const double center[3] = { 0.5 * dimensions[0], 0.5 * dimensions[1], 0.5 * dimensions[2] };
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->SetFocalPoint(center);
    camera->SetPosition(center[0] + 330.0, center[1] + 480.0, center[2] + 40.0);
    camera->SetViewUp(0.0, 0.0, 1.0);
    camera->SetViewAngle(26.0);
    this->Renderer->ResetCameraClippingRange(
      0.0, dimensions[0], 0.0, dimensions[1], 0.0, dimensions[2]);
  }

  Measurement RenderUndeformed()
  {
    this->Head->Modified();
    return this->Render(true);
  }

  Measurement RenderDeformed()
  {
    this->Deformed.Move(Pose::LocalLoad);
    const UpdateTimes times = this->Deformed.Update();
    Measurement measurement = this->Render(false);
    measurement.Counters["update"] = times.Update;
    return measurement;
  }

  void WritePicture(const std::string& path)
  {
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(this->Window);
    grab->ReadFrontBufferOff();
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputConnection(grab->GetOutputPort());
    writer->SetFileName(path.c_str());
    writer->Write();
  }

private:
  Measurement Render(bool before)
  {
    this->Before->SetVisibility(before);
    this->After->SetVisibility(!before);
    Measurement measurement;
    measurement.Seconds = Time(
      [this]()
      {
        this->Window->Render();
        this->Window->WaitForCompletion();
      });
    return measurement;
  }

  vtkSmartPointer<vtkImageData> Head;
  BenchmarkCase Deformed;
  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkVolume> Before;
  vtkNew<vtkVolume> After;
};

void Register(
  Mapper mapper, const Viewport& viewport, bool shaded, int rounds, const std::string& pictures)
{
  const std::string name = std::string(GetName(mapper)) + "/" + std::to_string(viewport.Width) +
    "x" + std::to_string(viewport.Height) + "/" + (shaded ? "shaded" : "unshaded");
  const auto draw = [=](RenderingStage& stage, bool deformed)
  {
    const Measurement measurement = deformed ? stage.RenderDeformed() : stage.RenderUndeformed();
    if (!pictures.empty() && shaded && viewport.Width == viewport.Height)
    {
      stage.WritePicture(pictures + "/head-" + GetName(mapper) + "-" +
        (deformed ? "deformed" : "undeformed") + ".png");
    }
    return measurement;
  };
  RegisterRounds<RenderingStage>("Render/" + name, rounds,
    [=]() { return std::make_shared<RenderingStage>(mapper, viewport, shaded); },
    { { "undeformed", [=](RenderingStage& stage) { return draw(stage, false); } },
      { "deformed", [=](RenderingStage& stage) { return draw(stage, true); } } });
}

// Removes --name or --name=value from the arguments. Returns whether it was given.
bool TakeOption(int& argc, char* argv[], const std::string& name, std::string* value)
{
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    const bool found = value ? word.rfind(name + "=", 0) == 0 : word == name;
    if (found)
    {
      if (value)
      {
        *value = word.substr(name.size() + 1);
      }
      std::copy(argv + i + 1, argv + argc, argv + i);
      --argc;
      return true;
    }
  }
  return false;
}
}

int main(int argc, char* argv[])
{
  std::string pictures;
  TakeOption(argc, argv, "--pictures", &pictures);
  const bool quick = TakeOption(argc, argv, "--quick", nullptr);
  if (!vtksys::SystemTools::FileExists(HeadFile))
  {
    std::cerr << "DeformVolumeRendering: " << HeadFile
              << " is missing: install Debian's package mricron-data\n";
    return 1;
  }
  for (const Mapper mapper : { Mapper::FixedPoint, Mapper::GPURayCast })
  {
    for (const Viewport viewport : { Viewport{ 700, 700 }, Viewport{ 1920, 1080 } })
    {
      for (const bool shaded : { false, true })
      {
        // Without a GPU, OpenGL takes seconds for a large or shaded frame.
        if (quick && mapper == Mapper::GPURayCast && (shaded || viewport.Width > 700))
        {
          continue;
        }
        Register(mapper, viewport, shaded, quick ? 1 : 5, pictures);
      }
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
  {
    return 2;
  }
  benchmark::RunSpecifiedBenchmarks();
  CurrentStage::Find("");
  return 0;
}
