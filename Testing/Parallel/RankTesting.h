// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankTesting_h
#define RankTesting_h

#include "FilterTesting.h"

#include <vtkExtentTranslator.h>
#include <vtkMPIController.h>

/// Runs a test on all ranks of MPI. Returns the exit code, a failure if a check failed on any rank.
template <typename Test>
int RunOnRanks(int argc, char* argv[], Test&& test)
{
  vtkNew<vtkMPIController> controller;
  controller->Initialize(&argc, &argv);
  vtkMultiProcessController::SetGlobalController(controller);
  test(controller.Get());
  // Checks outside tests of GoogleTest, which does not know MPI, have a result of their own.
  int failures = testing::UnitTest::GetInstance()->ad_hoc_test_result().total_part_count();
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

/// Returns the extent of the piece of a rank.
inline filterTesting::Extent GetPiece(
  vtkMPIController* controller, filterTesting::Extent whole, int ghosts)
{
  filterTesting::Extent piece;
  vtkNew<vtkExtentTranslator> translator;
  translator->PieceToExtentThreadSafe(controller->GetLocalProcessId(),
    controller->GetNumberOfProcesses(), ghosts, whole.data(), piece.data(),
    vtkExtentTranslator::BLOCK_MODE, 0);
  return piece;
}

/// Whether an image is a part of another one, bit by bit. Arrays are compared by name, because
/// their order changes when images are sent to other ranks.
inline testing::AssertionResult IsPartOf(vtkImageData* part, vtkImageData* whole)
{
  using namespace filterTesting;
  vtkNew<vtkImageData> cropped;
  cropped->ShallowCopy(whole);
  cropped->Crop(part->GetExtent());
  vtkPointData* expected = cropped->GetPointData();
  if (GetExtent(part) != GetExtent(cropped) ||
    GetPoint(part, part->GetNumberOfPoints() - 1) !=
      GetPoint(cropped, part->GetNumberOfPoints() - 1))
  {
    return testing::AssertionFailure() << "the extents or the points differ";
  }
  if (expected->GetNumberOfArrays() < 2)
  {
    return testing::AssertionFailure() << "the whole image has less than two arrays";
  }
  for (int i = 0; i < expected->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = expected->GetArray(i);
    const testing::AssertionResult equality =
      HaveEqualBits(array, part->GetPointData()->GetArray(array->GetName()));
    if (!equality)
    {
      return equality;
    }
  }
  return testing::AssertionSuccess();
}

#endif
