// SPDX-License-Identifier: BSD-3-Clause
// Too little memory on one rank: all ranks report one error, none waits for another, and the
// filter works when there is memory. Every large allocation of an update fails once.
#include "FilterTesting.h"
#include "RankTesting.h"

#include <cstdlib>
#include <new>

using namespace filterTesting;

namespace
{

// More than this counts as large, in bytes: less than the mesh of a rank.
constexpr std::size_t LARGE = 20000;

// Large allocations of this thread that still succeed before one fails; negative: all succeed.
thread_local int Left = -1;
thread_local bool Failed = false;

void* Allocate(std::size_t size)
{
  if (size > LARGE && Left >= 0 && Left-- == 0)
  {
    Failed = true;
    throw std::bad_alloc();
  }
  if (void* memory = std::malloc(size))
  {
    return memory;
  }
  throw std::bad_alloc();
}

} // namespace

// The operators of the whole process, of the libraries as well.
void* operator new(std::size_t size)
{
  return Allocate(size);
}
void* operator new[](std::size_t size)
{
  return Allocate(size);
}
void operator delete(void* memory) noexcept
{
  std::free(memory);
}
void operator delete[](void* memory) noexcept
{
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept
{
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept
{
  std::free(memory);
}

namespace
{

class ShortMemory
{
public:
  explicit ShortMemory(vtkMPIController* controller)
    : Controller(controller)
    , Rank(controller->GetLocalProcessId())
    , Count(controller->GetNumberOfProcesses())
    , Volume(MakeImage({ { 0, 30, 0, 20, 0, 20 } }))
  {
    AddScalars<short>(this->Volume, "value", [](const glm::dvec3& p) { return p.x + p.y * p.z; });
    // Each rank has a mesh of its own, beside the last one.
    auto part = MakeImage({ { 10 * this->Rank, 10 * this->Rank + 10, 0, 20, 0, 20 } });
    this->Mesh = MakeMesh(part, 9, 0.0);
    SetDisplacements(this->Mesh, Shift(1.0, 0.0, 0.0));
    this->Tested.Filter->SetInputData(this->Volume);
    this->Tested.Filter->SetDeformationData(this->Mesh);
  }

  /// Updates after a change of everything; returns whether memory was short.
  bool Update(int allocations)
  {
    this->Mesh->GetPoints()->Modified();
    this->Mesh->GetPointData()->GetVectors()->Modified();
    this->Volume->GetPointData()->GetScalars()->Modified();
    this->Volume->Modified();
    const bool chosen = this->Rank == this->Count - 1;
    Left = chosen ? allocations : -1;
    Failed = false;
    this->Tested.Filter->UpdatePiece(this->Rank, this->Count, 0);
    Left = -1;
    int failed = Failed ? 1 : 0;
    int any = 0;
    this->Controller->AllReduce(&failed, &any, 1, vtkCommunicator::MAX_OP);
    return any != 0;
  }

  void Run()
  {
    // Compiles kernels and finds devices.
    VERIFY(!this->Update(-1));
    VERIFY_EQUAL(this->Tested.TakeErrors(), 0);
    const vtkIdType covered = this->Tested.Filter->GetNumberOfCoveredVoxels();
    VERIFY(covered > 0);
    constexpr int most = 100;
    int allocations = 0;
    while (allocations < most && this->Update(allocations))
    {
      VERIFY_EQUAL(this->Tested.TakeErrors(), 1);
      VERIFY(this->Tested.LastError.find("memory") != std::string::npos);
      VERIFY_EQUAL(this->Tested.Filter->GetOutput()->GetNumberOfPoints(), vtkIdType{ 0 });
      VERIFY(!this->Update(-1));
      VERIFY_EQUAL(this->Tested.TakeErrors(), 0);
      VERIFY_EQUAL(this->Tested.Filter->GetNumberOfCoveredVoxels(), covered);
      ++allocations;
    }
    VERIFY_EQUAL(this->Tested.TakeErrors(), 0);
    if (this->Rank == 0)
    {
      std::cout << allocations << " large allocations failed in turn\n";
    }
    VERIFY(allocations > 3 && allocations < most);
  }

private:
  vtkMPIController* Controller;
  int Rank;
  int Count;
  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Tested;
};

} // namespace

int main(int argc, char* argv[])
{
  return RunOnRanks(
    argc, argv, [](vtkMPIController* controller) { ShortMemory(controller).Run(); });
}
