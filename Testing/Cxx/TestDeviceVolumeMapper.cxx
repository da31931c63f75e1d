// SPDX-License-Identifier: BSD-3-Clause
// Pictures whose texture is filled on a device that appears to be a graphics card, and to share
// buffers with OpenGL, against those of VTK's mapper.
#include "FakeDriver.h"
#include "FakeSharing.h"
#include "FilterTesting.h"

#include "vtkDeviceVolumeMapper.h"

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkContourValues.h>
#include <vtkPNGWriter.h>
#include <vtkPiecewiseFunction.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace filterTesting;

namespace
{

// Of odd sizes, as rows of textures may be aligned.
const Extent VolumeExtent{ { 3, 39, 0, 30, 0, 32 } };

template <typename T>
vtkSmartPointer<vtkImageData> MakeBall(double least = 0.0, double scale = 1.0)
{
  auto volume = MakeImage(VolumeExtent);
  SetObliqueDirection(volume);
  const glm::dvec3 middle = GetPoint(volume, volume->GetNumberOfPoints() / 2);
  AddScalars<T>(volume, "value",
    [=](const glm::dvec3& p)
    {
      const glm::dvec3 d = p - middle;
      return least + scale * 120.0 * std::exp(-0.01 * (d.x * d.x + d.y * d.y + d.z * d.z));
    });
  return volume;
}

using Picture = std::vector<unsigned char>;

vtkSmartPointer<vtkRenderWindow> MakeWindow()
{
  auto window = vtkSmartPointer<vtkRenderWindow>::New();
  window->SetMultiSamples(0);
  window->SetSize(160, 140);
  return window;
}

// The volume, deformed, in a window.
struct View
{
  View(vtkOpenGLGPUVolumeRayCastMapper* mapper, vtkRenderWindow* window, vtkImageData* volume,
    double least, double scale, bool onDevice)
    : Mapper(mapper)
    , Window(window)
    , Mesh(MakeMesh(volume, 5))
    , Body(volume, this->Mesh)
  {
    this->Body.Filter->SetOutputBoundsModeToVolumeBounds();
    this->Body.Filter->SetBackgroundValue(least);
    this->Body.Filter->SetOutputOnDevice(onDevice);
    mapper->SetInputConnection(this->Body.Filter->GetOutputPort());
    mapper->AddObserver(vtkCommand::WarningEvent, this->Observer);
    mapper->AddObserver(vtkCommand::ErrorEvent, this->Observer);
    mapper->SetAutoAdjustSampleDistances(0);
    mapper->SetSampleDistance(0.4F);
    vtkNew<vtkColorTransferFunction> color;
    color->AddRGBPoint(least + scale * 20.0, 0.2, 0.3, 1.0);
    color->AddRGBPoint(least + scale * 100.0, 1.0, 0.9, 0.2);
    vtkNew<vtkPiecewiseFunction> opacity;
    opacity->AddPoint(least + scale * 15.0, 0.0);
    opacity->AddPoint(least + scale * 100.0, 0.5);
    vtkVolumeProperty* const properties = this->Volume->GetProperty();
    properties->SetColor(color);
    properties->SetScalarOpacity(opacity);
    properties->SetInterpolationTypeToLinear();
    properties->ShadeOn();
    properties->SetIndependentComponents(volume->GetNumberOfScalarComponents() == 1);
    this->Volume->SetMapper(mapper);
    this->Renderer->AddVolume(this->Volume);
    this->Renderer->SetBackground(0.1, 0.1, 0.2);
    window->AddRenderer(this->Renderer);
    this->Move(1.0);
    this->Renderer->ResetCamera();
    this->Renderer->GetActiveCamera()->Zoom(1.5);
  }
  ~View()
  {
    VERIFY_EQUAL(this->Observer->GetErrorMessage(), "");
    VERIFY_EQUAL(this->Observer->GetWarningMessage(), "");
    this->Window->RemoveRenderer(this->Renderer);
  }
  void Move(double by)
  {
    SetDisplacements(this->Mesh,
      [=](const glm::dvec3& p)
      { return p + glm::dvec3(by * std::sin(0.2 * p.y), by, 0.5 * by * std::cos(0.15 * p.x)); });
  }
  Picture Draw()
  {
    this->Window->Render();
    vtkNew<vtkWindowToImageFilter> shot;
    shot->SetInput(this->Window);
    shot->ShouldRerenderOff();
    shot->ReadFrontBufferOff();
    shot->Update();
    this->Shot = shot->GetOutput();
    const auto* const colors = static_cast<unsigned char*>(this->Shot->GetScalarPointer());
    return Picture(colors, colors + 3 * this->Shot->GetNumberOfPoints());
  }

