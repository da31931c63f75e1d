// SPDX-License-Identifier: BSD-3-Clause
// vtkDeformVolumeSession: misuse, a drag compared with filters without a session, random sessions
// that are undone completely, files, and the thread.
#include "ArrayMaking.h"
#include "ChainMailTesting.h"
#include "RunTests.h"

#include "vtkCarveVolume.h"
#include "vtkCutVolume.h"
#include "vtkDeformGeometryFilter.h"
#include "vtkDeformVolumeSession.h"

#include <vtkBitArray.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellType.h>
#include <vtkPlaneSource.h>
#include <vtkSmartPointer.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtksys/SystemTools.hxx>

#include <glm/geometric.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <set>
#include <sstream>
#include <thread>

using namespace chainMailTesting;
using namespace filterTesting;
using Session = vtkDeformVolumeSession;

namespace
{

std::string GetFileName()
{
  return GetTestArgument("-T") + "/TestDeformVolumeSession.xml";
}

constexpr Extent Box{ { -2, 25, 1, 24, 0, 18 } };

struct Tested
{
  explicit Tested(vtkImageData* volume)
    : Volume(volume)
  {
    this->Object->AddObserver(vtkCommand::ErrorEvent, this->Observer);
    EXPECT_TRUE(this->Object->SetInputs(volume));
  }

  std::string TakeError()
  {
    const std::string error = this->Observer->GetErrorMessage();
    this->Observer->Clear();
    return error;
  }

  // Processes all waiting events and steps, until the body is at rest.
  vtkSmartPointer<vtkImageData> Finish(int steps = 300)
  {
    for (int i = 0; i < steps && this->Object->Update(); ++i)
    {
    }
    EXPECT_EQ(this->TakeError(), "");
    return vtkSmartPointer<vtkImageData>::Take(this->Object->TakeOutput());
  }
  vtkSmartPointer<vtkImageData> Step()
  {
    this->Object->Update();
    return vtkSmartPointer<vtkImageData>::Take(this->Object->TakeOutput());
  }
  void ExpectError(const std::string& words)
  {
    this->Object->Update();
    EXPECT_TRUE(HasPart(this->TakeError(), words));
  }

  vtkSmartPointer<vtkImageData> Volume;
  vtkNew<vtkTest::ErrorObserver> Observer;
  vtkNew<vtkDeformVolumeSession> Object;
};

vtkSmartPointer<vtkPolyData> MakePlane(
  const glm::dvec3& middle, const glm::dvec3& a, const glm::dvec3& b, bool isTriangles = true)
{
  vtkNew<vtkPlaneSource> plane;
  const glm::dvec3 origin = middle - 0.5 * (a + b);
  plane->SetOrigin(origin.x, origin.y, origin.z);
  plane->SetPoint1(origin.x + a.x, origin.y + a.y, origin.z + a.z);
  plane->SetPoint2(origin.x + b.x, origin.y + b.y, origin.z + b.z);
  plane->SetResolution(2, 2);
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputConnection(plane->GetOutputPort());
  triangles->Update();
  plane->Update();
  return isTriangles ? triangles->GetOutput() : plane->GetOutput();
}

// The deformed mesh of the last update.
vtkSmartPointer<vtkUnstructuredGrid> GetMesh(Session* session)
{
  const std::string fileName = GetFileName() + ".vtu";
  EXPECT_TRUE(session->SaveMesh(fileName));
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(fileName.c_str());
  reader->Update();
  return reader->GetOutput();
}

std::string ReadText(const std::string& fileName)
{
  std::ifstream file(fileName);
  return { std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>() };
}

TEST(DeformVolumeSession, Misuse)
{
  const auto volume = MakeVolume(Box);
  Tested empty(volume);
  vtkNew<vtkDeformVolumeSession> none;
  vtkNew<vtkTest::ErrorObserver> observer;
  none->AddObserver(vtkCommand::ErrorEvent, observer);
  EXPECT_EQ(none->BeginGrab(0, 0, 0), -1);
  EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "Call SetInputs() first"));
  EXPECT_TRUE(!none->Update() && !none->SaveSession("nothing"));
  EXPECT_FALSE(none->SetInputs(nullptr));
  EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "The volume is null"));
  observer->Clear();
  EXPECT_FALSE(none->SetInputs(MakeImage({ { 0, 9, 3, 3, 0, 7 } })));
  EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "no active point scalars"));
  observer->Clear();
  EXPECT_FALSE(none->SetInputs(MakeVolume({ { 0, 9, 3, 3, 0, 7 } })));
  EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "10 x 1 x 8 voxels"));
  const auto bitVolume = MakeImage(Box);
  vtkNew<vtkBitArray> bits;
  bits->SetNumberOfValues(bitVolume->GetNumberOfPoints());
  bits->Fill(1);
  bitVolume->GetPointData()->SetScalars(bits);
  observer->Clear();
  EXPECT_FALSE(none->SetInputs(bitVolume));
  EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "are a vtkBitArray"));
  none->Start();
  EXPECT_FALSE(none->GetIsRunning());
  EXPECT_FALSE(none->TakeOutput());

  Tested one(volume);
  one.Finish();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(one.Object->BeginGrab(nan, 0, 0), -1);
  EXPECT_TRUE(HasPart(one.TakeError(), "not finite"));
  one.Object->MoveGrab(3, 1, 1, 1);
  one.ExpectError("Handle 3 is not grabbed");
  one.Object->Release(2);
  one.ExpectError("Handle 2 holds nothing");
  one.Object->BeginGrab(-40, 0, 0);
  one.ExpectError("outside the deformed volume");
  one.Object->Cut(nullptr);
  EXPECT_TRUE(HasPart(one.TakeError(), "no triangles"));
  one.Object->Cut(MakePlane({ 8, 8, 8 }, { 9, 0, 0 }, { 0, 9, 0 }, false));
  EXPECT_TRUE(HasPart(one.TakeError(), "is not a triangle"));
  const auto sheet = MakePlane({ 8, 8, 8 }, { 9, 0, 0 }, { 0, 9, 0 });
  vtkNew<vtkCellArray> strips;
  strips->InsertNextCell({ 0, 1, 3, 4 });
  sheet->SetStrips(strips);
  one.Object->Cut(sheet);
  EXPECT_TRUE(HasPart(one.TakeError(), "has 1 triangle strips"));
  sheet->SetStrips(nullptr);
  sheet->GetPoints()->SetPoint(4, 8.0, nan, 8.0);
  one.Object->Cut(sheet);
  EXPECT_TRUE(HasPart(one.TakeError(), "Point 4 of the sheet is not finite"));
  sheet->GetPoints()->SetNumberOfPoints(3);
  one.Object->Cut(sheet);
  EXPECT_TRUE(HasPart(one.TakeError(), "refers to point 3, but the sheet has only 3 points"));
  sheet->GetPoints()->SetNumberOfPoints(2);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell({ 0, 1, 1 });
  sheet->SetPolys(cells);
  one.Object->Cut(sheet);
  EXPECT_TRUE(HasPart(one.TakeError(), "The sheet has only 2 points"));
  one.Object->CarveSphere(8, 8, 8, 0.0);
  one.ExpectError("The carving radius is 0.");
  one.Object->ChangeModel(9);
  one.ExpectError("The model is 9");
  one.Object->ChangeNumberOfNodes(1);
  one.ExpectError("from 2 to 100");
  one.Object->ChangeRelaxationSweeps(-1);
  one.ExpectError("sweeps");
  one.Object->ChangeUndoMemory(-1.0);
  one.ExpectError("The memory for undo is -1 bytes");
  one.Object->ChangeHandleRadius(-1.0);
  one.ExpectError("The handle radius is -1");
  one.Object->SetMovingSamplingFactor(3);
  one.ExpectError("MovingSamplingFactor is 3");
  EXPECT_EQ(one.Object->GetNumberOfActions(), 0);
  EXPECT_EQ(one.Object->GetMovingSamplingFactor(), 1);
  EXPECT_FALSE(one.Object->SaveMesh("nothing.vtu"));
  EXPECT_TRUE(HasPart(one.TakeError(), "no mesh"));
  EXPECT_FALSE(one.Object->SaveMesh("nothing"));
  EXPECT_TRUE(HasPart(one.TakeError(), "must end in .vtu"));
  EXPECT_FALSE(one.Object->SaveVolume("nothing.nii"));
  EXPECT_TRUE(HasPart(one.TakeError(), "must end in .vti"));
  one.Object->GetHandles(nullptr);
  EXPECT_TRUE(HasPart(one.TakeError(), "GetHandles() is null"));
  one.Object->Undo();
  one.Object->Redo();
  one.Finish();

  // A handle that is moved too far does not move, and the body does not change.
  one.Object->ChangeModel(Session::CHAIN_MAIL);
  const int handle = one.Object->BeginGrab(10, 10, 10);
  one.Object->MoveGrab(handle, 12, 10, 10);
  const auto before = one.Step();
  one.Object->ChangeRelaxationSweeps(0);
  const auto still = one.Step();
  one.Object->MoveGrab(handle, 1e6, 10, 10);
  one.ExpectError("is moved by more than 4095 voxels");
  EXPECT_FALSE(one.Object->GetErrorMessage().empty());
  const auto after = one.Step();
  EXPECT_TRUE(before && still && after && AreEqual(still, after));

  one.Object->Start();
  EXPECT_TRUE(one.Object->GetIsRunning());
  EXPECT_FALSE(one.Object->Update());
  EXPECT_TRUE(HasPart(one.TakeError(), "Call Stop()"));
}

