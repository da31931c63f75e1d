// SPDX-License-Identifier: BSD-3-Clause
// Lets memory run out on one rank: all ranks report one error, none waits for another, and the
// filter works when there is enough memory again. Each large allocation of an update fails once.
#include "FilterTesting.h"
#include "RankTesting.h"

#include <cstdlib>
#include <new>

using namespace filterTesting;

namespace
{

// Allocations of more bytes than this are large. The mesh of a rank is larger.
constexpr std::size_t LARGE = 20000;

// Number of large allocations of this thread that succeed before one fails. Negative: all succeed.
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

// Replace the operators of the whole process, including its libraries.
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
  ShortMemory()
    : Volume(MakeImage({ { 0, 30, 0, 20, 0, 20 } }))
  {
    AddScalars<short>(this->Volume, "value", [](const glm::dvec3& p) { return p.x + p.y * p.z; });
    // Each rank has a mesh of its own, beside that of the previous rank.
    auto part = MakeImage({ { 10 * GetRank(), 10 * GetRank() + 10, 0, 20, 0, 20 } });
    this->Mesh = MakeMesh(part, 9, 0.0);
    SetDisplacements(this->Mesh, Shift(1.0, 0.0, 0.0));
    this->Tested.Filter->SetInputData(this->Volume);
    this->Tested.Filter->SetDeformationData(this->Mesh);
  }

  /// Changes all inputs and updates. Returns whether memory ran out.
  bool Update(int allocations)
  {
    this->Mesh->GetPoints()->Modified();
    this->Mesh->GetPointData()->GetVectors()->Modified();
    this->Volume->GetPointData()->GetScalars()->Modified();
    this->Volume->Modified();
    const bool chosen = GetRank() == GetRanks() - 1;
    Left = chosen ? allocations : -1;
    Failed = false;
    this->Tested.Filter->UpdatePiece(GetRank(), GetRanks(), 0);
    Left = -1;
    int failed = Failed ? 1 : 0;
    int any = 0;
    Controller->AllReduce(&failed, &any, 1, vtkCommunicator::MAX_OP);
    return any != 0;
  }

  void Run()
  {
    // The first update compiles kernels and finds devices.
    EXPECT_FALSE(this->Update(-1));
    EXPECT_EQ(this->Tested.TakeErrors(), 0);
    const vtkIdType covered = this->Tested.Filter->GetNumberOfCoveredVoxels();
    EXPECT_GT(covered, 0);
    constexpr int most = 100;
    int allocations = 0;
    while (allocations < most && this->Update(allocations))
    {
      EXPECT_EQ(this->Tested.TakeErrors(), 1);
      EXPECT_TRUE(HasPart(this->Tested.LastError, "memory"));
      EXPECT_EQ(this->Tested.Filter->GetOutput()->GetNumberOfPoints(), 0);
      EXPECT_FALSE(this->Update(-1));
      EXPECT_EQ(this->Tested.TakeErrors(), 0);
      EXPECT_EQ(this->Tested.Filter->GetNumberOfCoveredVoxels(), covered);
      ++allocations;
    }
    EXPECT_EQ(this->Tested.TakeErrors(), 0);
    if (GetRank() == 0)
    {
      std::cout << allocations << " large allocations failed in turn\n";
    }
    EXPECT_TRUE(allocations > 3 && allocations < most);
  }

private:
  vtkSmartPointer<vtkImageData> Volume;
  vtkSmartPointer<vtkUnstructuredGrid> Mesh;
  Deformed Tested;
};

} // namespace

int main(int argc, char* argv[])
{
  return RunOnRanks(argc, argv, [] { ShortMemory().Run(); });
}
