// SPDX-License-Identifier: BSD-3-Clause
// vtkDeformVolumeInteractorStyle: misuse, positions of visible points, recorded events, the thread,
// random events, and the rendered picture.
#include "FilterTesting.h"
#include "RunTests.h"

#include "vtkDeformVolumeInteractorStyle.h"
#include "vtkDeformVolumeSession.h"

#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkInteractorEventRecorder.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkMatrix4x4.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPolyData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <sstream>
#include <thread>
#include <vector>

using namespace filterTesting;
using Session = vtkDeformVolumeSession;
using Style = vtkDeformVolumeInteractorStyle;

namespace
{

std::string GetSessionFile()
{
  return GetTestArgument("-T") + "/TestDeformVolumeInteractorStyle.xml";
}

constexpr Extent BallBox{ { -3, 28, 1, 26, 0, 18 } };
constexpr int WindowSize = 400;
constexpr double PixelsPerUnit = 10.0;
constexpr double Middle[3] = { 12.5, 13.5, 9.0 };

// A volume of the value 10, with a ball of the value 100 in the middle. Outermost voxels are 0.
vtkSmartPointer<vtkImageData> MakeBall()
{
  auto volume = MakeImage(BallBox);
  AddScalars<short>(volume, "value",
    [](const glm::dvec3& p)
    {
      const bool isBorder = p.x < BallBox[0] + 0.5 || p.x > BallBox[1] - 0.5 ||
        p.y < BallBox[2] + 0.5 || p.y > BallBox[3] - 0.5 || p.z < BallBox[4] + 0.5 ||
        p.z > BallBox[5] - 0.5;
      const glm::dvec3 middle(Middle[0], Middle[1], Middle[2]);
      return isBorder ? 0.0 : glm::length(p - middle) <= 6.0 ? 100.0 : 10.0;
    });
  return volume;
}

// A window with a view along -z. Ten pixels are one world unit, and the middle of the window is the
// center of the volume.
struct Viewer
{
  Viewer()
  {
    this->Window->SetOffScreenRendering(1);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(WindowSize, WindowSize);
    this->Interactor->SetRenderWindow(this->Window);
    this->Interactor->SetInteractorStyle(this->Object);
    this->Object->AddObserver(vtkCommand::ErrorEvent, this->Errors);
    this->SessionObject->AddObserver(vtkCommand::ErrorEvent, this->SessionErrors);
  }
  explicit Viewer(vtkImageData* volume)
    : Viewer()
  {
    this->AddRenderer();
    this->Object->SetSession(this->SessionObject);
    this->Opacity->AddPoint(5.0, 0.0);
    this->Opacity->AddPoint(9.0, 1.0);
    this->VolumeObject->SetMapper(this->Mapper);
    this->VolumeObject->GetProperty()->SetScalarOpacity(this->Opacity);
    this->Object->SetVolume(this->VolumeObject);
    EXPECT_TRUE(this->SessionObject->SetInputs(volume));
    this->Replay(Timer());
  }

  void AddRenderer()
  {
    this->Window->AddRenderer(this->Renderer);
    vtkCamera* camera = this->Renderer->GetActiveCamera();
    camera->ParallelProjectionOn();
    camera->SetParallelScale(0.5 * WindowSize / PixelsPerUnit);
    camera->SetFocalPoint(Middle);
    camera->SetPosition(Middle[0], Middle[1], Middle[2] + 100.0);
    camera->SetViewUp(0.0, 1.0, 0.0);
    camera->SetClippingRange(10.0, 200.0);
  }

  // Events in the format of vtkInteractorEventRecorder.
  static std::string Mouse(const char* name, double x, double y, bool isShifted = false)
  {
    std::ostringstream text;
    text << name << ' ' << std::lround(0.5 * WindowSize + PixelsPerUnit * (x - Middle[0])) << ' '
         << std::lround(0.5 * WindowSize + PixelsPerUnit * (y - Middle[1])) << ' '
         << (isShifted ? 1 : 0) << " 0 0 0\n";
    return text.str();
  }
  static std::string Key(char key, double x = Middle[0], double y = Middle[1])
  {
    std::string text = Mouse("CharEvent", x, y);
    text.erase(text.size() - 6);
    return text + std::to_string(static_cast<int>(key)) + " 0 0\n";
  }
  static std::string Timer() { return "TimerEvent 0 0 0 0 0 0\n"; }

  void Replay(const std::string& events)
  {
    const std::string text = "# StreamVersion 1.1\n" + events;
    vtkNew<vtkInteractorEventRecorder> recorder;
    recorder->SetInteractor(this->Interactor);
    recorder->ReadFromInputStringOn();
    recorder->SetInputString(text.c_str());
    recorder->EnabledOn();
    recorder->Play();
    recorder->EnabledOff();
  }