  vtkOpenGLGPUVolumeRayCastMapper* Mapper;
  vtkSmartPointer<vtkRenderWindow> Window;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Body;
  vtkNew<vtkTest::ErrorObserver> Observer;
  vtkNew<vtkVolume> Volume;
  vtkNew<vtkRenderer> Renderer;
  vtkSmartPointer<vtkImageData> Shot;
};

// The window that the device shares with: it cannot share with another one.
vtkRenderWindow* SharedWindow = nullptr;

// The mapper, and VTK's own.
struct Both
{
  explicit Both(vtkImageData* volume, double least = 0.0, double scale = 1.0)
    : Found(Mapper, SharedWindow, volume, least, scale, true)
    , Expected(Plain, MakeWindow(), volume, least, scale, false)
  {
  }
  // Moves the volume and draws both. Returns whether the texture was filled on the device.
  bool Draw(double by)
  {
    this->Found.Move(by);
    this->Expected.Move(by);
    return this->DrawAgain();
  }
  bool DrawAgain()
  {
    const Picture found = this->Found.Draw();
    const Picture expected = this->Expected.Draw();
    VERIFY(found == expected);
    VERIFY(found != this->Last);
    const auto colors = std::minmax_element(expected.begin(), expected.end());
    VERIFY(*colors.second - *colors.first > this->LeastContrast);
    this->Last = found;
    return this->Mapper->GetLoadedOnDevice();
  }
  void Turn()
  {
    for (View* view : { &this->Found, &this->Expected })
    {
      view->Renderer->GetActiveCamera()->Azimuth(25.0);
    }
  }
  int GetNumberOfUnread() { return this->Found.Body.Filter->GetNumberOfUnreadArrays(); }