// Checks that the output is the volume at rest, and that no other voxels are covered.
void VerifyRest(vtkImageData* output, vtkImageData* volume)
{
  EXPECT_TRUE(output);
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  vtkIdType covered = 0;
  bool isEqual = true;
  for (vtkIdType id = 0; id < output->GetNumberOfPoints(); ++id)
  {
    covered += mask->GetComponent(id, 0) != 0.0;
  }
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    const glm::dvec3 point = GetPoint(volume, id);
    const vtkIdType at = output->FindPoint(point.x, point.y, point.z);
    isEqual = isEqual && at >= 0 &&
      output->GetPointData()->GetScalars()->GetComponent(at, 0) ==
        volume->GetPointData()->GetScalars()->GetComponent(id, 0);
  }
  EXPECT_TRUE(isEqual);
  EXPECT_EQ(covered, volume->GetNumberOfPoints());
}

// A drag, compared with filters without a session.
TEST(DeformVolumeSession, Drag)
{
  const auto volume = MakeVolume(Box);
  Tested one(volume);
  VerifyRest(one.Finish(), volume);
  one.Object->ChangeModel(Session::CHAIN_MAIL);
  const int handle = one.Object->BeginGrab(10, 11, 9);
  one.Object->MoveGrab(handle, 14, 11, 8);
  const auto output = one.Step();

  Dragged model(volume);
  model.Filter->SetRelaxationSweeps(5);
  model.Update(); // the session executes the model when it is chosen
  model.Drag({ { { 10, 11, 9 }, { 14, 11, 8 } } });
  Deformed wanted(volume, model.Filter->GetOutput());
  wanted.Filter->SetOutputBoundsModeToVolumeBounds();
  wanted.Filter->SetPadding(8);
  wanted.Filter->SetBackgroundValue(one.Object->GetBackgroundValue());
  EXPECT_TRUE(AreEqual(output, wanted.Update()));

  EXPECT_TRUE(one.Object->Probe(14, 11, 8));
  const double* rest = one.Object->GetProbedRestPosition();
  EXPECT_TRUE(std::abs(rest[0] - 10) < 0.01 && std::abs(rest[1] - 11) < 0.01);
  vtkDataArray* values = volume->GetPointData()->GetScalars();
  EXPECT_EQ(one.Object->GetProbedValue(), values->GetComponent(volume->FindPoint(10, 11, 9), 0));
  EXPECT_FALSE(one.Object->Probe(-9, 2, 2));
  EXPECT_TRUE(one.Object->GetSimulationTime() > 0.0 && one.Object->GetResamplingTime() > 0.0);
}

// Smooth cuts and smooth boundaries, compared with filters without a session.
TEST(DeformVolumeSession, SmoothTools)
{
  const auto volume = MakeVolume(Box);
  const auto compare = [](
                         Tested& one, vtkImageData* output, vtkImageData* edited, vtkDataSet* moved)
  {
    Deformed wanted(edited, moved);
    wanted.Filter->SetOutputBoundsModeToVolumeBounds();
    wanted.Filter->SetPadding(8);
    wanted.Filter->SetBackgroundValue(one.Object->GetBackgroundValue());
    EXPECT_TRUE(AreEqual(output, wanted.Update()));
  };
  const auto sheet = MakePlane({ 8.3, 10.4, 8.6 }, { 0, 40, 2 }, { 1, 0, 40 });
  Tested cut(volume);
  cut.Object->ChangeModel(Session::CHAIN_MAIL);
  cut.Object->Cut(sheet);
  const int handle = cut.Object->BeginGrab(12, 10, 9);
  cut.Object->MoveGrab(handle, 15, 10, 9);
  const auto opened = cut.Step();
  vtkNew<vtkCutVolume> knife;
  knife->SetInputData(volume);
  knife->SetSheetData(sheet);
  knife->SmoothCutOn();
  knife->Update();
  Dragged model(knife->GetOutput());
  model.Filter->SetRelaxationSweeps(5);
  model.Update(); // the session executes the model when it is chosen
  model.Drag({ { { 12, 10, 9 }, { 15, 10, 9 } } });
  compare(cut, opened, knife->GetOutput(), model.Filter->GetOutput());

  Tested carved(volume);
  carved.Object->CarveSphere(12, 10, 9, 4.3);
  const auto hollow = carved.Finish();
  vtkNew<vtkCarveVolume> carve;
  carve->SetInputData(volume);
  carve->SmoothBoundaryOn();
  carve->SetToolRadius(4.3);
  carve->AddToolPosition(12, 10, 9);
  carve->Update();
  const auto still = MakeMesh(volume, 2, 1.0);
  SetDisplacements(still, Shift(0.0, 0.0, 0.0));
  compare(carved, hollow, carve->GetOutput(), still);
}

// An expected handle of a session.
struct ExpectedHandle
{
  int Number;
  glm::dvec3 Now;
  glm::dvec3 Rest;
  bool IsGrabbed;
};

bool HasHandles(Session* session, const std::vector<ExpectedHandle>& wanted)
{
  vtkNew<vtkPolyData> handles;
  session->GetHandles(handles);
  vtkPointData* data = handles->GetPointData();
  bool isEqual = handles->GetNumberOfPoints() == static_cast<vtkIdType>(wanted.size());
  for (vtkIdType id = 0; isEqual && id < handles->GetNumberOfPoints(); ++id)
  {
    const ExpectedHandle& one = wanted[static_cast<std::size_t>(id)];
    glm::dvec3 rest(0.0);
    data->GetArray("RestPosition")->GetTuple(id, &rest.x);
    const double* now = handles->GetPoint(id);
    isEqual = data->GetArray("Handle")->GetComponent(id, 0) == one.Number &&
      (data->GetArray("Grabbed")->GetComponent(id, 0) != 0.0) == one.IsGrabbed &&
      glm::length(rest - one.Rest) < 1e-6 &&
      glm::length(glm::dvec3(now[0], now[1], now[2]) - one.Now) < 1e-6;
  }
  return isEqual;
}

TEST(DeformVolumeSession, Handles)
{
  const auto volume = MakeVolume(Box);
  const std::string fileName = GetFileName();
  Tested one(volume);
  Session* session = one.Object;
  EXPECT_TRUE(HasHandles(session, {}));
  session->ChangeModel(Session::CHAIN_MAIL);
  const int pin = session->Pin(4, 5, 6);
  const int grab = session->BeginGrab(10, 11, 9);
  session->MoveGrab(grab, 12, 11, 9);
  EXPECT_TRUE(HasHandles(session, {})); // handles are those of the last update
  one.Step();
  const ExpectedHandle pinned{ pin, { 4, 5, 6 }, { 4, 5, 6 }, false };
  ExpectedHandle pulled{ grab, { 12, 11, 9 }, { 10, 11, 9 }, true };
  EXPECT_TRUE(HasHandles(session, { pinned, pulled }));
  // A move that fails does not change the handle.
  session->MoveGrab(grab, 1e30, 11, 9);
  one.Step();
  EXPECT_FALSE(one.TakeError().empty());
  EXPECT_TRUE(HasHandles(session, { pinned, pulled }));
  session->HoldGrab(grab);
  one.Step();
  pulled.IsGrabbed = false;
  EXPECT_TRUE(HasHandles(session, { pinned, pulled }));
  EXPECT_TRUE(session->SaveSession(fileName));
  session->Release(pin);
  one.Step();
  EXPECT_TRUE(HasHandles(session, { pulled }));
  session->Undo();
  one.Step();
  EXPECT_TRUE(HasHandles(session, { pinned, pulled }));
  // Another session has the handles of a loaded file, and can release them.
  Tested other(volume);
  EXPECT_TRUE(other.Object->LoadSession(fileName));
  other.Step();
  EXPECT_TRUE(HasHandles(other.Object, { pinned, pulled }));
  other.Object->Release(grab);
  other.Step();
  EXPECT_TRUE(HasHandles(other.Object, { pinned }));
  EXPECT_TRUE(other.Object->SetInputs(volume));
  EXPECT_TRUE(HasHandles(other.Object, {}));
}