  std::string TakeError()
  {
    const std::string error = this->Errors->GetErrorMessage();
    this->Errors->Clear();
    return error;
  }

  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderWindowInteractor> Interactor;
  vtkNew<vtkDeformVolumeSession> SessionObject;
  vtkNew<vtkDeformVolumeInteractorStyle> Object;
  vtkNew<vtkVolume> VolumeObject;
  vtkNew<vtkGPUVolumeRayCastMapper> Mapper;
  vtkNew<vtkPiecewiseFunction> Opacity;
  vtkNew<vtkTest::ErrorObserver> Errors;
  vtkNew<vtkTest::ErrorObserver> SessionErrors;
};

TEST(DeformVolumeInteractorStyle, Misuse)
{
  vtkNew<vtkDeformVolumeInteractorStyle> style;
  vtkNew<vtkTest::ErrorObserver> errors;
  style->AddObserver(vtkCommand::ErrorEvent, errors);
  double point[3];
  const auto expect = [&](const char* words)
  {
    EXPECT_TRUE(HasPart(errors->GetErrorMessage(), words));
    errors->Clear();
  };
  style->OnLeftButtonDown();
  expect("no interactor");
  style->OnRightButtonDown();
  expect("no interactor");
  style->OnMouseWheelForward();
  expect("no interactor");
  style->OnChar();
  expect("no interactor");
  style->StartSession();
  expect("no interactor");
  EXPECT_FALSE(style->FindPosition(0, 0, point));
  expect("no interactor");
  style->OnMouseMove();
  style->OnLeftButtonUp();
  style->OnRightButtonUp();
  EXPECT_FALSE(style->Poll());
  style->StopSession();
  vtkNew<vtkRenderWindowInteractor> noWindow;
  style->SetInteractor(noWindow);
  style->OnLeftButtonDown();
  expect("no interactor with a window");
  EXPECT_TRUE(!style->Poll() && !errors->GetError());
  style->SetInteractor(nullptr);

  Viewer viewer;
  viewer.Replay(Viewer::Mouse("LeftButtonPressEvent", 0, 0));
  EXPECT_TRUE(HasPart(viewer.TakeError(), "no renderer"));
  viewer.AddRenderer();
  viewer.Object->SetTool(Style::GRAB);
  viewer.Replay(Viewer::Mouse("LeftButtonPressEvent", 0, 0));
  EXPECT_TRUE(HasPart(viewer.TakeError(), "Call SetSession() first"));
  viewer.Replay(Viewer::Key('u'));
  EXPECT_TRUE(HasPart(viewer.TakeError(), "Call SetSession() first"));
  viewer.Object->StartSession();
  EXPECT_TRUE(HasPart(viewer.TakeError(), "Call SetSession() first"));
  viewer.Replay(Viewer::Key('k') + Viewer::Timer()); // an unused key, and a timer without a session
  EXPECT_FALSE(viewer.Errors->GetError());

  // Errors of a session without a volume are displayed as messages.
  viewer.Object->SetSession(viewer.SessionObject);
  viewer.Replay(Viewer::Timer() + Viewer::Mouse("LeftButtonPressEvent", 0, 0));
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "no volume yet"));
  viewer.Replay(Viewer::Key('2'));
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "Call SetInputs() first"));
  viewer.SessionErrors->Clear();
  EXPECT_FALSE(viewer.Object->FindPosition(200, 200, point));
  EXPECT_FALSE(viewer.Errors->GetError());

  viewer.SessionObject->SetInputs(MakeBall());
  vtkNew<vtkVolume> volume;
  viewer.Object->SetVolume(volume);
  viewer.Replay(Viewer::Timer());
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "no vtkVolumeMapper"));
  viewer.Object->SetVolume(nullptr);
  for (const char* key : { "g", "v", "m", "p" })
  {
    viewer.Replay(Viewer::Key(*key, -5, -5) + Viewer::Mouse("LeftButtonPressEvent", -5, -5) +
      Viewer::Mouse("LeftButtonReleaseEvent", -5, -5));
    EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "nothing here"));
  }
  viewer.Replay(Viewer::Key('c') + Viewer::Mouse("LeftButtonPressEvent", -5, -5) +
    Viewer::Mouse("MouseMoveEvent", -5, 20) + Viewer::Mouse("LeftButtonReleaseEvent", -5, 20));
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "misses the body"));
  viewer.Replay(Viewer::Mouse("LeftButtonPressEvent", 10, 10) +
    Viewer::Mouse("LeftButtonReleaseEvent", 10, 10));
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "too short"));
  viewer.Replay(Viewer::Key('x'));
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "no handle"));
  viewer.Replay(Viewer::Key('g') + Viewer::Mouse("LeftButtonPressEvent", 10, 10) +
    Viewer::Mouse("LeftButtonReleaseEvent", 10, 10));
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "Press 2, 3 or 4"));
  viewer.Object->SetTool(99);
  EXPECT_EQ(viewer.Object->GetTool(), int(Style::MEASURE));
  viewer.Object->SetCutDepth(-1.0);
  EXPECT_EQ(viewer.Object->GetCutDepth(), 0.0);
  EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
}

// The z coordinate of the visible point at x and y, or -1 if nothing is visible.
double FindHeight(Viewer& viewer, double x, double y)
{
  double point[3] = { 0.0, 0.0, 0.0 };
  const double pixels[2] = { 0.5 * WindowSize + PixelsPerUnit * (x - Middle[0]),
    0.5 * WindowSize + PixelsPerUnit * (y - Middle[1]) };
  if (!viewer.Object->FindPosition(
        static_cast<int>(std::lround(pixels[0])), static_cast<int>(std::lround(pixels[1])), point))
  {
    return -1.0;
  }
  EXPECT_TRUE(std::abs(point[0] - x) < 1e-9 && std::abs(point[1] - y) < 1e-9);
  return point[2];
}

TEST(DeformVolumeInteractorStyle, Visible)
{
  Viewer viewer(MakeBall());
  EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), 17.0);
  viewer.Object->SetVolume(nullptr);
  EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), 18.0);
  EXPECT_EQ(FindHeight(viewer, -5.0, 4.0), -1.0);

  vtkPiecewiseFunction* opacity = viewer.Opacity;
  opacity->RemoveAllPoints();
  opacity->AddPoint(50.0, 0.0);
  opacity->AddPoint(60.0, 1.0);
  viewer.Object->SetVolume(viewer.VolumeObject);
  // The top of the ball is at 9 + sqrt(36 - 2.5^2 - 0.5^2), which is 14.4.
  EXPECT_EQ(FindHeight(viewer, 15.0, 13.0), 14.0);
  EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), -1.0);
  viewer.Object->SetPickMode(Style::ISOSURFACE);
  viewer.Object->SetIsovalue(100.0);
  EXPECT_EQ(FindHeight(viewer, 15.0, 13.0), 14.0);
  EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), -1.0);
  viewer.Object->SetPickMode(Style::SLICES);
  EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), -1.0);
  viewer.Object->AddSlicePlane(0.0, 0.0, 2.0, 0.0, 0.0, 1.0);
  viewer.Object->AddSlicePlane(0.0, 0.0, 5.25, 0.0, 0.0, -2.0);
  viewer.Object->AddSlicePlane(0.0, 0.0, 40.0, 0.0, 0.0, 1.0); // outside the body
  viewer.Object->AddSlicePlane(3.0, 0.0, 0.0, 1.0, 0.0, 0.0);  // parallel to the view
  EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), 5.0);
  viewer.Object->ClearSlicePlanes();
  EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), -1.0);

  // With low opacity the visible point is where half of the absorption of 19 voxels is reached.
  viewer.Object->SetPickMode(Style::OPACITY);
  for (const double part : { 0.02, 0.2 })
  {
    opacity->RemoveAllPoints();
    opacity->AddPoint(0.0, part);
    opacity->AddPoint(20.0, part);
    viewer.VolumeObject->GetProperty()->SetScalarOpacityUnitDistance(2.0);
    const double all = 1.0 - std::pow(1.0 - part, 19.0 / 2.0);
    const double depth = 2.0 * std::log(1.0 - std::min(0.5, 0.5 * all)) / std::log(1.0 - part);
    EXPECT_LE(
      std::abs(FindHeight(viewer, 3.0, 4.0) - (18.5 - depth)), 1.0); // one step and one voxel
  }
  opacity->RemoveAllPoints();
  opacity->AddPoint(0.0, 0.001);
  EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), -1.0);

  // An oblique volume: the visible point is on the surface of the volume. The mapper's image has no
  // direction, but the volume actor transforms it to the output.
  auto oblique = MakeBall();
  SetObliqueDirection(oblique);
  Viewer other(oblique);
  other.Opacity->AddPoint(0.0, 1.0);
  double middle[3];
  oblique->GetCenter(middle);
  double visible[3] = { 0.0, 0.0, 0.0 };
  other.Renderer->GetActiveCamera()->SetFocalPoint(middle);
  other.Renderer->GetActiveCamera()->SetPosition(middle[0], middle[1], middle[2] + 100.0);
  EXPECT_TRUE(other.Object->FindPosition(WindowSize / 2, WindowSize / 2, visible));
  double index[3];
  oblique->TransformPhysicalPointToContinuousIndex(visible, index);
  double outside = -10.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    outside =
      std::max({ outside, BallBox[2 * axis] - index[axis], index[axis] - BallBox[2 * axis + 1] });
  }
  EXPECT_LT(std::abs(outside), 1e-9);
  vtkImageData* shown = other.Object->GetShownImage();
  EXPECT_TRUE(shown && other.Mapper->GetInput() == shown);
  const vtkIdType last = shown->GetNumberOfPoints() - 1;
  double point[4] = { 0.0, 0.0, 0.0, 1.0 };
  shown->GetPoint(last, point);
  other.VolumeObject->GetUserMatrix()->MultiplyPoint(point, point);
  EXPECT_LT(glm::length(
              glm::dvec3(point[0], point[1], point[2]) - GetPoint(other.Object->GetOutput(), last)),
    1e-9);

  // By default the background value is the least value of the volume.
  auto negative = MakeImage(BallBox);
  AddScalars<short>(negative, "value", [](const glm::dvec3& p) { return -1000.0 + p.x; });
  Viewer third(negative);
  vtkDataArray* values = third.Object->GetShownImage()->GetPointData()->GetScalars();
  EXPECT_EQ(values->GetComponent(0, 0), -1003.0);
  EXPECT_EQ(values->GetRange(0)[1], -972.0);
  EXPECT_EQ(third.SessionObject->GetBackgroundValue(), -1003.0);
  third.SessionObject->SetBackgroundValue(-7.0);
  third.SessionObject->ChangeModel(Session::CHAIN_MAIL);
  third.Replay(Viewer::Timer());
  values = third.Object->GetShownImage()->GetPointData()->GetScalars();
  EXPECT_EQ(values->GetComponent(0, 0), -7.0);
  EXPECT_TRUE(third.SessionObject->SetInputs(MakeBall()));
  EXPECT_EQ(third.SessionObject->GetBackgroundValue(), 0.0);
}

