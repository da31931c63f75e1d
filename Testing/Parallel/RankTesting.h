// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankTesting_h
#define RankTesting_h

#include "FilterTesting.h"

#include <vtkExtentTranslator.h>
#include <vtkMPIController.h>
#include <vtkMatrix3x3.h>

#include <algorithm>
#include <array>

/// The controller of the running test.
inline vtkMPIController* Controller = nullptr;

inline int GetRank()
{
  return Controller->GetLocalProcessId();
}
inline int GetRanks()
{
  return Controller->GetNumberOfProcesses();
}

/// Runs a test on all ranks of MPI. Returns the exit code, a failure if a check failed on any rank.
template <typename Test>
int RunOnRanks(int argc, char* argv[], Test&& test)
{
  vtkNew<vtkMPIController> controller;
  controller->Initialize(&argc, &argv);
  vtkMultiProcessController::SetGlobalController(controller);
  Controller = controller;
  test();
  // Checks outside tests of GoogleTest, which does not know MPI, have a result of their own.
  int failures = testing::UnitTest::GetInstance()->ad_hoc_test_result().total_part_count();
  int all = 0;
  controller->AllReduce(&failures, &all, 1, vtkCommunicator::SUM_OP);
  if (GetRank() == 0)
  {
    std::cout << all << " checks failed on " << GetRanks() << " ranks\n";
  }
  vtkMultiProcessController::SetGlobalController(nullptr);
  controller->Finalize();
  return all == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/// Returns an image on all ranks, which the first rank makes as the only process.
template <typename Make>
vtkSmartPointer<vtkImageData> MakeOnFirstRank(Make&& make)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  if (GetRank() == 0)
  {
    vtkMultiProcessController::SetGlobalController(nullptr);
    image->ShallowCopy(make());
    vtkMultiProcessController::SetGlobalController(Controller);
  }
  Controller->Broadcast(image, 0);
  // VTK writes origin and spacing as rounded decimals, and leaves the direction out.
  std::array<double, 15> grid;
  std::copy_n(image->GetOrigin(), 3, grid.data());
  std::copy_n(image->GetSpacing(), 3, grid.data() + 3);
  std::copy_n(image->GetDirectionMatrix()->GetData(), 9, grid.data() + 6);
  Controller->Broadcast(grid.data(), 15, 0);
  image->SetOrigin(grid.data());
  image->SetSpacing(grid.data() + 3);
  image->SetDirectionMatrix(grid.data() + 6);
  EXPECT_GT(image->GetNumberOfPoints(), 0);
  return image;
}

/// Returns the extent of the piece of this rank.
inline filterTesting::Extent GetPiece(filterTesting::Extent whole, int ghosts)
{
  filterTesting::Extent piece;
  vtkNew<vtkExtentTranslator> translator;
  translator->PieceToExtentThreadSafe(
    GetRank(), GetRanks(), ghosts, whole.data(), piece.data(), vtkExtentTranslator::BLOCK_MODE, 0);
  return piece;
}

/// Updates a filter, and checks that its output is the piece of this rank.
inline void CheckPiece(vtkAlgorithm* filter, vtkImageData* whole, const std::string& name)
{
  filter->UpdatePiece(GetRank(), GetRanks(), 0);
  auto* output = vtkImageData::SafeDownCast(filter->GetOutputDataObject(0));
  EXPECT_EQ(filterTesting::GetExtent(output), GetPiece(filterTesting::GetExtent(whole), 0));
  EXPECT_TRUE(filterTesting::IsPartOf(output, whole))
    << name << ", rank " << GetRank() << " of " << GetRanks();
}

#endif