// A simulation of springs that diverges, and a handle outside the volume: one error each, and the
// session works afterwards.
TEST(DeformVolumeSession, Recovery)
{
  const auto volume = MakeVolume(Box);
  Tested one(volume);
  Session* session = one.Object;
  session->ChangeModel(Session::MASS_SPRING);
  const int handle = session->BeginGrab(10, 10, 17);
  one.Step();
  EXPECT_TRUE(HasHandles(session, { { handle, { 10, 10, 17 }, { 10, 10, 17 }, true } }));
  session->MoveGrab(handle, 1e7, 10, 17);
  one.Step();
  EXPECT_TRUE(HasPart(one.TakeError(), "diverged"));
  EXPECT_TRUE(HasHandles(session, { { handle, { 10, 10, 17 }, { 10, 10, 17 }, true } }));
  session->MoveGrab(handle, 11, 10, 17);
  EXPECT_NE(one.Step(), nullptr);
  EXPECT_EQ(one.TakeError(), "");

  const int nowhere = session->BeginGrab(1000, 10, 17);
  session->MoveGrab(nowhere, 1001, 10, 17);
  session->HoldGrab(nowhere);
  one.Step();
  const std::string error = one.TakeError();
  EXPECT_TRUE(HasPart(error, "outside the deformed volume"));
  EXPECT_FALSE(HasPart(error, "not grabbed"));
  session->Reset();
  VerifyRest(one.Finish(), volume);
  EXPECT_EQ(one.TakeError(), "");

  // The deformation has no inverse so far away.
  Tested far(volume);
  far.Object->ChangeModel(Session::FINITE_ELEMENTS);
  const int pulled = far.Object->BeginGrab(10, 10, 17);
  far.Object->MoveGrab(pulled, 13, 11, 18);
  far.Step();
  far.Object->BeginGrab(1e300, 1e300, 1e300);
  far.ExpectError("is outside the deformed volume");

  // The model can move so far, but the resampler cannot.
  far.Object->MoveGrab(pulled, 2e4, 10, 17);
  far.ExpectError("more than 16,383 voxels");
  EXPECT_TRUE(HasHandles(far.Object, { { pulled, { 13, 11, 18 }, { 10, 10, 17 }, true } }));
  EXPECT_NE(far.Finish(), nullptr);

  // Tissue that moves goes on after a handle has failed.
  Tested moving(volume);
  moving.Object->ChangeModel(Session::CHAIN_MAIL);
  const int dragged = moving.Object->BeginGrab(10, 10, 10);
  moving.Object->MoveGrab(dragged, 18, 10, 10);
  EXPECT_TRUE(moving.Object->Update());
  moving.Object->MoveGrab(dragged, 1e5, 10, 10);
  EXPECT_TRUE(moving.Object->Update());
  EXPECT_NE(moving.TakeError(), "");
  EXPECT_NE(moving.Finish(), nullptr);
}

// A position outside a rotated volume, but within its bounds, cannot be grabbed, and the other
// handles stay. A position a little outside holds the tissue at the border.
TEST(DeformVolumeSession, ObliqueVolume)
{
  const auto volume = MakeVolume(Box);
  SetObliqueDirection(volume);
  Tested one(volume);
  Session* session = one.Object;
  session->ChangeModel(Session::CHAIN_MAIL);
  const glm::dvec3 outside = GetWorld(volume, { Box[0] - 0.4, 10, 18.7 });
  const glm::dvec3 border = GetWorld(volume, { Box[0], 10, 18 });
  const int pin = session->Pin(outside.x, outside.y, outside.z);
  const glm::dvec3 rest = GetWorld(volume, { 15, 11, 9 });
  const glm::dvec3 now = GetWorld(volume, { 17, 11, 9 });
  const int grab = session->BeginGrab(rest.x, rest.y, rest.z);
  session->MoveGrab(grab, now.x, now.y, now.z);
  session->HoldGrab(grab);
  one.Step();
  const std::vector<ExpectedHandle> wanted = { { pin, border, border, false },
    { grab, now, rest, false } };
  EXPECT_EQ(one.TakeError(), "");
  EXPECT_TRUE(HasHandles(session, wanted));

  const double* bounds = volume->GetBounds();
  session->BeginGrab(bounds[0] + 1.0, bounds[2] + 1.0, bounds[4] + 1.0);
  one.ExpectError("outside the deformed volume");
  EXPECT_TRUE(HasHandles(session, wanted));
  EXPECT_EQ(session->GetNumberOfActions(), 3);
}

// Positions between voxels are grabbed exactly, and the body comes to rest.
TEST(DeformVolumeSession, NegativeSpacing)
{
  auto volume = MakeImage(Box, { 1.0, 1.0, -1.0 });
  AddScalars<short>(volume, "value", [](const glm::dvec3& p) { return p.x + 9.0 * p.z; });
  for (const int model : { Session::CHAIN_MAIL, Session::FINITE_ELEMENTS })
  {
    Tested one(volume);
    Session* session = one.Object;
    session->ChangeModel(model);
    const glm::dvec3 rest(10.3, 11.2, -8.6);
    const int handle = session->BeginGrab(rest.x, rest.y, rest.z);
    one.Step();
    EXPECT_TRUE(HasHandles(session, { { handle, rest, rest, true } }));
    session->MoveGrab(handle, 12.3, 11.2, -8.6);
    one.Finish();
    EXPECT_FALSE(session->GetIsBusy());
  }
}

// Actions that are made twice are undone twice. The body is pulled apart, so that cuts are visible.
TEST(DeformVolumeSession, Twice)
{
  const auto volume = MakeVolume(Box);
  Tested one(volume);
  one.Object->ChangeModel(Session::CHAIN_MAIL);
  const auto rest = one.Step();
  const auto sheet = MakePlane({ 8.3, 10.4, 8.6 }, { 0, 40, 2 }, { 1, 0, 40 });
  one.Object->Cut(sheet);
  one.Object->Cut(sheet);
  const int handle = one.Object->BeginGrab(20, 10, 9);
  one.Object->MoveGrab(handle, 24, 10, 9);
  one.Object->EndGrab(handle);
  const auto whole = one.Step(); // the drag ended before the step
  EXPECT_TRUE(AreEqual(whole, rest));
  const int other = one.Object->BeginGrab(20, 10, 9);
  one.Object->MoveGrab(other, 24, 10, 9);
  const auto apart = one.Step();
  one.Object->EndGrab(other);
  for (int i = 0; i < 3; ++i)
  {
    one.Object->CarveSphere(14, 14, 9, 2.0 + i);
    one.Object->CarveTo(14, 14, 9, 2.5 + i);
  }
  const auto carved = one.Step();
  EXPECT_TRUE(!AreEqual(whole, apart) && !AreEqual(apart, carved));
  for (int i = 0; i < 2; ++i)
  {
    one.Object->Undo();
  }
  const auto carvedOnce = one.Step();
  EXPECT_TRUE(!AreEqual(carvedOnce, apart) && !AreEqual(carvedOnce, carved));
  one.Object->Undo();
  EXPECT_TRUE(AreEqual(one.Step(), apart));
  EXPECT_EQ(one.Object->GetNumberOfActions(), 5);
  for (int i = 0; i < 4; ++i)
  {
    one.Object->Undo();
  }
  EXPECT_TRUE(AreEqual(one.Step(), rest));
  for (int i = 0; i < 5; ++i)
  {
    one.Object->Redo();
  }
  EXPECT_TRUE(AreEqual(one.Step(), carvedOnce));
  one.Object->Redo();
  one.Object->Redo();
  EXPECT_TRUE(AreEqual(one.Step(), carved));
  EXPECT_EQ(one.TakeError(), "");
}

class RandomSession
{
public:
  RandomSession(vtkImageData* volume, unsigned seed)
    : Random(seed)
    , One(volume)
  {
  }