struct Event
{
  std::string Name;
  std::vector<double> Numbers;
};

// Reads the recorded events of a session.
std::vector<Event> ReadEvents(const std::string& fileName)
{
  std::ifstream file(fileName);
  const std::string text{ std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>() };
  std::vector<Event> events;
  const std::string begin = "do=\"";
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1))
  {
    const std::size_t first = at + begin.size();
    std::istringstream words(text.substr(first, text.find('"', first) - first));
    Event event;
    words >> event.Name;
    for (double number = 0.0; words >> number;)
    {
      event.Numbers.push_back(number);
    }
    events.push_back(event);
  }
  return events;
}

// Checks that a session from a file, which the session of a viewer has saved, has the output of the
// viewer when the body is at rest.
void CheckFile(Viewer& viewer, vtkImageData* volume, const std::string& fileName)
{
  vtkNew<vtkDeformVolumeSession> loaded;
  EXPECT_TRUE(loaded->SetInputs(volume));
  EXPECT_TRUE(loaded->LoadSession(fileName));
  for (Session* session : { viewer.SessionObject.Get(), loaded.Get() })
  {
    for (int i = 0; i < 300 && session->Update(); ++i)
    {
    }
  }
  viewer.Object->Poll();
  const auto output = vtkSmartPointer<vtkImageData>::Take(loaded->TakeOutput());
  EXPECT_TRUE(AreEqual(viewer.Object->GetOutput(), output));
}

// An expected event of a record. Its numbers are compared with a tolerance.
struct Wanted
{
  const char* Name;
  std::vector<double> Numbers;
};

bool IsWanted(const Event& event, const Wanted& wanted)
{
  bool isEqual = event.Name == wanted.Name && event.Numbers.size() >= wanted.Numbers.size();
  for (std::size_t i = 0; isEqual && i < wanted.Numbers.size(); ++i)
  {
    isEqual = std::abs(event.Numbers[i] - wanted.Numbers[i]) < 1e-7;
  }
  if (!isEqual)
  {
    ADD_FAILURE() << "the event is " << event.Name << ' ' << testing::PrintToString(event.Numbers)
                  << " instead of " << wanted.Name << ' ' << testing::PrintToString(wanted.Numbers);
  }
  return isEqual;
}