  vtkNew<vtkDeviceVolumeMapper> Mapper;
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> Plain;
  View Found;
  View Expected;
  Picture Last;
  int LeastContrast = 60;
};

void TestMisuse(vtkRenderWindow* window)
{
  vtkNew<vtkDeviceVolumeMapper> mapper;
  vtkNew<vtkTest::ErrorObserver> observer;
  mapper->AddObserver(vtkCommand::ErrorEvent, observer);
  const auto refuses = [&](vtkRenderWindow* shared, const char* device, const std::string& words)
  {
    VERIFY(!mapper->ShareDevice(shared, device));
    VERIFY(observer->GetErrorMessage().find(words) != std::string::npos);
    if (observer->GetErrorMessage().find(words) == std::string::npos)
    {
      std::cerr << words << ": " << observer->GetErrorMessage() << '\n';
    }
    observer->Clear();
  };
  refuses(nullptr, "", "window of OpenGL");
  refuses(window, "no such device", "no such device");
  refuses(window, "", "cl_khr_gl_sharing");
  FakeDriver::Get().HasOpenGLSharing = true;
  FakeSharing::Get().DrawsElsewhere = true;
  refuses(window, "", "not the one that draws");
  FakeSharing::Get().DrawsElsewhere = false;
  VERIFY_EQUAL(FakeSharing::Get().Contexts, 0);
  VERIFY(mapper->ShareDevice(window));
  VERIFY(mapper->ShareDevice(window, nullptr)); // the same
  VERIFY_EQUAL(FakeSharing::Get().Contexts, 1);
  VERIFY_EQUAL(observer->GetErrorMessage(), "");
  const auto other = MakeWindow();
  refuses(other, "", "in use already");
  VERIFY(!mapper->GetLoadedOnDevice());
}

// Nothing is read but what describes an output.
void TestReading(const std::string& folder)
{
  Both both(MakeBall<short>(-1000.0, 10.0), -1000.0, 10.0);
  VERIFY(!both.DrawAgain()); // the first picture
  VERIFY(both.Draw(0.5));    // the mapper has held the mask of the first one
  for (const double by : { 2.0, -1.0, 3.0 })
  {
    const int copies = FakeSharing::Get().Copies;
    both.Found.Move(by);
    FakeDriver::Get().BytesRead = 0;
    both.Found.Draw();
    VERIFY(FakeDriver::Get().BytesRead < 10000);
    VERIFY(both.Mapper->GetLoadedOnDevice());
    VERIFY_EQUAL(both.GetNumberOfUnread(), 2);
    VERIFY_EQUAL(FakeSharing::Get().Copies, copies + 1);
    VERIFY(FakeSharing::Get().WaitForBuffers(1));
    both.Expected.Move(by);
    VERIFY(both.DrawAgain());
    VERIFY_EQUAL(FakeSharing::Get().Copies, copies + 1); // nothing was new
  }
  both.Turn();
  VERIFY(both.DrawAgain());
  VERIFY_EQUAL(both.GetNumberOfUnread(), 2);
  vtkNew<vtkPNGWriter> writer;
  writer->SetFileName((folder + "/TestDeviceVolumeMapper.png").c_str());
  writer->SetInputData(both.Found.Shot);
  writer->Write();
  // Somebody reads what is drawn, and then what is to be drawn.
  both.Found.Body.GetValues()->GetComponent(0, 0);
  VERIFY_EQUAL(both.GetNumberOfUnread(), 1);
  both.Turn();
  VERIFY(both.DrawAgain());
  both.Found.Move(1.5);
  both.Expected.Move(1.5);
  both.Found.Body.Update();
  both.Found.Body.GetValues()->GetComponent(0, 0);
  VERIFY(!both.DrawAgain());
  VERIFY(both.Draw(0.5));
  // A picture of the same window without the volume, and one after an update that nobody saw.
  both.Found.Volume->VisibilityOff();
  both.Found.Draw();
  both.Found.Move(-2.0);
  both.Found.Body.Update();
  both.Found.Volume->VisibilityOn();
  VERIFY(both.Draw(-2.0));
  VERIFY_EQUAL(FakeSharing::Get().WrongCopies, 0);
}

template <typename T>
bool DrawsOnDevice(double least, double scale)
{
  Both both(MakeBall<T>(least, scale), least, scale);
  both.DrawAgain();
  return both.Draw(2.0);
}

void TestTypes()
{
  VERIFY(DrawsOnDevice<signed char>(-100.0, 1.0));
  VERIFY(DrawsOnDevice<unsigned char>(0.0, 1.0));
  VERIFY(DrawsOnDevice<unsigned short>(1000.0, 100.0));
  VERIFY(DrawsOnDevice<float>(-0.2, 0.01));
  VERIFY(!DrawsOnDevice<int>(-1e6, 1e5));
  VERIFY(!DrawsOnDevice<double>(-1.0, 0.1));
  VERIFY(!DrawsOnDevice<long long>(0.0, 100.0));
}

// Colors, chosen by their name among several arrays.
void TestComponents()
{
  auto volume = MakeBall<unsigned char>();
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetName("colors");
  colors->SetNumberOfComponents(4);
  vtkDataArray* const values = volume->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    const double value = values->GetComponent(i, 0);
    colors->InsertNextTuple4(2.0 * value, 255.0 - value, value, value);
  }
  volume->GetPointData()->AddArray(colors);
  volume->GetPointData()->SetActiveScalars("colors");
  Both both(volume);
  both.DrawAgain();
  VERIFY(both.Draw(2.0));
  // The other one, which is not that of the same place.
  for (View* view : { &both.Found, &both.Expected })
  {
    view->Mapper->SetScalarModeToUsePointFieldData();
    view->Mapper->SelectScalarArray("value");
    view->Volume->GetProperty()->IndependentComponentsOn();
  }
  VERIFY(both.DrawAgain());
  VERIFY(both.Draw(-1.0));
  VERIFY_EQUAL(both.GetNumberOfUnread(), 3);
}