  void MakeEvent()
  {
    Session* session = this->One.Object;
    const glm::dvec3 position = this->GetPosition();
    // Loading a session repeats all actions, so their number is limited.
    constexpr vtkIdType mostActions = 150;
    if (session->GetNumberOfActions() > mostActions)
    {
      session->Reset();
    }
    switch (this->Random() % 16)
    {
      case 0:
        session->ChangeModel(static_cast<int>(this->Random() % 4));
        break;
      case 1:
        session->Cut(MakePlane(position, { 0, this->GetNumber(3, 20), 2 }, { 1, 0, 9 }));
        break;
      case 2:
        session->CarveSphere(position.x, position.y, position.z, this->GetNumber(0.5, 3));
        break;
      case 3:
        session->CarveTo(position.x, position.y, position.z, this->GetNumber(0.5, 3));
        break;
      case 4:
      case 5:
        session->Undo();
        break;
      case 6:
        session->Redo();
        break;
      case 7:
        this->Handle = session->BeginGrab(position.x, position.y, position.z);
        break;
      case 8:
        session->EndGrab(this->Handle);
        break;
      case 9:
        session->HoldGrab(this->Handle);
        break;
      case 10:
        session->Release(this->Handle);
        break;
      case 11:
        session->Pin(position.x, position.y, position.z);
        break;
      default:
        session->MoveGrab(this->Handle, position.x, position.y, position.z);
    }
    if (this->Random() % 2 == 0)
    {
      this->One.Step();
      // Possible errors: a released handle is moved, two handles hold the same node, or the
      // simulation of springs diverges.
      const std::string error = this->One.TakeError();
      if (!error.empty() && error.find("is not grabbed") == std::string::npos &&
        error.find("holds nothing") == std::string::npos &&
        error.find("has diverged") == std::string::npos &&
        error.find("holds no node") == std::string::npos &&
        error.find("released already") == std::string::npos &&
        error.find("outside the deformed volume") == std::string::npos)
      {
        EXPECT_EQ(error, "");
      }
    }
  }

  double GetNumber(double low, double high)
  {
    return std::uniform_real_distribution<double>(low, high)(this->Random);
  }
  glm::dvec3 GetPosition()
  {
    return { this->GetNumber(Box[0], Box[1]), this->GetNumber(Box[2], Box[3]),
      this->GetNumber(Box[4], Box[5]) };
  }

  std::mt19937 Random;
  Tested One;
  int Handle = 0;
};

// --gtest_random_seed=N selects other events.
TEST(DeformVolumeSession, Random)
{
  const auto volume = MakeVolume(Box);
  const std::string fileName = GetFileName();
  RandomSession random(volume, 1 + static_cast<unsigned>(GTEST_FLAG_GET(random_seed)));
  Tested& one = random.One;
  const auto first = one.Finish();
  // The memory for undo is less than random actions need, so that some are undone without saved
  // states.
  one.Object->ChangeUndoMemory(4e6);
  for (int i = 0; i < 300 && !HasFailure(); ++i)
  {
    random.MakeEvent();
  }
  one.Step();
  one.TakeError();
  EXPECT_GT(one.Object->GetNumberOfActions(), 0);

  // A session from a file has the same output and the same actions for undo and redo. Loading it
  // removes all previous actions.
  EXPECT_TRUE(one.Object->SaveSession(fileName));
  Tested other(volume);
  other.Object->ChangeModel(Session::CHAIN_MAIL);
  const int pulled = other.Object->BeginGrab(10, 10, 10);
  other.Object->MoveGrab(pulled, 14, 10, 10);
  other.Step();
  other.Object->HoldGrab(pulled);
  other.Object->Cut(MakePlane({ 12, 10, 10 }, { 0, 12, 2 }, { 1, 0, 12 }));
  other.Object->CarveSphere(6, 6, 6, 3);
  other.Step();
  EXPECT_TRUE(other.Object->LoadSession(fileName));
  const auto saved = one.Step();
  const auto loaded = other.Step();
  EXPECT_TRUE(AreEqual(saved, loaded));
  EXPECT_EQ(other.TakeError(), "");
  EXPECT_EQ(other.Object->GetModel(), one.Object->GetModel());
  EXPECT_EQ(other.Object->GetNumberOfActions(), one.Object->GetNumberOfActions());
  EXPECT_EQ(other.Object->GetNumberOfUndoneActions(), one.Object->GetNumberOfUndoneActions());

  // One session undoes all actions, the other one is reset; then both redo all actions.
  const vtkIdType actions = one.Object->GetNumberOfActions();
  const int model = one.Object->GetModel();
  for (vtkIdType i = 0; i < actions; ++i)
  {
    one.Object->Undo();
  }
  const auto undone = one.Step();
  EXPECT_EQ(one.TakeError(), "");
  EXPECT_TRUE(AreEqual(first, undone));
  EXPECT_EQ(one.Object->GetNumberOfActions(), 0);
  EXPECT_EQ(one.Object->GetModel(), int(Session::NONE));
  other.Object->Reset();
  const auto reset = other.Step();
  EXPECT_TRUE(AreEqual(first, reset));
  VerifyRest(reset, volume);
  EXPECT_EQ(other.Object->GetNumberOfUndoneActions(), one.Object->GetNumberOfUndoneActions());
  for (vtkIdType i = 0; i < actions; ++i)
  {
    one.Object->Redo();
    other.Object->Redo();
  }
  const auto redone = one.Step();
  EXPECT_TRUE(AreEqual(redone, other.Step()));
  EXPECT_EQ(one.Object->GetNumberOfActions(), actions);
  EXPECT_EQ(one.Object->GetModel(), model);
}

void WriteText(const std::string& fileName, const std::string& text)
{
  std::ofstream(fileName) << text;
}

