// SPDX-License-Identifier: BSD-3-Clause
// Failed updates: missing required inputs, one error of the filter at each failed update, and no
// errors of its sources. Also: the list of devices.
#include "FilterTesting.h"

#include "vtkCarveVolume.h"
#include "vtkChainMailDeformation.h"
#include "vtkCutVolume.h"
#include "vtkFiniteElementDeformation.h"
#include "vtkMassSpringDeformation.h"
#include "vtkMaterialFromVolume.h"
#include "vtkTetGenMesher.h"

#include <vtkInformation.h>
#include <vtkInformationIntegerKey.h>
#include <vtkLogger.h>
#include <vtkOutputWindow.h>
#include <vtkStringArray.h>
#include <vtkStringOutputWindow.h>

using namespace filterTesting;

namespace
{

/// Collects the messages that VTK displays during its lifetime.
class Display
{
public:
  Display()
  {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
    vtkOutputWindow::SetInstance(this->Window);
  }
  ~Display() { vtkOutputWindow::SetInstance(nullptr); }

  /// The number of errors, without those of the executive about failed requests.
  int CountErrors() const
  {
    return this->Count("ERROR: ") - this->Count("returned failure for request");
  }

private:
  int Count(const std::string& word) const
  {
    const std::string text = this->Window->GetOutput();
    int count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    {
      ++count;
    }
    return count;
  }

  vtkNew<vtkStringOutputWindow> Window;
};

// The executive reports required inputs that are not connected.
template <typename AlgorithmT>
void CheckRequiredInputs(int required)
{
  vtkNew<AlgorithmT> algorithm;
  vtkNew<vtkTest::ErrorObserver> observer;
  algorithm->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
  for (int repeat = 0; repeat < 2; ++repeat)
  {
    EXPECT_FALSE(algorithm->GetExecutive()->Update());
    EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "Input port 0"));
    EXPECT_TRUE(HasPart(observer->GetErrorMessage(), "is not optional"));
    observer->Clear();
  }
  for (int port = 0; port < algorithm->GetNumberOfInputPorts(); ++port)
  {
    EXPECT_EQ(algorithm->GetInputPortInformation(port)->Get(vtkAlgorithm::INPUT_IS_OPTIONAL()) == 0,
      port < required);
  }
}

// After an error of the filter there are no errors of its sources: it does not request extents that
// they do not have.
TEST(FailedUpdates, Sources)
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
  EXPECT_EQ(display.CountErrors(), 1);
  filter->SetDevice("");
  filter->Update();
  EXPECT_EQ(display.CountErrors(), 1);
  EXPECT_GT(filter->GetOutput()->GetNumberOfPoints(), 0);
}

TEST(FailedUpdates, Messages)
{
  const auto volume = MakeVolume();
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  const Display display;
  vtkNew<vtkDeformVolumeFilter> filter;
  filter->SetInputData(volume);
  filter->SetDeformationData(mesh);
  filter->SetDevice("a device that nobody has");
  filter->UpdateInformation();
  EXPECT_EQ(display.CountErrors(), 0); // the device may still be changed before the update
  for (int errors = 1; errors < 4; ++errors)
  {
    EXPECT_FALSE(filter->GetExecutive()->Update());
    EXPECT_EQ(display.CountErrors(), errors);
  }
  filter->UpdateWholeExtent();
  EXPECT_EQ(display.CountErrors(), 4);
  filter->SetDevice("");
  EXPECT_TRUE(filter->GetExecutive()->Update());
  EXPECT_EQ(display.CountErrors(), 4);
  EXPECT_GT(filter->GetOutput()->GetNumberOfPoints(), 0);

  // A failure in RequestUpdateExtent(), when a part of the output is requested.
  filter->SetOutputBoundsModeToVolumeBounds();
  filter->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "absent");
  const int part[6] = { 2, 4, 2, 4, 2, 4 };
  for (int errors = 5; errors < 7; ++errors)
  {
    filter->UpdateExtent(part);
    EXPECT_EQ(display.CountErrors(), errors);
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
  }
  filter->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::VECTORS);
  filter->UpdateExtent(part);
  EXPECT_EQ(display.CountErrors(), 6);
  EXPECT_GT(filter->GetOutput()->GetNumberOfPoints(), 0);
}

TEST(FailedUpdates, Devices)
{
  const auto volume = MakeVolume();
  const auto mesh = MakeMesh(volume);
  SetDisplacements(mesh, Shift(1.0, 0.0, 0.0));
  Deformed deformed(volume, mesh);
  vtkSmartPointer<vtkStringArray> names;
  names.TakeReference(vtkDeformVolumeFilter::GetDeviceNames());
  EXPECT_GT(names->GetNumberOfValues(), 0);
  for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i)
  {
    deformed.Filter->SetDevice(names->GetValue(i));
    deformed.Update();
    EXPECT_EQ(deformed.Filter->GetDeviceInUse(), std::string(names->GetValue(i)));
  }
  deformed.Filter->SetDevice("");
  deformed.Update();
  const std::string best = deformed.Filter->GetDeviceInUse();
  deformed.Filter->SetDevice("best");
  deformed.Update();
  EXPECT_EQ(deformed.Filter->GetDeviceInUse(), best);
}

} // namespace

TEST(FailedUpdates, RequiredInputs)
{
  CheckRequiredInputs<vtkDeformVolumeFilter>(1);
  CheckRequiredInputs<vtkCutVolume>(1);
  CheckRequiredInputs<vtkCarveVolume>(1);
  CheckRequiredInputs<vtkChainMailDeformation>(1);
  CheckRequiredInputs<vtkMassSpringDeformation>(1);
  CheckRequiredInputs<vtkFiniteElementDeformation>(1);
  CheckRequiredInputs<vtkMaterialFromVolume>(2);
  CheckRequiredInputs<vtkTetGenMesher>(1);
}