// What is drawn by way of the host, and after that.
void TestOtherWays()
{
  Both both(MakeBall<float>());
  both.DrawAgain();
  VERIFY(both.Draw(2.0));
  for (View* view : { &both.Found, &both.Expected })
  {
    view->Window->MakeCurrent();
    view->Mapper->ReleaseGraphicsResources(view->Window);
  }
  VERIFY(FakeSharing::Get().WaitForBuffers(0));
  both.Turn();
  VERIFY(!both.DrawAgain());
  VERIFY(both.Draw(1.0));
  const auto all = [&](void (*change)(vtkOpenGLGPUVolumeRayCastMapper*))
  {
    change(both.Found.Mapper);
    change(both.Expected.Mapper);
  };
  all([](vtkOpenGLGPUVolumeRayCastMapper* mapper) { mapper->SetBlendModeToMaximumIntensity(); });
  VERIFY(both.Draw(1.6));
  all([](vtkOpenGLGPUVolumeRayCastMapper* mapper) { mapper->SetBlendModeToComposite(); });
  VERIFY(both.Draw(1.9));
  // Another size.
  for (View* view : { &both.Found, &both.Expected })
  {
    view->Body.Filter->SetPadding(3);
  }
  VERIFY(both.Draw(-1.0));
  VERIFY(FakeSharing::Get().WaitForBuffers(1));
  // The device fails: a warning, and the picture.
  for (int* const error : { &FakeSharing::Get().AcquireError, &FakeSharing::Get().CopyError })
  {
    *error = -5; // CL_OUT_OF_RESOURCES
    VERIFY(!both.Draw(-2.0));
    *error = 0;
    VERIFY(
      both.Found.Observer->GetWarningMessage().find("by way of the host") != std::string::npos);
    both.Found.Observer->Clear();
    VERIFY_EQUAL(FakeSharing::Get().Held, 0);
    VERIFY(FakeSharing::Get().WaitForBuffers(0));
    VERIFY(both.Draw(2.5));
  }
  both.Mapper->LoadOnDeviceOff();
  both.Turn();
  VERIFY(!both.DrawAgain());
  VERIFY(!both.Draw(-1.3));
  both.Mapper->LoadOnDeviceOn();
  VERIFY(both.Draw(-0.3));
  // Surfaces are contoured on the host (of an oblique volume VTK then draws next to nothing).
  both.LeastContrast = -1;
  all(
    [](vtkOpenGLGPUVolumeRayCastMapper* mapper)
    {
      mapper->GetDepthPassContourValues()->SetValue(0, 60.0);
      mapper->SetUseDepthPass(1);
    });
  VERIFY(!both.DrawAgain());
  VERIFY(!both.Draw(2.0));
  all([](vtkOpenGLGPUVolumeRayCastMapper* mapper) { mapper->SetUseDepthPass(0); });
  both.LeastContrast = 60;
  VERIFY(both.Draw(-2.2));
  // A filter that is none of ours.
  vtkNew<vtkImageData> copy;
  copy->DeepCopy(both.Found.Body.Filter->GetOutput());
  all([](vtkOpenGLGPUVolumeRayCastMapper* mapper) { mapper->RemoveAllInputs(); });
  both.Found.Mapper->SetInputData(copy);
  both.Expected.Mapper->SetInputData(copy);
  both.Turn();
  VERIFY(!both.DrawAgain());
}