std::string Replace(std::string text, const std::string& from, const std::string& to)
{
  const std::size_t at = text.find(from);
  EXPECT_TRUE(HasPart(text, from));
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// Tissue that is pulled out of the extent of the output causes one warning.
TEST(DeformVolumeSession, Padding)
{
  const auto volume = MakeVolume(Box);
  for (const int padding : { 8, 30 })
  {
    Tested one(volume);
    vtkNew<vtkTest::ErrorObserver> warnings;
    one.Object->AddObserver(vtkCommand::WarningEvent, warnings);
    one.Object->SetPadding(padding);
    one.Object->ChangeModel(Session::CHAIN_MAIL);
    const int handle = one.Object->BeginGrab(10, 10, 17);
    one.Object->MoveGrab(handle, 10, 10, 24);
    one.Finish();
    EXPECT_FALSE(warnings->GetWarning());
    one.Object->MoveGrab(handle, 10, 10, 45);
    one.Finish();
    if (padding == 8)
    {
      EXPECT_TRUE(HasPart(warnings->GetWarningMessage(), "lies outside the output"));
    }
    else
    {
      EXPECT_FALSE(HasPart(warnings->GetWarningMessage(), "larger Padding"));
    }
    warnings->Clear();
    one.Object->MoveGrab(handle, 10, 10, 46);
    one.Finish();
    EXPECT_FALSE(warnings->GetWarning());
  }
}

TEST(DeformVolumeSession, Files)
{
  const auto volume = MakeVolume(Box);
  const std::string fileName = GetFileName();
  Tested one(volume);
  one.Object->ChangeModel(Session::FINITE_ELEMENTS);
  const int handle = one.Object->BeginGrab(10, 10, 17);
  one.Object->MoveGrab(handle, 13, 10, 17);
  one.Finish();
  const auto before = one.Step();
  EXPECT_TRUE(one.Object->SaveSession(fileName));
  EXPECT_TRUE(one.Object->SaveVolume(fileName + ".vti") && one.Object->SaveMesh(fileName + ".vtu"));
  const std::string text = ReadText(fileName);
  for (const char* const type : { ".vti", ".vtu" })
  {
    // Data is inline, since some versions of ParaView cannot read raw appended data.
    EXPECT_FALSE(HasPart(ReadText(fileName + type), "<AppendedData"));
  }

  const std::string damaged = fileName + ".wrong"; // messages contain the name
  const struct
  {
    std::string Text;
    const char* Words;
  } cases[] = {
    { "", "it is damaged" },
    { "no session", "it is damaged" },
    { text.substr(0, text.size() / 2), "it is damaged" },
    { Replace(text, "version=\"1\" inputs", "version=\"2\" inputs"), "has version 2" },
    { Replace(text, "MoveGrab 0 13 ", "MoveGrab 0 12 "), "checksum" },
    { Replace(text, "MoveGrab", "Move"), "there is no event" },
    { Replace(text, "MoveGrab 0 13 ", "MoveGrab 0 "), "invalid arguments" },
    { Replace(text, "MoveGrab 0 13 ", "MoveGrab 0 nan "), "finite" },
    { Replace(text, "MoveGrab 0 13 ", "MoveGrab 0 1e999 "), "finite" },
  };
  for (const auto& wrong : cases)
  {
    WriteText(damaged, wrong.Text);
    EXPECT_FALSE(one.Object->LoadSession(damaged));
    EXPECT_TRUE(HasPart(one.TakeError(), wrong.Words));
  }
  EXPECT_FALSE(one.Object->LoadSession(fileName + ".missing"));
  EXPECT_TRUE(HasPart(one.TakeError(), "cannot be read"));
  EXPECT_TRUE(AreEqual(before, one.Step()));

  Tested foreign(MakeVolume({ { 0, 9, 0, 8, 0, 7 } }));
  EXPECT_FALSE(foreign.Object->LoadSession(fileName));
  EXPECT_TRUE(HasPart(foreign.TakeError(), "another volume"));
  vtkNew<vtkImageData> stretched;
  stretched->ShallowCopy(volume);
  stretched->SetSpacing(1.0, 1.0, 1.5 * volume->GetSpacing()[2]);
  Tested other(stretched);
  EXPECT_FALSE(other.Object->LoadSession(fileName));
  EXPECT_TRUE(HasPart(other.TakeError(), "another volume"));

  // The same mesh with other fixed nodes.
  const auto mesh = MakeMesh(volume, 2, 1.0);
  const auto fixed = MakeArray<vtkUnsignedCharArray>("Fixed", mesh->GetNumberOfPoints());
  fixed->SetValue(0, 1);
  mesh->GetPointData()->AddArray(fixed);
  EXPECT_TRUE(
    other.Object->SetInputs(volume, mesh) && other.Object->SaveSession(fileName + ".mesh"));
  EXPECT_TRUE(
    other.Object->SetInputs(volume, mesh) && other.Object->LoadSession(fileName + ".mesh"));
  // A file of version 0.1 has no hash of the arrays.
  std::string old = ReadText(fileName + ".mesh");
  const std::size_t space = old.find(' ', old.find("inputs="));
  old.erase(space, old.find('"', space) - space);
  WriteText(fileName + ".old", old);
  EXPECT_TRUE(
    other.Object->SetInputs(volume, mesh) && other.Object->LoadSession(fileName + ".old"));
  fixed->SetValue(1, 1);
  EXPECT_TRUE(other.Object->SetInputs(volume, mesh));
  EXPECT_FALSE(other.Object->LoadSession(fileName + ".mesh"));
  EXPECT_TRUE(HasPart(other.TakeError(), "another volume or mesh"));
  mesh->GetPointData()->RemoveArray("Fixed");
  EXPECT_TRUE(other.Object->SetInputs(volume, mesh));
  EXPECT_FALSE(other.Object->LoadSession(fileName + ".mesh"));
  EXPECT_TRUE(HasPart(other.TakeError(), "another volume or mesh"));

  // The same values with another array of active scalars, other bits or other active tetrahedra.
  const auto other1 = MakeArray<vtkUnsignedCharArray>("Other", volume->GetNumberOfPoints());
  other1->Fill(1);
  vtkNew<vtkBitArray> bits;
  bits->SetName("Bits");
  bits->SetNumberOfValues(volume->GetNumberOfPoints());
  bits->Fill(1);
  const auto active =
    MakeArray<vtkUnsignedCharArray>("ActiveTetrahedra", volume->GetNumberOfCells());
  active->Fill(31);
  vtkNew<vtkImageData> recorded;
  recorded->ShallowCopy(volume);
  recorded->GetPointData()->AddArray(other1);
  recorded->GetPointData()->AddArray(bits);
  recorded->GetCellData()->AddArray(active);
  const auto isLoaded = [&]
  { return other.Object->SetInputs(recorded) && other.Object->LoadSession(fileName + ".arrays"); };
  EXPECT_TRUE(other.Object->SetInputs(recorded) && other.Object->SaveSession(fileName + ".arrays"));
  EXPECT_TRUE(isLoaded());
  bits->SetValue(7, 0);
  EXPECT_FALSE(isLoaded());
  bits->SetValue(7, 1);
  active->SetValue(7, 0);
  EXPECT_FALSE(isLoaded());
  active->SetValue(7, 31);
  recorded->GetPointData()->SetActiveScalars("Other");
  EXPECT_FALSE(isLoaded());
  recorded->GetPointData()->SetActiveScalars(volume->GetPointData()->GetScalars()->GetName());
  EXPECT_TRUE(isLoaded());
  other.TakeError();

  // A folder that does not exist, and a full disk: the previous file is kept.
  EXPECT_FALSE(one.Object->SaveSession("/dev/null/session"));
  EXPECT_TRUE(HasPart(one.TakeError(), "cannot be written"));
  EXPECT_FALSE(one.Object->SaveVolume("/dev/null/volume.vti"));
  EXPECT_TRUE(HasPart(one.TakeError(), "cannot be written"));
  struct rlimit limit;
  getrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small
  {
    100, limit.rlim_max
  };
  setrlimit(RLIMIT_FSIZE, &small);
  const bool isSaved = one.Object->SaveSession(fileName);
  const bool isVolumeSaved = one.Object->SaveVolume(fileName + ".vti");
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_TRUE(!isSaved && !isVolumeSaved);
  EXPECT_TRUE(HasPart(one.TakeError(), "cannot be written"));
  EXPECT_EQ(ReadText(fileName), text);
  EXPECT_FALSE(vtksys::SystemTools::FileExists(fileName + ".part"));
  EXPECT_TRUE(one.Object->LoadSession(fileName));
  EXPECT_TRUE(AreEqual(before, one.Step()));
}

// Finite elements use a lattice with half as many cells on each axis and with mid-side nodes.
// Probed rest positions are inverse to vtkDeformGeometryFilter.
TEST(DeformVolumeSession, TenNodeElements)
{
  const auto volume = MakeVolume(Box);
  Tested one(volume);
  one.Object->ChangeModel(Session::FINITE_ELEMENTS);
  const int handle = one.Object->BeginGrab(10, 10, 17);
  one.Object->MoveGrab(handle, 14, 11, 18);
  one.Finish();
  const auto mesh = GetMesh(one.Object); // moved to rest below
  vtkDataArray* vectors = mesh->GetPointData()->GetArray("Displacement");
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    double by[3];
    vectors->GetTuple(i, by);
    const glm::dvec3 rest = GetPoint(mesh, i) - glm::dvec3(by[0], by[1], by[2]);
    mesh->GetPoints()->SetPoint(i, &rest.x);
  }
  // Corners and mid-side nodes are a lattice of at most seven nodes on each axis, without the
  // centers of the cubes.
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputData(volume);
  lattice->SetNumberOfNodes(4, 4, 4);
  lattice->Update();
  const int* dimensions = lattice->GetDimensions();
  vtkIdType nodes = 1;
  vtkIdType cubes = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    nodes *= 2 * dimensions[axis] - 1;
    cubes *= dimensions[axis] - 1;
  }
  EXPECT_EQ(mesh->GetNumberOfPoints(), nodes - cubes);
  EXPECT_EQ(mesh->GetCellType(0), static_cast<int>(VTK_QUADRATIC_TETRA));

  vtkNew<vtkPoints> points;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> coordinate(2.0, 15.0);
  for (int i = 0; i < 50; ++i)
  {
    points->InsertNextPoint(coordinate(random), coordinate(random), coordinate(random));
  }
  vtkNew<vtkPolyData> geometry;
  geometry->SetPoints(points);
  vtkNew<vtkDeformGeometryFilter> deform;
  deform->SetInputData(geometry);
  deform->SetDeformationData(mesh);
  deform->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Displacement");
  deform->Update();
  double most = 0.0;
  double worst = 0.0;
  for (vtkIdType i = 0; i < 50; ++i)
  {
    const glm::dvec3 rest = GetPoint(geometry, i);
    const glm::dvec3 now = GetPoint(deform->GetOutput(), i);
    most = std::max(most, glm::distance(rest, now));
    EXPECT_TRUE(one.Object->Probe(now.x, now.y, now.z));
    double found[3];
    one.Object->GetProbedRestPosition(found);
    worst = std::max(worst, glm::distance(rest, glm::dvec3(found[0], found[1], found[2])));
  }
  std::cout << "displacements of up to " << most << " are inverted within " << worst << "\n";
  EXPECT_TRUE(most > 1.0 && worst < 1e-5); // points and vectors are floats
}