void CheckTools(int model)
{
  const std::string fileName = GetSessionFile();
  constexpr double top = 17.0;
  const auto volume = MakeBall();
  Viewer viewer(volume);
  double length = viewer.Object->GetOutput()->GetLength();
  const std::string timer = Viewer::Timer();
  std::string events = Viewer::Key(static_cast<char>('1' + model)) + timer;
  const auto mouse = [&](const char* name, double x, double y, bool isShifted = false)
  { events += Viewer::Mouse(name, x, y, isShifted) + timer; };

  // A handle that is dragged, moved by the wheel, and kept when the button is released with Shift;
  // a pin; a drag whose handle is released.
  events += Viewer::Key('g');
  mouse("LeftButtonPressEvent", 10.0, 12.0);
  mouse("MouseMoveEvent", 11.0, 13.0);
  mouse("MouseWheelForwardEvent", 11.0, 13.0);
  mouse("MouseWheelForwardEvent", 11.0, 13.0);
  mouse("MouseWheelBackwardEvent", 11.0, 13.0);
  mouse("MouseMoveEvent", 12.5, 14.0);
  mouse("LeftButtonReleaseEvent", 12.5, 14.0, true);
  events += Viewer::Key('p', 4.0, 20.0) + timer;
  mouse("LeftButtonPressEvent", 22.0, 8.0);
  mouse("MouseMoveEvent", 21.0, 9.0);
  // The drag ends when the left button is released, although the right button is pressed.
  mouse("RightButtonPressEvent", 21.0, 9.0);
  mouse("LeftButtonReleaseEvent", 21.0, 9.0);
  mouse("RightButtonReleaseEvent", 21.0, 9.0);
  // Reset, redo, and change to no model, so that the body is at rest and positions are known.
  events += Viewer::Key('z') + timer + Viewer::Key('y') + Viewer::Key('1') + timer;
  viewer.Replay(events);
  EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
  EXPECT_TRUE(viewer.SessionObject->SaveSession(fileName));
  std::vector<Event> made = ReadEvents(fileName);
  const double deep = top - 0.01 * length;
  const std::vector<Wanted> wanted = {
    { "Model", { static_cast<double>(model) } },
    { "BeginGrab", { 0, 10.0, 12.0, top } },
    { "MoveGrab", { 0, 11.0, 13.0, top } },
    { "MoveGrab", { 0, 11.0, 13.0, deep } },
    { "MoveGrab", { 0, 11.0, 13.0, deep - 0.01 * length } },
    { "MoveGrab", { 0, 11.0, 13.0, deep } },
    { "MoveGrab", { 0, 12.5, 14.0, deep } },
    { "Hold", { 0 } },
    { "BeginGrab", { 1, 4.0, 20.0 } },
    { "Hold", { 1 } },
    { "BeginGrab", { 2, 22.0, 8.0 } },
    { "MoveGrab", { 2, 21.0, 9.0 } },
    { "EndGrab", { 2 } },
    { "Reset", {} },
    { "Redo", {} },
    { "Model", { 0 } },
  };
  std::size_t at = 0;
  for (const Event& event : made)
  {
    const bool isSetting = event.Name == "HandleRadius" || event.Name == "RelaxationSweeps" ||
      event.Name == "NumberOfNodes" || event.Name == "UndoMemory" || event.Name == "Step";
    if (!isSetting)
    {
      EXPECT_TRUE(at < wanted.size() && IsWanted(event, wanted[at]));
      ++at;
    }
  }
  EXPECT_EQ(at, wanted.size());
  CheckFile(viewer, volume, fileName);

  // At rest: a cut that begins outside the body, and a carving.
  events = Viewer::Key('c') + Viewer::Key('+');
  mouse("LeftButtonPressEvent", -6.0, 6.0);
  for (double x = -5.0; x <= 14.0; x += 0.5)
  {
    mouse("MouseMoveEvent", x, 6.0);
  }
  mouse("LeftButtonReleaseEvent", 14.0, 6.0);
  events += Viewer::Key('v') + Viewer::Key('-');
  for (int i = 0; i < 11; ++i)
  {
    events += Viewer::Key('+');
  }
  mouse("LeftButtonPressEvent", 20.0, 20.0);
  mouse("MouseMoveEvent", 22.0, 22.0);
  mouse("MouseMoveEvent", 23.0, 22.0); // so near that it is recorded only at the release
  mouse("LeftButtonReleaseEvent", 23.0, 22.0);
  viewer.Replay(events);
  EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
  EXPECT_TRUE(viewer.SessionObject->SaveSession(fileName));
  const std::size_t before = made.size();
  made = ReadEvents(fileName);
  made.erase(std::remove_if(made.begin() + static_cast<std::ptrdiff_t>(before), made.end(),
               [](const Event& event) { return event.Name == "Step"; }),
    made.end());
  EXPECT_EQ(made.size(), before + 4);
  const std::vector<double>& sheet = made[before].Numbers;
  EXPECT_EQ(made[before].Name, std::string("Cut"));
  EXPECT_EQ(sheet[0], 2.0 * 40);
  for (std::size_t i = 0; i < 40; ++i)
  {
    const double x = i == 0 ? -6.0 : -5.0 + 0.5 * static_cast<double>(i - 1);
    const double* upper = &sheet[1 + 6 * i];
    EXPECT_TRUE(std::abs(upper[0] - x) < 1e-7 && std::abs(upper[1] - 6.0) < 1e-7);
    EXPECT_TRUE(std::abs(upper[3] - x) < 1e-7 && std::abs(upper[4] - 6.0) < 1e-7);
    EXPECT_LT(std::abs(upper[2] - top - 2.0), 1e-7);
    EXPECT_LT(std::abs(upper[5] - (top - 0.11 * length)), 1e-7);
  }
  const double radius = 0.025 * length * std::pow(1.1, 10.0);
  EXPECT_TRUE(IsWanted(made[before + 1], { "Carve", { 1, 20.0, 20.0, top, radius } }));
  EXPECT_TRUE(IsWanted(made[before + 2], { "Carve", { 0, 22.0, 22.0, top, radius } }));
  EXPECT_TRUE(IsWanted(made[before + 3], { "Carve", { 0, 23.0, 22.0, top, radius } }));

  // The model deforms the cut and carved body. Then undo and redo, until the body is at rest.
  events = Viewer::Key(static_cast<char>('1' + model)) + timer + Viewer::Key('g');
  mouse("LeftButtonPressEvent", 10.0, 8.0);
  mouse("MouseMoveEvent", 10.0, 11.0);
  mouse("LeftButtonReleaseEvent", 10.0, 11.0);
  events += Viewer::Key('p', 4.0, 20.0) + timer + Viewer::Key('u') + timer + Viewer::Key('u') +
    timer + Viewer::Key('y');
  for (int i = 0; i < 20; ++i)
  {
    events += timer;
  }
  viewer.Replay(events);
  EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
  EXPECT_TRUE(viewer.SessionObject->SaveSession(fileName));
  CheckFile(viewer, volume, fileName);
  EXPECT_EQ(viewer.SessionObject->GetModel(), model);
}

TEST(DeformVolumeInteractorStyle, Tools)
{
  CheckTools(Session::CHAIN_MAIL);
  CheckTools(Session::FINITE_ELEMENTS);
}

// With negative spacings, the same tissue is visible at the same positions, and is cut by the same
// sheet. The mapper gets positive spacings, and the user matrix has the signs.
TEST(DeformVolumeInteractorStyle, NegativeSpacing)
{
  const auto reversed = MakeBall(); // the ball is symmetric
  reversed->SetSpacing(-1.0, -1.0, -1.0);
  reversed->SetOrigin(BallBox[0] + BallBox[1], BallBox[2] + BallBox[3], BallBox[4] + BallBox[5]);
  std::vector<std::vector<double>> sheets;
  for (const auto& volume : { MakeBall(), reversed })
  {
    Viewer viewer(volume);
    EXPECT_EQ(FindHeight(viewer, 3.0, 4.0), 17.0);
    vtkImageData* shown = viewer.Object->GetShownImage();
    for (const vtkIdType id : { vtkIdType(0), vtkIdType(123), shown->GetNumberOfPoints() - 1 })
    {
      double point[4] = { 0.0, 0.0, 0.0, 1.0 };
      shown->GetPoint(id, point);
      viewer.VolumeObject->GetUserMatrix()->MultiplyPoint(point, point);
      EXPECT_LT(glm::length(glm::dvec3(point[0], point[1], point[2]) -
                  GetPoint(viewer.Object->GetOutput(), id)),
        1e-9);
    }
    EXPECT_EQ(*std::min_element(shown->GetSpacing(), shown->GetSpacing() + 3), 1.0);
    viewer.Replay(Viewer::Key('c') + Viewer::Mouse("LeftButtonPressEvent", 11.0, 12.0) +
      Viewer::Mouse("MouseMoveEvent", 14.0, 15.0) +
      Viewer::Mouse("LeftButtonReleaseEvent", 14.0, 15.0) + Viewer::Timer());
    EXPECT_TRUE(viewer.SessionObject->SaveSession(GetSessionFile()));
    for (const Event& event : ReadEvents(GetSessionFile()))
    {
      if (event.Name == "Cut")
      {
        sheets.push_back(event.Numbers);
      }
    }
    EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
  }
  ASSERT_EQ(sheets.size(), 2U);
  ASSERT_EQ(sheets[0].size(), sheets[1].size());
  for (std::size_t i = 0; i < sheets[0].size(); ++i)
  {
    EXPECT_LT(std::abs(sheets[0][i] - sheets[1][i]), 1e-7);
  }
}