// One mapper in two windows, of which one shares with the device.
void TestWindows()
{
  Both both(MakeBall<short>());
  both.DrawAgain();
  VERIFY(both.Draw(2.0));
  const auto other = MakeWindow();
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(0.1, 0.1, 0.2);
  renderer->AddVolume(both.Found.Volume);
  renderer->SetActiveCamera(both.Found.Renderer->GetActiveCamera());
  other->AddRenderer(renderer);
  for (const double by : { -1.0, 1.5, 0.7 })
  {
    both.Found.Move(by);
    other->Render();
    VERIFY(!both.Mapper->GetLoadedOnDevice());
    VERIFY(FakeSharing::Get().WaitForBuffers(0));
    VERIFY(!both.Draw(by + 0.3)); // the first one in this window
    VERIFY(both.Draw(by + 0.6));
  }
  // Another window is current when the mapper goes.
  other->RemoveRenderer(renderer);
  other->MakeCurrent();
  renderer->RemoveVolume(both.Found.Volume);
  both.Found.Volume->SetMapper(nullptr);
  VERIFY(other->IsCurrent());
}

// Blocks of the volume have a texture one after the other.
void TestPartitions()
{
  Both both(MakeBall<float>());
  both.DrawAgain();
  VERIFY(both.Draw(2.0));
  both.Mapper->SetPartitions(2, 1, 2);
  both.Plain->SetPartitions(2, 1, 2);
  VERIFY(!both.Draw(0.5));
  VERIFY(!both.Draw(-0.5));
  both.Turn();
  VERIFY(!both.DrawAgain());
  both.Mapper->SetPartitions(1, 1, 1);
  both.Plain->SetPartitions(1, 1, 1);
  both.Draw(
    1.2); // still in a way of its own: the superclass goes on loading the one block that there is
}

// Voxels that are hidden are in a texture of their own.
void TestGhosts()
{
  auto volume = MakeBall<unsigned char>();
  Both both(volume);
  both.DrawAgain();
  VERIFY(both.Draw(2.0));
  for (View* view : { &both.Found, &both.Expected })
  {
    view->Body.Filter->Update();
    vtkNew<vtkImageData> shown;
    shown->ShallowCopy(view->Body.Filter->GetOutput());
    vtkNew<vtkUnsignedCharArray> ghosts;
    ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
    ghosts->SetNumberOfTuples(shown->GetNumberOfPoints());
    for (vtkIdType i = 0; i < ghosts->GetNumberOfTuples(); ++i)
    {
      const bool isHidden = i < ghosts->GetNumberOfTuples() / 3;
      ghosts->SetValue(i, isHidden ? vtkDataSetAttributes::HIDDENPOINT : 0);
    }
    shown->GetPointData()->AddArray(ghosts);
    view->Mapper->SetInputDataObject(shown);
  }
  VERIFY(!both.DrawAgain());
}

} // namespace

int main(int argc, char* argv[])
{
  FakeDriver::Get().IsGraphics = true; // before there is a context
  const auto window = MakeWindow();
  SharedWindow = window;
  TestMisuse(window);
  TestReading(argc > 1 ? argv[1] : ".");
  TestTypes();
  TestComponents();
  VERIFY(FakeSharing::Get().WaitForBuffers(0));
  TestOtherWays();
  TestWindows();
  VERIFY(FakeSharing::Get().WaitForBuffers(0));
  TestPartitions();
  TestGhosts();
  VERIFY(FakeSharing::Get().WaitForBuffers(0));
  VERIFY_EQUAL(FakeSharing::Get().WrongCopies, 0);
  return GetExitCode();
}