// Tissue between the nodes of a mesh follows its handle.
TEST(DeformVolumeSession, GrabbedTissue)
{
  const auto volume = MakeVolume(Box);
  for (const int model : { Session::MASS_SPRING, Session::FINITE_ELEMENTS })
  {
    for (const double radius : { 0.0, 0.5 })
    {
      Tested one(volume);
      one.Object->ChangeModel(model);
      one.Object->ChangeHandleRadius(radius);
      const int handle = one.Object->BeginGrab(9.3, 10.1, 12.2);
      one.Object->MoveGrab(handle, 12.3, 11.1, 12.7);
      one.Finish();
      EXPECT_TRUE(one.Object->Probe(12.3, 11.1, 12.7));
      glm::dvec3 rest;
      one.Object->GetProbedRestPosition(&rest.x);
      EXPECT_LT(glm::distance(rest, glm::dvec3(9.3, 10.1, 12.2)), 1e-4);
    }
  }
}

// Holes and gaps have no tissue to grab.
TEST(DeformVolumeSession, GrabsWithoutTissue)
{
  const auto volume = MakeVolume(Box);
  for (const int model : { Session::CHAIN_MAIL, Session::MASS_SPRING, Session::FINITE_ELEMENTS })
  {
    Tested carved(volume);
    carved.Object->ChangeModel(model);
    carved.Object->CarveSphere(10, 11, 9, 5.0);
    carved.Finish();
    carved.Object->BeginGrab(10, 11, 9);
    carved.ExpectError("outside the deformed volume");
    EXPECT_FALSE(carved.Object->Probe(10, 11, 9));
    carved.Object->BeginGrab(10, 11, 14.5); // beside the hole
    carved.Step();
    EXPECT_EQ(carved.TakeError(), "");
    if (model == Session::FINITE_ELEMENTS)
    {
      continue; // its cut follows the coarse lattice, and opens elsewhere
    }

    Tested cut(volume);
    cut.Object->ChangeModel(model);
    cut.Object->ChangeHandleRadius(3.0);
    cut.Object->ChangeRelaxationSweeps(0);
    cut.Object->Cut(MakePlane({ 11.4, 13, 14 }, { 0, 60, 0 }, { 0, 0, 24 }));
    const int left = cut.Object->BeginGrab(8, 12, 16);
    const int right = cut.Object->BeginGrab(15, 12, 16);
    cut.Object->MoveGrab(left, 4, 12, 16);
    cut.Object->MoveGrab(right, 19, 12, 16);
    cut.Finish(40);
    EXPECT_FALSE(cut.Object->Probe(11.4, 12, 16));
    cut.Object->BeginGrab(11.4, 12, 16);
    cut.ExpectError("outside the deformed volume");
  }
}

// Labels are not blended, and the deformation can be used by other filters.
TEST(DeformVolumeSession, LabelsAndOtherData)
{
  const auto volume = MakeVolume(Box);
  vtkNew<vtkUnsignedCharArray> labels;
  labels->SetName("Labels");
  labels->SetNumberOfTuples(volume->GetNumberOfPoints());
  for (vtkIdType id = 0; id < volume->GetNumberOfPoints(); ++id)
  {
    labels->SetValue(id, volume->GetPoint(id)[0] < 10.0 ? 10 : 50);
  }
  volume->GetPointData()->AddArray(labels);
  for (const int model : { Session::CHAIN_MAIL, Session::FINITE_ELEMENTS })
  {
    Tested one(volume);
    one.Object->AddCategoricalArray("Labels");
    one.Object->ChangeModel(model);
    one.Object->ChangeHandleRadius(2.0);
    one.Object->MoveGrab(one.Object->BeginGrab(10, 11, 9), 13.3, 11.2, 9);
    const auto output = one.Finish();
    vtkDataArray* values = output->GetPointData()->GetArray("Labels");
    std::set<double> found;
    for (vtkIdType id = 0; id < values->GetNumberOfTuples(); ++id)
    {
      found.insert(values->GetComponent(id, 0));
    }
    EXPECT_EQ(found, (std::set<double>{ 0.0, 10.0, 50.0 }));

    const auto deformation = vtkSmartPointer<vtkDataSet>::Take(one.Object->CopyDeformation());
    Deformed wanted(volume, deformation);
    wanted.Filter->AddCategoricalArray("Labels");
    wanted.Filter->SetOutputBoundsModeToVolumeBounds();
    wanted.Filter->SetPadding(8);
    wanted.Filter->SetBackgroundValue(one.Object->GetBackgroundValue());
    EXPECT_TRUE(AreEqual(output, wanted.Update()));
    one.Object->ClearCategoricalArrays();
    EXPECT_FALSE(AreEqual(one.Finish(), output));
  }
}

// A volume of two slices has no coarse volume.
TEST(DeformVolumeSession, ThinVolumes)
{
  for (const int slices : { 2, 3, 4 })
  {
    Tested one(MakeVolume({ { 0, 19, 0, 19, 1, slices } }));
    one.Object->SetMovingSamplingFactor(4);
    one.Object->ChangeModel(Session::CHAIN_MAIL);
    one.Object->MoveGrab(one.Object->BeginGrab(10, 10, 1), 13, 10, 1);
    one.Object->Update();
    EXPECT_TRUE(one.Step());
    EXPECT_EQ(one.TakeError(), "");
  }
}

// Errors of filters have no events if VTK displays no warnings. They are noticed nevertheless.
TEST(DeformVolumeSession, FailuresWithoutMessages)
{
  for (const int model : { Session::CHAIN_MAIL, Session::MASS_SPRING, Session::FINITE_ELEMENTS })
  {
    Tested one(MakeVolume(Box));
    one.Object->ChangeModel(model);
    one.Finish();
    const int handle = one.Object->BeginGrab(10, 10, 17);
    vtkObject::GlobalWarningDisplayOff();
    one.Object->MoveGrab(handle, 1e300, 10, 17);
    one.Object->Update();
    EXPECT_TRUE(HasPart(one.Object->GetErrorMessage(), "GlobalWarningDisplayOn()"));
    one.Object->MoveGrab(handle, 11, 10, 17);
    vtkObject::GlobalWarningDisplayOn();
    one.Finish();
    EXPECT_EQ(one.Object->GetModel(), model);
  }
}

// A cut that fails, for a handle cannot be moved so far, does not prevent the next one.
TEST(DeformVolumeSession, CutsAfterFailures)
{
  for (const int model : { Session::MASS_SPRING, Session::FINITE_ELEMENTS })
  {
    Tested one(MakeVolume(Box));
    one.Object->ChangeModel(model);
    const int handle = one.Object->BeginGrab(10, 10, 17);
    one.Finish();
    const auto sheet = MakePlane({ 11, 12, 9 }, { 60, 0, 0 }, { 0, 60, 0 });
    one.Object->MoveGrab(handle, 1e300, 10, 17);
    one.Object->Cut(sheet);
    one.Object->Cut(sheet);
    one.Object->BeginGrab(12, 13, 12);
    one.Object->Update();
    EXPECT_FALSE(one.TakeError().empty());
    one.Object->Reset();
    one.Finish();
    one.Object->Cut(sheet);
    EXPECT_TRUE(one.Finish());
    EXPECT_EQ(one.Object->GetNumberOfActions(), 1);
  }
}

// Events that fail do not change what can be redone, and end a stroke.
TEST(DeformVolumeSession, FailuresKeepHistory)
{
  const auto volume = MakeVolume(Box);
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputData(volume);
  lattice->Update();
  lattice->GetOutput()->GetPoints()->SetPoint(0, -2.5, 1.0, 0.0); // no cube: not for MASS_SPRING
  Tested one(volume);
  Session* session = one.Object;
  EXPECT_TRUE(session->SetInputs(volume, lattice->GetOutput()));
  session->ChangeModel(Session::CHAIN_MAIL);
  const int pulled = session->BeginGrab(10, 10, 10);
  session->MoveGrab(pulled, 14, 10, 10);
  one.Step();
  session->EndGrab(pulled);
  const auto before = one.Finish();
  session->Undo();
  one.Finish();
  session->ChangeModel(Session::MASS_SPRING);
  one.ExpectError("cube");
  EXPECT_EQ(session->GetNumberOfUndoneActions(), 1);
  session->Redo();
  EXPECT_TRUE(AreEqual(one.Finish(), before));

  session->CarveSphere(6, 6, 6, 3);
  session->CarveSphere(6, 6, 6, -1);
  session->CarveTo(12, 6, 6, 3);
  one.ExpectError("radius");
  EXPECT_EQ(session->GetNumberOfActions(), 4);

  // A sheet so small that it does not split the mesh, so that Undo() does not update it.
  EXPECT_TRUE(session->SetInputs(volume));
  session->ChangeModel(Session::FINITE_ELEMENTS);
  const int handle = session->BeginGrab(10, 10, 17);
  one.Finish();
  session->Cut(MakePlane({ 11.3, 12.4, 9.2 }, { 1, 0, 0 }, { 0, 1, 0 }));
  session->MoveGrab(handle, 1e300, 10, 17);
  session->HoldGrab(handle);
  session->Undo();
  session->Cut(MakePlane({ 11, 12, 9 }, { 60, 0, 0 }, { 0, 60, 0 }));
  session->Redo();
  one.ExpectError("displacement of a handle is too large");
  EXPECT_EQ(session->GetNumberOfActions(), 3);
  EXPECT_EQ(session->GetNumberOfUndoneActions(), 0);
  one.Finish();
}

