// SPDX-License-Identifier: BSD-3-Clause
// What a user sees of a failure, where nobody observes errors: one message, at each attempt after a
// change. What a
// list of devices to choose from offers.
#include "FilterTesting.h"

#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkSphereSource.h>
#include <vtkStringArray.h>
#include <vtkStringOutputWindow.h>

using namespace filterTesting;

namespace
{

/// What is displayed while it lives.
class Display
{
public:
  Display()
  {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    vtkOutputWindow::SetInstance(this->Window);
  }
  ~Display() { vtkOutputWindow::SetInstance(nullptr); }

  int CountErrors() const
  {
    const std::string text = this->Window->GetOutput();
    int count = 0;
    for (std::size_t at = text.find("ERROR: "); at != std::string::npos;
         at = text.find("ERROR: ", at + 1))
    {
      ++count;
    }
    return count;
  }

private:
  vtkNew<vtkStringOutputWindow> Window;
};

// Sources complain where they are asked for what they have not: a failure asks them for nothing.
void TestSources()
{
  const auto volume = MakeVolume({ { 5, 12, -9, -2, 3, 9 } });
  const auto field = MakeImage({ { 4, 13, -10, -1, 2, 10 } });
  SetDisplacements(field, Shift(0.5, 0.0, 0.0));
  const Display display;
  vtkNew<vtkDeformVolumeFilter> filter;
  filter->SetInputData(volume);
  filter->SetDeformationData(field);
  filter->SetDevice("a device that nobody has");
  filter->Update();
  VERIFY_EQUAL(display.CountErrors(), 1);
  filter->SetDevice("");
  filter->Update();
  VERIFY_EQUAL(display.CountErrors(), 1);
  VERIFY(filter->GetOutput()->GetNumberOfPoints() > 0);
}

void TestMessages(vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  const Display display;
  vtkNew<vtkDeformVolumeFilter> filter;
  filter->SetInputData(volume);
  filter->UpdateInformation();
  VERIFY_EQUAL(display.CountErrors(), 0); // the deformation may be about to come
  filter->Update();
  VERIFY_EQUAL(display.CountErrors(), 1);
  filter->Modified();
  filter->Update();
  VERIFY_EQUAL(display.CountErrors(), 2);
  filter->SetDeformationData(mesh);
  filter->Update();
  VERIFY_EQUAL(display.CountErrors(), 2);
  VERIFY(filter->GetOutput()->GetNumberOfPoints() > 0);
  filter->SetDevice("a device that nobody has");
  filter->Update();
  VERIFY_EQUAL(display.CountErrors(), 3);
  filter->Update(); // as views do that draw again
  filter->UpdateWholeExtent();
  VERIFY_EQUAL(display.CountErrors(), 3);

  // Who observes the executive gets its error all the same.
  vtkNew<vtkTest::ErrorObserver> observer;
  filter->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
  filter->Modified();
  filter->Update();
  VERIFY_EQUAL(display.CountErrors(), 4);
  VERIFY(observer->GetErrorMessage().find("returned failure") != std::string::npos);

  // Other errors of an executive are displayed.
  vtkNew<vtkDeformVolumeFilter> other;
  other->SetInputData(volume);
  other->SetDevice("a device that nobody has");
  other->SetDeformationData(mesh);
  other->Update();
  VERIFY_EQUAL(display.CountErrors(), 5);
  vtkNew<vtkSphereSource> surface;
  other->SetDeformationConnection(surface->GetOutputPort());
  other->Update();
  VERIFY(display.CountErrors() > 5);
}

void TestDevices(vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  Deformed deformed(volume, mesh);
  vtkSmartPointer<vtkStringArray> names;
  names.TakeReference(vtkDeformVolumeFilter::GetDeviceNames());
  VERIFY(names->GetNumberOfValues() > 0);
  for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i)
  {
    deformed.Filter->SetDevice(names->GetValue(i));
    deformed.Update();
    VERIFY_EQUAL(deformed.Filter->GetDeviceInUse(), std::string(names->GetValue(i)));
  }
  deformed.Filter->SetDevice("");
  deformed.Update();
  const std::string best = deformed.Filter->GetDeviceInUse();
  deformed.Filter->SetDevice("best");
  deformed.Update();
  VERIFY_EQUAL(deformed.Filter->GetDeviceInUse(), best);
}

} // namespace

int TestFailureReport(int, char*[])
{
  auto volume = MakeVolume();
  auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  TestDevices(volume, mesh);
  TestMessages(volume, mesh);
  TestSources();
  return GetExitCode();
}
