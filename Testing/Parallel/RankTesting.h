// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankTesting_h
#define RankTesting_h

#include "FilterTesting.h"

#include <vtkMPIController.h>

/// A test on all ranks of MPI; the exit code, which counts the failures of all.
template <typename Test>
int RunOnRanks(int argc, char* argv[], Test&& test)
{
  vtkNew<vtkMPIController> controller;
  controller->Initialize(&argc, &argv);
  vtkMultiProcessController::SetGlobalController(controller);
  test(controller.Get());
  int failures = filterTesting::GetNumberOfFailures();
  int all = 0;
  controller->AllReduce(&failures, &all, 1, vtkCommunicator::SUM_OP);
  if (controller->GetLocalProcessId() == 0)
  {
    std::cout << all << " checks failed on " << controller->GetNumberOfProcesses() << " ranks\n";
  }
  vtkMultiProcessController::SetGlobalController(nullptr);
  controller->Finalize();
  return all == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

#endif