// SetInputs() removes pending events, but not those that change settings.
TEST(DeformVolumeSession, PendingSettings)
{
  const auto volume = MakeVolume(Box);
  const std::string fileName = GetFileName();
  Tested one(volume);
  one.Object->ChangeHandleRadius(3.5);
  one.Object->CarveSphere(6, 6, 6, 3);
  one.Object->ChangeRelaxationSweeps(4);
  one.Object->ChangeNumberOfNodes(9);
  one.Object->ChangeUndoMemory(1e6);
  EXPECT_TRUE(one.Object->SetInputs(volume) && one.Object->SaveSession(fileName));
  const std::string text = ReadText(fileName);
  for (const char* event :
    { "HandleRadius 3.5", "RelaxationSweeps 4", "NumberOfNodes 9", "UndoMemory 1000000" })
  {
    EXPECT_TRUE(HasPart(text, event));
  }
  EXPECT_FALSE(HasPart(text, "Carve"));
}

// Observers may call methods that wait for the end of a step, also when such a method has failed.
TEST(DeformVolumeSession, CallsOfObservers)
{
  Tested one(MakeVolume(Box));
  int calls = 0;
  vtkNew<vtkCallbackCommand> observer;
  observer->SetClientData(&calls);
  observer->SetCallback(
    [](vtkObject* caller, unsigned long, void* count, void*)
    {
      auto* session = Session::SafeDownCast(caller);
      *static_cast<int*>(count) += session->Probe(10, 10, 10) && session->GetPadding() > 0;
    });
  one.Object->AddObserver(vtkCommand::ErrorEvent, observer);
  one.Object->AddObserver(vtkCommand::ModifiedEvent, observer);
  EXPECT_FALSE(one.Object->SaveSession("/dev/null/session"));
  EXPECT_FALSE(one.Object->SaveVolume("/dev/null/volume.vti"));
  one.Object->SetMovingSamplingFactor(2);
  one.Object->SetPadding(9);
  one.Object->SetBackgroundValue(-3.0);
  EXPECT_EQ(calls, 5);
}

// Saving keeps other files, symbolic links and permissions.
TEST(DeformVolumeSession, ReplacedFiles)
{
  namespace filesystem = std::filesystem;
  const filesystem::path folder = GetFileName() + ".folder";
  filesystem::remove_all(folder);
  filesystem::create_directory(folder);
  const std::string name = folder / "target.xml";
  WriteText(name + ".part", "not of the session");
  WriteText(name, "old");
  constexpr auto permissions = filesystem::perms::owner_read | filesystem::perms::owner_write;
  filesystem::permissions(name, permissions);
  filesystem::create_symlink("target.xml", folder / "link.xml");
  filesystem::create_symlink("new.xml", folder / "dangling.xml");
  Tested one(MakeVolume(Box));
  EXPECT_TRUE(one.Object->SaveSession(folder / "link.xml"));
  EXPECT_TRUE(one.Object->SaveSession(folder / "dangling.xml"));
  EXPECT_TRUE(filesystem::is_symlink(folder / "link.xml"));
  EXPECT_TRUE(filesystem::is_symlink(folder / "dangling.xml"));
  EXPECT_TRUE(HasPart(ReadText(folder / "new.xml"), "DeformVolumeSession"));
  EXPECT_TRUE(HasPart(ReadText(name), "DeformVolumeSession"));
  EXPECT_EQ(filesystem::status(name).permissions(), permissions);
  EXPECT_EQ(ReadText(name + ".part"), "not of the session");
  const auto files = filesystem::directory_iterator(folder);
  EXPECT_EQ(std::distance(begin(files), end(files)), 5); // no temporary file is left
}

TEST(DeformVolumeSession, HiddenCells)
{
  vtkNew<vtkLatticeTetrahedraSource> lattice;
  const auto volume = MakeVolume(Box);
  lattice->SetInputData(volume);
  lattice->Update();
  vtkUnstructuredGrid* mesh = lattice->GetOutput();
  vtkNew<vtkDeformVolumeSession> session;
  EXPECT_TRUE(session->SetInputs(volume, mesh));
  vtkNew<vtkTest::ErrorObserver> observer;
  session->AddObserver(vtkCommand::ErrorEvent, observer);
  mesh->AllocateCellGhostArray();
  mesh->GetCellGhostArray()->SetValue(3, vtkDataSetAttributes::HIDDENCELL);
  EXPECT_FALSE(session->SetInputs(volume, mesh));
  EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "hidden"));
  mesh->GetCellGhostArray()->SetValue(3, 0);
  EXPECT_TRUE(session->SetInputs(volume, mesh));
}

// A sheet of two triangles cuts deformed tissue at the same place when the cut is made again.
TEST(DeformVolumeSession, CoarseSheets)
{
  for (const int model : { Session::MASS_SPRING, Session::FINITE_ELEMENTS })
  {
    Tested one(MakeVolume(Box));
    one.Object->ChangeModel(model);
    one.Object->ChangeHandleRadius(6);
    const int handle = one.Object->BeginGrab(11, 12, 17);
    one.Object->MoveGrab(handle, 11, 12, 25);
    one.Object->HoldGrab(handle);
    one.Finish(1000);
    vtkNew<vtkPlaneSource> plane;
    plane->SetOrigin(-19, -18, 12);
    plane->SetPoint1(41, -18, 12);
    plane->SetPoint2(-19, 42, 12);
    vtkNew<vtkTriangleFilter> sheet;
    sheet->SetInputConnection(plane->GetOutputPort());
    sheet->Update();
    one.Object->Cut(sheet->GetOutput());
    const auto cut = one.Finish(1000);
    one.Object->Undo();
    one.Object->Redo();
    const auto again = one.Finish(1000);
    const auto probe = [](vtkImageData* image, double z)
    {
      double point[3] = { 11, 12, z };
      const vtkIdType id = image->FindPoint(point);
      return id < 0 ? -1.0
                    : image->GetPointData()->GetArray("vtkValidPointMask")->GetComponent(id, 0);
    };
    int differences = 0;
    for (double z = 1.0; z < 24.0; z += 1.0)
    {
      differences += probe(cut, z) != probe(again, z);
    }
    EXPECT_LE(differences, 1);
  }
}

// Cuts with very large sheets take as long as cuts with smaller ones, and split the same faces.
TEST(DeformVolumeSession, LargeSheets)
{
  for (const int model : { Session::CHAIN_MAIL, Session::FINITE_ELEMENTS })
  {
    vtkSmartPointer<vtkImageData> outputs[2];
    for (const double size : { 60.0, 1e4 })
    {
      Tested one(MakeVolume(Box));
      one.Object->ChangeModel(model);
      one.Step();
      one.Object->Cut(MakePlane({ 11, 12, 9.7 }, { size, 0, 0 }, { 0, size, 0 }));
      one.Object->ChangeModel(Session::MASS_SPRING); // cuts its mesh by the sheet at rest
      one.Step();
      EXPECT_LT(one.Object->GetSimulationTime(), 5.0); // 20 s and more without clipping
      const int handle = one.Object->BeginGrab(11, 12, 17);
      one.Object->MoveGrab(handle, 11, 12, 20);
      outputs[size > 60.0] = one.Step();
      EXPECT_EQ(one.TakeError(), "");
    }
    EXPECT_TRUE(AreEqual(outputs[0], outputs[1]));
  }
  // The subdivision of such a sheet would not end.
  for (const int model : { Session::NONE, Session::CHAIN_MAIL, Session::MASS_SPRING })
  {
    Tested one(MakeVolume(Box));
    one.Object->ChangeModel(model);
    for (const double size : { 1e10, 1e160, 1e300 })
    {
      const auto sheet = MakePlane({ 11, 12, 9.7 }, { 60, 0, 0 }, { 0, 60, 0 });
      vtkNew<vtkPoints> points;
      points->SetDataTypeToDouble();
      for (vtkIdType id = 0; id < sheet->GetNumberOfPoints(); ++id)
      {
        points->InsertNextPoint(size * sheet->GetPoint(id)[0], size * sheet->GetPoint(id)[1], 9.7);
      }
      sheet->SetPoints(points);
      one.Object->Cut(sheet);
      one.ExpectError("more than 2^31 voxels away");
    }
  }
}