// The handles after undo, and after failed events.
TEST(DeformVolumeInteractorStyle, Handles)
{
  const std::string fileName = GetSessionFile();
  Viewer viewer(MakeBall());
  const std::string timer = Viewer::Timer();
  const auto release = [&](double x, double y)
  {
    viewer.Replay(Viewer::Key('x', x, y) + timer);
    return viewer.Object->GetMessage().empty();
  };
  viewer.Replay(Viewer::Key('2') + Viewer::Key('p', 5, 5) + Viewer::Key('p', 20, 5) + timer);
  EXPECT_FALSE(release(10, 5));
  EXPECT_TRUE(release(21.5, 5.5));
  EXPECT_FALSE(release(20, 5));
  viewer.Replay(Viewer::Key('u') + timer); // undoes the release
  EXPECT_TRUE(release(20, 5));
  viewer.Replay(Viewer::Key('u') + Viewer::Key('u') + timer); // undoes release and pin
  EXPECT_FALSE(release(20, 5));
  viewer.Replay(Viewer::Key('y') + timer);
  EXPECT_TRUE(release(20, 5));
  EXPECT_TRUE(release(5, 5));
  EXPECT_FALSE(release(5, 5));
  viewer.Replay(Viewer::Key('z') + timer);
  EXPECT_TRUE(!release(5, 5) && !release(20, 5));

  // Direct calls of the session are possible, too.
  viewer.SessionObject->CarveSphere(5, 20, 18, -1.0); // fails
  viewer.SessionObject->CarveSphere(5, 20, 18, 1.0);
  viewer.Replay(timer);
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "radius"));
  viewer.SessionErrors->Clear();
  viewer.Replay(Viewer::Key('p', 5, 5) + timer + Viewer::Key('u') + timer);
  EXPECT_FALSE(release(5, 5));
  EXPECT_EQ(viewer.SessionObject->GetNumberOfActions(), 1);

  // Undo ends a drag while the button is pressed.
  viewer.Replay(Viewer::Key('2') + timer + Viewer::Key('g') +
    Viewer::Mouse("LeftButtonPressEvent", 8, 8) + Viewer::Mouse("MouseMoveEvent", 9, 8) + timer +
    Viewer::Key('u') + Viewer::Mouse("MouseMoveEvent", 10, 8) +
    Viewer::Mouse("LeftButtonReleaseEvent", 10, 8, true) + timer);
  EXPECT_FALSE(release(9, 8));

  // The handles of a loaded session.
  viewer.Replay(Viewer::Key('p', 20, 5) + timer);
  EXPECT_TRUE(viewer.SessionObject->SaveSession(fileName));
  viewer.Replay(Viewer::Key('z') + timer);
  EXPECT_FALSE(release(20, 5));
  EXPECT_TRUE(viewer.SessionObject->LoadSession(fileName));
  viewer.Replay(timer);
  EXPECT_TRUE(release(20, 5));
  EXPECT_TRUE(!viewer.SessionErrors->GetError() && !viewer.Errors->GetError());
}

TEST(DeformVolumeInteractorStyle, ProbeAndMeasure)
{
  Viewer viewer(MakeBall());
  const std::string timer = Viewer::Timer();
  viewer.Replay(Viewer::Key('m') + Viewer::Mouse("LeftButtonPressEvent", 5.0, 6.0) +
    Viewer::Mouse("LeftButtonReleaseEvent", 5.0, 6.0));
  EXPECT_EQ(viewer.Object->GetMeasuredDistance(), 0.0);
  viewer.Replay(Viewer::Mouse("LeftButtonPressEvent", 8.0, 10.0) +
    Viewer::Mouse("LeftButtonReleaseEvent", 8.0, 10.0));
  EXPECT_LT(std::abs(viewer.Object->GetMeasuredDistance() - 5.0), 1e-9);
  EXPECT_EQ(viewer.Object->GetMessage(), std::string("distance 5"));

  viewer.Replay(Viewer::Key('b') + Viewer::Mouse("MouseMoveEvent", 5.0, 6.0));
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "value 10 at (5, 6, 17), at rest (5, 6, 17)"));
  viewer.Replay(Viewer::Mouse("MouseMoveEvent", -6.0, 6.0));
  EXPECT_EQ(viewer.Object->GetMessage(), std::string("There is nothing here."));
  // Probe while events are processed, and afterwards.
  viewer.Replay(Viewer::Key('2') + Viewer::Key('g') +
    Viewer::Mouse("LeftButtonPressEvent", 5.0, 6.0) + timer +
    Viewer::Mouse("MouseMoveEvent", 8.0, 6.0) + timer + Viewer::Key('b') + Viewer::Key('u') +
    Viewer::Mouse("MouseMoveEvent", 8.0, 6.0));
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "moving"));
  std::string timers;
  for (int i = 0; i < 300; ++i)
  {
    timers += Viewer::Mouse("TimerEvent", 8.0, 6.0);
  }
  viewer.Replay(timers);
  EXPECT_TRUE(HasPart(viewer.Object->GetMessage(), "value 10"));
  EXPECT_TRUE(!viewer.SessionErrors->GetError() && !viewer.Errors->GetError());
}

// The right and middle button and the wheel move the camera, with any tool.
TEST(DeformVolumeInteractorStyle, Camera)
{
  Viewer viewer(MakeBall());
  viewer.Object->SetTool(Style::GRAB);
  vtkCamera* camera = viewer.Renderer->GetActiveCamera();
  const auto press = [&](const std::string& button)
  {
    const glm::dvec3 before(
      camera->GetPosition()[0], camera->GetPosition()[1], camera->GetPosition()[2]);
    viewer.Replay(Viewer::Mouse((button + "ButtonPressEvent").c_str(), 5, 5) +
      Viewer::Mouse("MouseMoveEvent", 9, 5) +
      Viewer::Mouse((button + "ButtonReleaseEvent").c_str(), 9, 5));
    return glm::length(before -
      glm::dvec3(camera->GetPosition()[0], camera->GetPosition()[1], camera->GetPosition()[2]));
  };
  EXPECT_GT(press("Right"), 1.0);
  EXPECT_GT(press("Middle"), 1.0);
  EXPECT_EQ(press("Left"), 0.0);
  viewer.Object->SetTool(Style::TURN);
  EXPECT_GT(press("Left"), 1.0);
  const double scale = camera->GetParallelScale();
  viewer.Replay(Viewer::Mouse("MouseWheelForwardEvent", 5, 5));
  EXPECT_LT(camera->GetParallelScale(), scale);
  viewer.Replay(Viewer::Key('h') + Viewer::Timer());
  EXPECT_TRUE(viewer.Object->GetShowHelp());
  EXPECT_EQ(viewer.SessionObject->GetNumberOfActions(), 1); // a drag without motion
}

// Finds the handles of a session: positions, and whether they are grabbed.
vtkSmartPointer<vtkPolyData> FindHandles(Session* session)
{
  session->Update();
  const auto handles = vtkSmartPointer<vtkPolyData>::New();
  session->GetHandles(handles);
  return handles;
}

