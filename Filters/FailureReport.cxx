// SPDX-License-Identifier: BSD-3-Clause
#include "FailureReport.h"

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkExecutive.h"
#include "vtkNew.h"
#include "vtkOutputWindow.h"

#include <cstring>

namespace deformvolume
{

namespace
{

/// An error that is observed is not displayed. This observer is gone after the one it waits for.
class FailureObserver : public vtkCommand
{
public:
  static FailureObserver* New() { return new FailureObserver; }

  void Execute(vtkObject* executive, unsigned long, void* text) override
  {
    const char* message = static_cast<const char*>(text);
    if (message && !std::strstr(message, "returned failure for request"))
    {
      vtkOutputWindowDisplayErrorText(message);
      return;
    }
    executive->RemoveObserver(this);
  }
};

} // namespace

int Fail(vtkAlgorithm* algorithm)
{
  // A ParaView view that has met a request that failed is not told of later changes of the
  // algorithm's settings: it would never show what the mended algorithm makes.
  if (algorithm->HasExecutive() && algorithm->GetExecutive()->IsA("vtkPVCompositeDataPipeline"))
  {
    return 1;
  }
  // Where nothing is displayed the executive reports nothing, and the observer would stay.
  if (vtkObject::GetGlobalWarningDisplay() && algorithm->HasExecutive())
  {
    vtkNew<FailureObserver> observer;
    algorithm->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
  }
  return 0;
}

} // namespace deformvolume