// Of the sides of a cut that overlap, probes and grabs take the one that is visible.
TEST(DeformVolumeSession, OverlappingSides)
{
  const auto volume = MakeImage({ { 0, 23, 0, 23, 0, 23 } });
  AddScalars<short>(volume, "value", [](const glm::dvec3& p) { return 1000.0 * p.y; });
  for (const int model : { Session::CHAIN_MAIL, Session::MASS_SPRING })
  {
    Tested one(volume);
    one.Object->ChangeModel(model);
    one.Object->ChangeHandleRadius(3);
    one.Object->Cut(MakePlane({ 12, 11.3, 35 }, { 100, 0, 0 }, { 0, 0, 51 }));
    const int right = one.Object->BeginGrab(12, 15, 22);
    const int left = one.Object->BeginGrab(12, 8, 22);
    one.Object->MoveGrab(right, 12, 11, 22);
    one.Object->MoveGrab(left, 12, 12, 22);
    one.Finish();
    int found = 0;
    for (int i = 0; i < 9 * 9 * 9; ++i)
    {
      if (one.Object->Probe(8 + i % 9, 8 + i / 9 % 9, 14 + i / 81))
      {
        ++found;
        EXPECT_NEAR(
          one.Object->GetProbedRestPosition()[1], 0.001 * one.Object->GetProbedValue(), 1.0);
      }
    }
    EXPECT_GT(found, 500);
    EXPECT_TRUE(one.Object->Probe(14, 14, 19));
    one.Object->ChangeHandleRadius(0);
    one.Object->BeginGrab(14, 14, 19);
    one.Step();
    vtkNew<vtkPolyData> handles;
    one.Object->GetHandles(handles);
    EXPECT_EQ(one.TakeError(), "");
    EXPECT_NEAR(handles->GetPointData()->GetArray("RestPosition")->GetComponent(2, 1),
      0.001 * one.Object->GetProbedValue(), 1.0);
  }
}

// The search structures of a mesh are kept until it moves.
TEST(DeformVolumeSession, RepeatedProbes)
{
  Tested one(MakeVolume(Box));
  one.Object->ChangeNumberOfNodes(25);
  one.Object->ChangeModel(Session::MASS_SPRING);
  const int handle = one.Object->BeginGrab(10, 10, 10);
  for (const double x : { 10.5, 11.0 })
  {
    one.Object->MoveGrab(handle, x, 10, 10);
    one.Step();
    const auto probe = [&]()
    {
      const auto begin = std::chrono::steady_clock::now();
      EXPECT_TRUE(one.Object->Probe(x, 10, 10));
      const double* rest = one.Object->GetProbedRestPosition();
      EXPECT_LT(glm::distance({ rest[0], rest[1], rest[2] }, glm::dvec3(10, 10, 10)), 1e-3);
      return std::chrono::steady_clock::now() - begin;
    };
    const auto first = probe();
    EXPECT_LT(2 * probe(), first);
  }
  EXPECT_EQ(one.TakeError(), "");
}

// Another handle that holds deformed tissue moves nothing before it is moved.
TEST(DeformVolumeSession, GrabsMoveNothing)
{
  for (const int model : { Session::MASS_SPRING, Session::FINITE_ELEMENTS })
  {
    for (const double radius : { 0.0, 4.0 })
    {
      Tested one(MakeVolume(Box));
      one.Object->ChangeModel(model);
      const int handle = one.Object->BeginGrab(10, 10, 17);
      one.Object->MoveGrab(handle, 15, 12, 18);
      one.Object->HoldGrab(handle);
      one.Finish(1000);
      const auto before = GetMesh(one.Object);
      one.Object->ChangeHandleRadius(radius);
      one.Object->BeginGrab(9, 10, 11);
      one.Finish();
      const auto after = GetMesh(one.Object);
      ASSERT_EQ(after->GetNumberOfPoints(), before->GetNumberOfPoints());
      double most = 0.0;
      for (vtkIdType i = 0; i < before->GetNumberOfPoints(); ++i)
      {
        most = std::max(most, glm::distance(GetPoint(before, i), GetPoint(after, i)));
      }
      EXPECT_LT(most, 0.02) << "with the radius " << radius; // of the last residuals
    }
  }
}

// A file of version 0.1, with events of all kinds.
TEST(DeformVolumeSession, OldFile)
{
  const std::string data = GetTestArgument("-D");
  const std::string fileName = GetFileName();
  auto volume = MakeImage({ { 0, 13, 0, 12, 0, 11 } });
  vtkNew<vtkUnsignedCharArray> values;
  values->SetName("values");
  for (vtkIdType i = 0; i < volume->GetNumberOfPoints(); ++i)
  {
    values->InsertNextValue(static_cast<unsigned char>(7 * i % 251));
  }
  volume->GetPointData()->SetScalars(values);
  Tested one(volume);
  vtkNew<vtkTest::ErrorObserver> warnings;
  one.Object->AddObserver(vtkCommand::WarningEvent, warnings);
  EXPECT_TRUE(one.Object->LoadSession(data + "/Session-0.1.xml"));
  const auto output = one.Step();
  EXPECT_EQ(one.TakeError(), "");
  EXPECT_FALSE(warnings->GetWarning());
  EXPECT_EQ(one.Object->GetModel(), int(Session::CHAIN_MAIL));
  EXPECT_EQ(one.Object->GetNumberOfActions(), 6);
  vtkDataArray* mask = output->GetPointData()->GetArray("vtkValidPointMask");
  EXPECT_EQ(mask->GetComponent(output->FindPoint(3, 3, 3), 0), 0.0); // carved
  EXPECT_EQ(mask->GetComponent(output->FindPoint(10, 10, 3), 0), 1.0);
  EXPECT_TRUE(one.Object->SaveSession(fileName));
  const std::string text = ReadText(data + "/Session-0.1.xml");
  const std::size_t events = text.find("  <Event");
  EXPECT_TRUE(HasPart(ReadText(fileName), text.substr(events, text.rfind("</") - events).c_str()));
}

TEST(DeformVolumeSession, Thread)
{
  const auto volume = MakeVolume(Box);
  const std::string fileName = GetFileName();
  Tested one(volume);
  one.Object->ChangeModel(Session::MASS_SPRING);
  one.Object->Start();
  const int handle = one.Object->BeginGrab(10, 10, 17);
  vtkSmartPointer<vtkImageData> last;
  int outputs = 0;
  for (int i = 0; i < 60; ++i)
  {
    one.Object->MoveGrab(handle, 10 + 0.1 * i, 10, 17);
    one.Object->Probe(5, 5, 5);
    auto output = vtkSmartPointer<vtkImageData>::Take(one.Object->TakeOutput());
    outputs += output != nullptr;
    last = output ? output : last;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  one.Object->Stop();
  EXPECT_FALSE(one.Object->GetIsRunning());
  EXPECT_GT(outputs, 1);
  const auto stopped = one.Step();
  EXPECT_TRUE(one.Object->SaveSession(fileName));
  EXPECT_EQ(one.TakeError(), "");

  // The recorded session of the thread gives the same result without a thread.
  Tested other(volume);
  EXPECT_TRUE(other.Object->LoadSession(fileName));
  EXPECT_TRUE(AreEqual(one.Step(), other.Step()));

  // The thread ends when the session is deleted during a motion.
  for (int i = 0; i < 5; ++i)
  {
    Tested closed(volume);
    closed.Object->ChangeModel(Session::MASS_SPRING);
    closed.Object->Start();
    const int held = closed.Object->BeginGrab(10, 10, 17);
    closed.Object->MoveGrab(held, 15, 10, 17);
    std::this_thread::sleep_for(std::chrono::milliseconds(7 * i));
    EXPECT_TRUE(closed.Object->GetIsBusy());
  }

  // ChainMail comes to rest without further events.
  Tested resting(volume);
  resting.Object->ChangeModel(Session::CHAIN_MAIL);
  resting.Object->CarveSphere(4, 4, 4, 2.0);
  resting.Object->Start();
  for (int i = 0; i < 3000 && resting.Object->GetIsBusy(); ++i)
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_FALSE(resting.Object->GetIsBusy());
  EXPECT_EQ(resting.TakeError(), "");
}

} // namespace