// While the camera rotates, and when a handle is at the near plane or in front of it, a drag moves
// the handle only by as much as the cursor and the wheel move afterwards.
TEST(DeformVolumeInteractorStyle, CameraInDrag)
{
  Viewer viewer(MakeBall());
  const auto find = [&] { return GetPoint(FindHandles(viewer.SessionObject), 0); };
  viewer.Replay(Viewer::Key('2') + Viewer::Timer() + Viewer::Key('g') +
    Viewer::Mouse("LeftButtonPressEvent", 10.0, 12.0) +
    Viewer::Mouse("MouseMoveEvent", 10.5, 12.0) +
    Viewer::Mouse("RightButtonPressEvent", 10.5, 12.0) +
    Viewer::Mouse("MouseMoveEvent", 16.5, 12.0) +
    Viewer::Mouse("RightButtonReleaseEvent", 16.5, 12.0));
  const glm::dvec3 before = find();
  viewer.Replay(Viewer::Mouse("MouseMoveEvent", 17.0, 12.0));
  EXPECT_LT(std::abs(glm::length(find() - before) - 0.5), 1e-7);

  // The wheel moves the handle away from the camera, wherever the near plane is.
  vtkCamera* camera = viewer.Renderer->GetActiveCamera();
  const glm::dvec3 away(camera->GetDirectionOfProjection()[0],
    camera->GetDirectionOfProjection()[1], camera->GetDirectionOfProjection()[2]);
  const glm::dvec3 position(
    camera->GetPosition()[0], camera->GetPosition()[1], camera->GetPosition()[2]);
  const double step = 0.01 * viewer.Object->GetOutput()->GetLength();
  for (const double behind : { -0.5, 0.0, 0.5 })
  {
    const glm::dvec3 last = find();
    camera->SetClippingRange(glm::dot(last - position, away) - behind, 200.0);
    viewer.Replay(Viewer::Mouse("MouseWheelForwardEvent", 17.0, 12.0));
    EXPECT_LT(glm::length(find() - last - step * away), 1e-7);
  }
  EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
}

// A drag ends if the session or the interactor is replaced, or if the release of the button was
// lost. Another style then gets the events.
TEST(DeformVolumeInteractorStyle, InterruptedDrag)
{
  Viewer viewer(MakeBall());
  vtkNew<vtkDeformVolumeSession> other;
  EXPECT_TRUE(other->SetInputs(MakeBall()));
  vtkNew<vtkInteractorStyleTrackballCamera> camera;
  viewer.Replay(Viewer::Key('2') + Viewer::Timer() + Viewer::Key('g'));
  const std::string drag =
    Viewer::Mouse("LeftButtonPressEvent", 10.0, 12.0) + Viewer::Mouse("MouseMoveEvent", 10.5, 12.0);
  const auto isGrabbed = [&]
  {
    const auto handles = FindHandles(viewer.SessionObject);
    EXPECT_LE(handles->GetNumberOfPoints(), 1);
    return handles->GetNumberOfPoints() > 0 &&
      handles->GetPointData()->GetArray("Grabbed")->GetComponent(0, 0) != 0.0;
  };
  viewer.Replay(drag);
  EXPECT_TRUE(isGrabbed());
  viewer.Replay(drag); // without a release
  EXPECT_TRUE(isGrabbed());
  viewer.Replay(Viewer::Key('2')); // the model in use, so that the session keeps the handle
  EXPECT_FALSE(isGrabbed());
  viewer.Replay(drag);
  EXPECT_TRUE(isGrabbed());
  viewer.Object->SetSession(other);
  EXPECT_FALSE(isGrabbed());
  viewer.Object->SetSession(viewer.SessionObject);
  viewer.SessionObject->ChangeModel(Session::CHAIN_MAIL);
  viewer.Object->Poll();
  viewer.Replay(drag);
  EXPECT_TRUE(isGrabbed());
  viewer.Interactor->SetInteractorStyle(camera);
  EXPECT_FALSE(isGrabbed());
  const double scale = viewer.Renderer->GetActiveCamera()->GetParallelScale();
  viewer.Replay(Viewer::Mouse("MouseWheelForwardEvent", 5, 5));
  EXPECT_LT(viewer.Renderer->GetActiveCamera()->GetParallelScale(), scale);
  EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
}

// Observers may remove the session or the interactor while Poll() shows an output.
TEST(DeformVolumeInteractorStyle, RemovedByObserver)
{
  for (const unsigned long event :
    { vtkCommand::UpdateDataEvent, vtkCommand::UpdateInformationEvent })
  {
    for (const bool removesSession : { true, false })
    {
      Viewer viewer(MakeBall());
      vtkNew<vtkCallbackCommand> remove;
      remove->SetClientData(removesSession ? nullptr : viewer.Interactor.Get());
      remove->SetCallback(
        [](vtkObject* style, unsigned long, void* interactor, void*)
        {
          if (interactor)
          {
            static_cast<vtkRenderWindowInteractor*>(interactor)->SetInteractorStyle(nullptr);
          }
          else
          {
            static_cast<Style*>(style)->SetSession(nullptr);
          }
        });
      viewer.Object->AddObserver(event, remove);
      viewer.SessionObject->CarveSphere(5, 20, 18, 1.0);
      viewer.Object->Poll();
      EXPECT_EQ(viewer.Object->GetSession() == nullptr, removesSession);
      EXPECT_EQ(viewer.Object->GetInteractor() == nullptr, !removesSession);
      EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
    }
  }
}

// A stroke belongs to the viewport in which it begins, also where it leaves this viewport, and
// FindPosition() uses the viewport of its arguments.
TEST(DeformVolumeInteractorStyle, Viewports)
{
  Viewer viewer(MakeBall());
  vtkNew<vtkRenderer> right;
  viewer.Renderer->SetViewport(0.0, 0.0, 0.5, 1.0);
  right->SetViewport(0.5, 0.0, 1.0, 1.0);
  right->GetActiveCamera()->SetFocalPoint(Middle);
  right->GetActiveCamera()->SetPosition(Middle[0], Middle[1] - 100.0, Middle[2]);
  right->GetActiveCamera()->SetViewUp(0.0, 0.0, 1.0);
  viewer.Window->AddRenderer(right);
  // x = Middle[0] is the middle of the window. The left viewport shows its own Middle at x = 2.5.
  viewer.Replay(Viewer::Key('c') + Viewer::Mouse("LeftButtonPressEvent", 2.5, 9.0) +
    Viewer::Mouse("MouseMoveEvent", 2.5, 17.0) + Viewer::Mouse("MouseMoveEvent", 15.0, 17.0) +
    Viewer::Mouse("LeftButtonReleaseEvent", 15.0, 17.0) + Viewer::Timer());
  EXPECT_EQ(viewer.Object->GetMessage(), "");
  EXPECT_TRUE(viewer.SessionObject->SaveSession(GetSessionFile()));
  const std::vector<Event> events = ReadEvents(GetSessionFile());
  const auto cut = std::find_if(
    events.begin(), events.end(), [](const Event& event) { return event.Name == "Cut"; });
  ASSERT_TRUE(cut != events.end());
  const double top = 17.0 + 2.0; // two voxels above the body
  EXPECT_TRUE(IsWanted(*cut, { "Cut", { 6.0, 12.5, 9.0, top } }));
  const std::vector<double> last(cut->Numbers.begin() + 13, cut->Numbers.begin() + 16);
  EXPECT_TRUE(IsWanted({ "Last", last }, { "Last", { 25.0, 17.0, top } }));

  viewer.Replay(Viewer::Key('t') + Viewer::Mouse("MouseMoveEvent", 15.0, 9.0)); // cursor right
  double position[3] = { 0.0, 0.0, 0.0 };
  EXPECT_TRUE(viewer.Object->FindPosition(WindowSize / 4, WindowSize / 2, position));
  EXPECT_EQ(position[2], 17.0);
  EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
}

TEST(DeformVolumeInteractorStyle, Thread)
{
  Viewer viewer(MakeBall());
  viewer.Object->StartSession();
  EXPECT_TRUE(viewer.SessionObject->GetIsRunning());
  viewer.Replay(
    Viewer::Key('4') + Viewer::Key('g') + Viewer::Mouse("LeftButtonPressEvent", 10.0, 12.0));
  int outputs = 0;
  vtkImageData* last = viewer.Object->GetOutput();
  const auto poll = [&]()
  {
    viewer.Object->Poll();
    outputs += viewer.Object->GetOutput() != last ? 1 : 0;
    last = viewer.Object->GetOutput();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  for (int i = 0; i < 40; ++i)
  {
    viewer.Replay(Viewer::Mouse("MouseMoveEvent", 10.0 + 0.1 * i, 12.0));
    poll();
  }
  viewer.Replay(Viewer::Mouse("LeftButtonReleaseEvent", 14.0, 12.0));
  for (int i = 0; i < 3000 && (viewer.SessionObject->GetIsBusy() || i < 2); ++i)
  {
    poll();
  }
  EXPECT_GT(outputs, 1);
  EXPECT_FALSE(viewer.SessionObject->GetIsBusy());
  viewer.Object->StopSession();
  EXPECT_FALSE(viewer.SessionObject->GetIsRunning());
  EXPECT_TRUE(!viewer.SessionErrors->GetError() && !viewer.Errors->GetError());
}

// Random events in a window whose size changes. The only errors are those of invalid drags, and
// after a reset the volume is at rest. --gtest_random_seed=N selects other events.
TEST(DeformVolumeInteractorStyle, Random)
{
  Viewer viewer(MakeBall());
  const vtkSmartPointer<vtkImageData> first = viewer.Object->GetOutput();
  std::mt19937 random(1 + static_cast<unsigned>(GTEST_FLAG_GET(random_seed)));
  const auto pick = [&](double low, double high)
  { return std::uniform_real_distribution<double>(low, high)(random); };
  const std::string keys = "tgcvbmppxx2341uuyzh+-r";
  std::map<std::string, int> words;
  for (int i = 0; i < 300 && !HasFailure(); ++i)
  {
    const double x = pick(BallBox[0] - 4.0, BallBox[1] + 4.0);
    const double y = pick(BallBox[2] - 4.0, BallBox[3] + 4.0);
    switch (random() % 8)
    {
      case 0:
      case 1:
        viewer.Replay(Viewer::Key(keys[random() % keys.size()], x, y));
        break;
      case 2:
        viewer.Replay(Viewer::Mouse("LeftButtonPressEvent", x, y));
        break;
      case 3:
        viewer.Replay(Viewer::Mouse("LeftButtonReleaseEvent", x, y, random() % 2 == 0));
        break;
      case 4:
        viewer.Replay(Viewer::Mouse(
          random() % 2 == 0 ? "MouseWheelForwardEvent" : "MouseWheelBackwardEvent", x, y));
        break;
      case 5:
        // Change the size, also during a drag. The smallest window has one pixel.
        viewer.Window->SetSize(
          static_cast<int>(pick(1.0, 500.0)), static_cast<int>(pick(1.0, 500.0)));
        viewer.Interactor->SetSize(viewer.Window->GetSize());
        viewer.Interactor->InvokeEvent(vtkCommand::ConfigureEvent);
        viewer.Replay(Viewer::Timer());
        break;
      default:
        viewer.Replay(Viewer::Mouse("MouseMoveEvent", x, y));
    }
    if (random() % 3 == 0)
    {
      viewer.Replay(Viewer::Timer());
    }
    EXPECT_EQ(viewer.TakeError(), "");
    const std::string error = viewer.SessionErrors->GetErrorMessage();
    viewer.SessionErrors->Clear();
    // Possible errors: two handles hold the same node, the displayed point does not exist any more,
    // or the simulation of springs diverges.
    if (!error.empty() && error.find("holds no node") == std::string::npos &&
      error.find("has diverged") == std::string::npos &&
      error.find("outside the deformed volume") == std::string::npos &&
      error.find("released already") == std::string::npos)
    {
      EXPECT_EQ(error, "");
    }
    ++words[viewer.Object->GetMessage()];
  }
  EXPECT_GT(words.size(), 5); // there were different messages
  std::string timers = Viewer::Mouse("LeftButtonReleaseEvent", 0.0, 0.0);
  timers += Viewer::Key('z') + Viewer::Timer() + Viewer::Timer();
  viewer.Replay(timers);
  EXPECT_EQ(viewer.SessionObject->GetNumberOfActions(), 0);
  EXPECT_EQ(viewer.SessionObject->GetModel(), static_cast<int>(Session::NONE));
  EXPECT_TRUE(AreEqual(viewer.Object->GetOutput(), first));
}

using Pixel = std::array<int, 3>;

// The pixels of a color, with a tolerance of 4 of 255 in each channel.
struct Shown
{
  Shown(vtkRenderWindow* window, const Pixel& color)
    : IsThere(WindowSize * WindowSize)
  {
    window->Render();
    vtkNew<vtkUnsignedCharArray> pixels;
    window->GetPixelData(0, 0, WindowSize - 1, WindowSize - 1, 0, pixels);
    for (int i = 0; i < WindowSize * WindowSize; ++i)
    {
      bool isEqual = true;
      for (int channel = 0; channel < 3; ++channel)
      {
        isEqual = isEqual && std::abs(pixels->GetValue(3 * i + channel) - color[channel]) <= 4;
      }
      this->IsThere[i] = isEqual;
      if (isEqual)
      {
        ++this->Count;
        this->Mean += GetPosition(i);
        this->Left = std::min(this->Left, GetPosition(i).x);
      }
    }
    this->Mean /= std::max(this->Count, 1);
  }

  // The world position of the middle of a pixel.
  static glm::dvec2 GetPosition(int pixel)
  {
    return glm::dvec2(pixel % WindowSize + 0.5 - 0.5 * WindowSize,
             pixel / WindowSize + 0.5 - 0.5 * WindowSize) /
      PixelsPerUnit +
      glm::dvec2(Middle[0], Middle[1]);
  }

  std::vector<bool> IsThere;
  int Count = 0;
  glm::dvec2 Mean = glm::dvec2(0.0);
  double Left = 1e9;
};

// The picture of a ball, seen from above: at rest, with handles, dragged and carved. Colors are
// flat, so that all pixels are known, except at outlines.
TEST(DeformVolumeInteractorStyle, Picture)
{
  Viewer viewer(MakeBall());
  viewer.Mapper->SetUseJittering(0);
  viewer.Mapper->SetAutoAdjustSampleDistances(0);
  viewer.Mapper->SetSampleDistance(0.25);
  viewer.Opacity->RemoveAllPoints();
  viewer.Opacity->AddPoint(54.0, 0.0);
  viewer.Opacity->AddPoint(56.0, 1.0);
  vtkNew<vtkColorTransferFunction> color;
  color->AddRGBPoint(0.0, 1.0, 0.8, 0.6);
  viewer.VolumeObject->GetProperty()->SetColor(color);
  viewer.VolumeObject->GetProperty()->SetInterpolationTypeToLinear();
  viewer.Renderer->AddVolume(viewer.VolumeObject);
  viewer.Object->ShowStatusOff();
  const Pixel body{ { 255, 204, 153 } };
  const Pixel handle{ { 90, 230, 120 } };
  const Pixel stroke{ { 255, 110, 90 } };
  const std::string timer = Viewer::Timer();
  const glm::dvec2 middle(Middle[0], Middle[1]);

  // The ball is symmetric about its middle, to one pixel. Its surface is between inner and outer
  // voxels: half a voxel is 17 % of the area of the disc.
  const Shown rest(viewer.Window, body);
  EXPECT_LT(glm::length(rest.Mean - middle), 0.1);
  EXPECT_LT(std::abs(rest.Count / (3.141593 * 3600.0) - 1.0), 0.17);
  EXPECT_EQ(Shown(viewer.Window, handle).Count, 0);

  // A handle is a square of 9 x 9 pixels in front of all objects. If each side has one pixel more
  // or less, it has 64 to 100 pixels.
  viewer.Replay(Viewer::Key('2') + timer + Viewer::Key('p', 15.0, 14.0) + timer);
  const Shown pinned(viewer.Window, handle);
  EXPECT_LE(std::abs(pinned.Count - 81), 18);
  EXPECT_LT(glm::length(pinned.Mean - glm::dvec2(15.0, 14.0)), 0.15);
  EXPECT_LE(std::abs(Shown(viewer.Window, body).Count + pinned.Count - rest.Count), 1);
  viewer.Replay(Viewer::Key('u') + timer);

  // The ball is dragged by three units. The handle is kept, and drawn at its position.
  std::string events = Viewer::Key('g') + Viewer::Mouse("LeftButtonPressEvent", 8.0, 14.0) + timer +
    Viewer::Mouse("MouseMoveEvent", 5.0, 14.0) + timer +
    Viewer::Mouse("LeftButtonReleaseEvent", 5.0, 14.0, true);
  for (int i = 0; i < 20; ++i)
  {
    events += timer;
  }
  viewer.Replay(events);
  const Shown held(viewer.Window, handle);
  const Shown dragged(viewer.Window, body);
  EXPECT_LE(std::abs(held.Count - 81), 18);
  EXPECT_LT(glm::length(held.Mean - glm::dvec2(5.0, 14.0)), 0.15);
  EXPECT_LT(dragged.Left, rest.Left - 1.0);

  // A sphere carves a hole, and other pixels do not change. Within two units of its middle the
  // sphere removes the ball at all depths.
  viewer.Object->SetCarveRadius(9.0);
  viewer.Replay(Viewer::Key('u') + timer + Viewer::Key('v') +
    Viewer::Mouse("LeftButtonPressEvent", 18.0, 13.5) +
    Viewer::Mouse("MouseMoveEvent", 18.0, 13.5) + timer);
  const Shown circle(viewer.Window, stroke);
  EXPECT_GT(circle.Count, 100); // the outline of the sphere
  for (int i = 0; i < WindowSize * WindowSize; ++i)
  {
    const double distance = glm::length(Shown::GetPosition(i) - glm::dvec2(18.0, 14.0));
    EXPECT_TRUE(!circle.IsThere[i] || std::abs(distance - 9.0) < 0.2);
  }
  viewer.Replay(
    Viewer::Mouse("LeftButtonReleaseEvent", 18.0, 13.5) + timer + Viewer::Key('t') + timer);
  const Shown carved(viewer.Window, body);
  int remaining = 0;
  int changed = 0;
  for (int i = 0; i < WindowSize * WindowSize; ++i)
  {
    const double distance = glm::length(Shown::GetPosition(i) - glm::dvec2(18.0, 13.5));
    remaining += distance < 2.0 && carved.IsThere[i];
    changed += distance > 10.0 && carved.IsThere[i] != rest.IsThere[i];
  }
  EXPECT_EQ(remaining, 0);
  EXPECT_EQ(changed, 0);
  EXPECT_GT(carved.Count, rest.Count / 4);

  // The stroke of a cut is drawn while the button is pressed.
  viewer.Replay(Viewer::Key('u') + timer + Viewer::Key('c') +
    Viewer::Mouse("LeftButtonPressEvent", 6.0, 13.5) + Viewer::Mouse("MouseMoveEvent", 12.0, 13.5) +
    timer);
  const Shown cut(viewer.Window, stroke);
  EXPECT_GT(cut.Count, 100);
  EXPECT_LT(glm::length(cut.Mean - glm::dvec2(9.0, 13.5)), 0.15);
  viewer.Replay(Viewer::Mouse("LeftButtonReleaseEvent", 12.0, 13.5) + timer + Viewer::Key('t') +
    Viewer::Key('u') + timer);

  // A measure is a line of two pixels with a square at each end.
  viewer.Replay(Viewer::Key('m') + Viewer::Mouse("LeftButtonPressEvent", 8.0, 12.0) +
    Viewer::Mouse("LeftButtonReleaseEvent", 8.0, 12.0) +
    Viewer::Mouse("LeftButtonPressEvent", 8.0, 15.0) +
    Viewer::Mouse("LeftButtonReleaseEvent", 8.0, 15.0) + timer);
  const Shown measure(viewer.Window, Pixel{ { 120, 200, 255 } });
  EXPECT_LE(std::abs(measure.Count - 204), 40);
  EXPECT_LT(glm::length(measure.Mean - glm::dvec2(8.0, 13.5)), 0.15);
  EXPECT_TRUE(!viewer.Errors->GetError() && !viewer.SessionErrors->GetError());
}

} // namespace
