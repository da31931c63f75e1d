// SPDX-License-Identifier: BSD-3-Clause
// Memory of the caller: arrays that are read in place, outputs that are written in place or copied,
// and slabs.
#include "DeformerCase.h"
#include "DeviceNeeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <random>

#include <sys/mman.h>
#include <unistd.h>

using namespace deformvolume;

namespace
{

class HostMemory : public testing::Test
{
protected:
  DeformerCase Case = MakeCase({ { 0, 21, 0, 18, -1, 17 } }, { { 1, 1, 1 } }, MakeJitter(5, 0.15));
  reference::Result Reference = ResampleByReference(this->Case);
  std::vector<std::uint16_t> Values =
    MakeRandomValues<std::uint16_t>(this->Case.GetNumberOfVoxels(), 3);
  std::vector<double> Others = MakeRandomValues<double>(2 * this->Case.GetNumberOfVoxels(), 4);
  std::vector<VolumeArray> Arrays{ MakeArray(this->Values, 1, false, 7),
    MakeArray(this->Others, 2) };
  VolumeDeformer Deformer;

  void ExpectRight(Resampling method = Resampling::Exact)
  {
    ExpectEqualsReference(this->Case, this->Reference, this->Arrays,
      RunDeformer(this->Deformer, this->Case, this->Arrays, method));
  }

  /// Whether the device of the tests works in place. Only CPUs do.
  bool WorksInPlace()
  {
    VolumeDeformer deformer;
    Load(deformer, this->Case, this->Arrays, Route::Field);
    const std::uint64_t copied = deformer.GetDeviceMemory();
    std::vector<VolumeArray> owned = this->Arrays;
    for (VolumeArray& array : owned)
    {
      array.Owner = std::make_shared<int>(0);
    }
    Load(deformer, this->Case, owned, Route::Field);
    return deformer.GetDeviceMemory() < copied;
  }
};

} // namespace

TEST_F(HostMemory, ArraysWithoutOwnerAreCopied)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  const Deformed first = RunDeformer(this->Deformer, this->Case, this->Arrays);
  ExpectEqualsReference(this->Case, this->Reference, this->Arrays, first);
  const std::vector<std::uint16_t> values = this->Values;
  std::fill(this->Values.begin(), this->Values.end(), 0);
  const Deformed second = RunDeformer(this->Deformer, this->Case, this->Arrays);
  EXPECT_EQ(first.Outputs, second.Outputs);
}

TEST_F(HostMemory, ArraysWithOwnerAreHeld)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const auto owner = std::make_shared<int>(0);
  std::vector<VolumeArray> owned = this->Arrays;
  for (VolumeArray& array : owned)
  {
    array.Owner = owner;
  }
  Load(this->Deformer, this->Case, owned, Route::Mesh);
  this->ExpectRight();
  const auto others = owner.use_count() - 1 - static_cast<long>(owned.size());
  EXPECT_EQ(others > 0, this->WorksInPlace());
  if (others > 0)
  {
    // Changed values are read.
    std::reverse(this->Values.begin(), this->Values.end());
    this->ExpectRight();
    EXPECT_GT(owner.use_count(), 1 + static_cast<long>(owned.size()));
  }
  this->Deformer.SetArrays(this->Arrays);
  EXPECT_EQ(owner.use_count(), 1 + static_cast<long>(owned.size()));
  this->ExpectRight();
  this->Deformer.SetArrays(owned);
  this->Deformer.ReleaseMemory();
  EXPECT_EQ(owner.use_count(), 1 + static_cast<long>(owned.size()));
}

TEST_F(HostMemory, ArraysWithOwnerThatAreNotAligned)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  std::vector<char> bytes(this->Values.size() * 2 + 1);
  std::memcpy(bytes.data() + 1, this->Values.data(), this->Values.size() * 2);
  std::vector<VolumeArray> owned = this->Arrays;
  owned[0].Data = bytes.data() + 1;
  owned[0].Owner = std::make_shared<int>(0);
  Load(this->Deformer, this->Case, owned, Route::Field);
  this->ExpectRight();
}

// Memory that ends at the end of a page. The next page cannot be accessed.
class GuardedMemory
{
public:
  explicit GuardedMemory(std::size_t bytes)
  {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t pages = (bytes + page - 1) / page;
    this->Size = (pages + 1) * page;
    void* memory =
      mmap(nullptr, this->Size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    this->Begin = static_cast<char*>(memory);
    if (memory == MAP_FAILED || mprotect(this->Begin + pages * page, page, PROT_NONE) != 0)
    {
      throw std::bad_alloc();
    }
    this->Data = this->Begin + pages * page - bytes;
  }
  ~GuardedMemory() { munmap(this->Begin, this->Size); }
  GuardedMemory(const GuardedMemory&) = delete;
  GuardedMemory& operator=(const GuardedMemory&) = delete;

  char* Data = nullptr;

private:
  char* Begin = nullptr;
  std::size_t Size = 0;
};

// Kernels that access memory beyond the end of arrays or outputs in place would crash here.
TEST_F(HostMemory, NothingBeyondTheEndIsAccessed)
{
  for (const int size : { 1, 2, 7, 8, 9, 15, 16, 31, 33, 64, 65, 70 })
  {
    const DeformerCase small =
      MakeCase({ { 0, size, 0, 2, 0, 2 } }, { { 1, 1, 1 } }, MakeJitter(size, 0.15));
    const auto voxels = static_cast<std::size_t>(small.GetNumberOfVoxels());
    const auto shorts = MakeRandomValues<std::int16_t>(voxels, size);
    const auto floats = MakeRandomValues<float>(voxels, size);
    std::vector<VolumeArray> arrays{ MakeArray(shorts), MakeArray(floats) };
    for (VolumeArray& array : arrays)
    {
      const auto memory = std::make_shared<GuardedMemory>(voxels * GetElementSize(array.Type));
      std::memcpy(memory->Data, array.Data, voxels * GetElementSize(array.Type));
      array.Data = memory->Data;
      array.Owner = memory;
    }
    const auto outputVoxels = static_cast<std::size_t>(GetNumberOfPoints(small.Output));
    for (const Route route : { Route::Field, Route::Mesh, Route::Runs })
    {
      Load(this->Deformer, small, arrays, route);
      const Deformed expected = RunDeformer(this->Deformer, small, arrays);
      ExpectEqualsReference(small, ResampleByReference(small), arrays, expected);
      const GuardedMemory first(2 * outputVoxels);
      const GuardedMemory second(4 * outputVoxels);
      const GuardedMemory coverage(outputVoxels);
      DeformRequest request;
      request.OutputExtent = small.Output;
      request.Outputs = std::vector<void*>{ first.Data, second.Data };
      request.Coverage = reinterpret_cast<signed char*>(coverage.Data);
      this->Deformer.Deform(request);
      EXPECT_EQ(std::memcmp(first.Data, expected.Outputs[0].data(), 2 * outputVoxels), 0);
      EXPECT_EQ(std::memcmp(second.Data, expected.Outputs[1].data(), 4 * outputVoxels), 0);
    }
  }
}

// Outputs and their slabs are written in place, or copied from the device. On CPUs, output memory
// that is not aligned is copied.
TEST_F(HostMemory, OutputsInSlabs)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const std::int64_t voxels = GetNumberOfPoints(this->Case.Output);
  const std::int64_t plane = GetSize(this->Case.Output, 0) * GetSize(this->Case.Output, 1);
  // The widest array has 16 bytes per voxel, as links do: slabs have five planes of the volume or
  // more.
  for (const std::int64_t planes : { std::int64_t{ 5 }, std::int64_t{ 8 }, std::int64_t{ 1000 } })
  {
    this->Deformer.SetDevice("");
    this->Deformer.SetAllocationLimit(static_cast<std::uint64_t>(16 * planes * plane));
    Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
    this->ExpectRight();
    this->ExpectRight(Resampling::ExactByCell);
    const Deformed expected = RunDeformer(this->Deformer, this->Case, this->Arrays);
    for (const std::size_t shift : { 0, 1, 2 })
    {
      std::vector<unsigned char> first(2 * voxels + 2);
      std::vector<unsigned char> second(16 * voxels + 2);
      std::vector<signed char> coverage(voxels);
      DeformRequest request;
      request.OutputExtent = this->Case.Output;
      request.Outputs = { first.data() + shift, second.data() + shift };
      request.Coverage = coverage.data();
      const DeformReport report = this->Deformer.Deform(request);
      EXPECT_EQ(report.NumberOfCoveredVoxels, this->Reference.NumberOfCoveredVoxels);
      EXPECT_EQ(coverage, expected.Coverage);
      EXPECT_EQ(std::memcmp(first.data() + shift, expected.Outputs[0].data(), 2 * voxels), 0);
      EXPECT_EQ(std::memcmp(second.data() + shift, expected.Outputs[1].data(), 16 * voxels), 0);
    }
  }
}

// Chunks of different numbers of layers. If vertices or tetrahedra are missing, cells at the end of
// a chunk depend on cells of the next chunk.
TEST_F(HostMemory, MaskedVolumesInChunks)
{
  for (const double amplitude : { 0.0, 0.15 })
  {
    DeformerCase masked =
      MakeCase({ { 0, 12, 0, 11, 0, 22 } }, { { 1, 1, 1 } }, MakeJitter(9, amplitude));
    std::mt19937 random(8);
    masked.Blanked.resize(static_cast<std::size_t>(masked.GetNumberOfVoxels()));
    masked.Active.resize(static_cast<std::size_t>(GetNumberOfCells(masked.VoxelGrid.VertexExtent)));
    std::generate(masked.Blanked.begin(), masked.Blanked.end(), [&] { return random() % 16 == 0; });
    std::generate(masked.Active.begin(), masked.Active.end(),
      [&] { return static_cast<unsigned char>(random() % 8 ? 31 : random() % 32); });
    const auto values =
      MakeRandomValues<float>(static_cast<std::size_t>(masked.GetNumberOfVoxels()), 3);
    const std::vector<VolumeArray> arrays{ MakeArray(values) };
    const reference::Result reference = ResampleByReference(masked);
    for (const std::uint64_t layers : { 1, 2, 3, 5, 6, 7 })
    {
      SCOPED_TRACE(testing::Message() << "amplitude " << amplitude << " layers " << layers);
      VolumeDeformer deformer;
      deformer.SetDevice("");
      // Links have 16 bytes, and a chunk has three planes more than it has layers.
      deformer.SetAllocationLimit(16 * 13 * 12 * (layers + 3));
      Load(deformer, masked, arrays, Route::Mesh);
      for (const Resampling method : { Resampling::Exact, Resampling::ExactByCell })
      {
        ExpectEqualsReference(
          masked, reference, arrays, RunDeformer(deformer, masked, arrays, method));
      }
    }
  }
}

TEST_F(HostMemory, AbortBetweenSlabs)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  const std::int64_t plane = GetSize(this->Case.Output, 0) * GetSize(this->Case.Output, 1);
  this->Deformer.SetDevice("");
  this->Deformer.SetAllocationLimit(static_cast<std::uint64_t>(16 * 6 * plane));
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  for (int calls = 1; calls < 6; ++calls)
  {
    // The memory is freed as soon as the call has ended.
    auto first =
      std::make_unique<std::vector<unsigned char>>(2 * GetNumberOfPoints(this->Case.Output) + 1);
    auto second = std::make_unique<std::vector<double>>(2 * GetNumberOfPoints(this->Case.Output));
    auto coverage =
      std::make_unique<std::vector<signed char>>(GetNumberOfPoints(this->Case.Output));
    DeformRequest request;
    request.OutputExtent = this->Case.Output;
    request.Outputs = { first->data() + 1, second->data() };
    request.Coverage = coverage->data();
    int left = calls;
    request.Progress = [&left](double) { return --left > 0; };
    EXPECT_THROW(this->Deformer.Deform(request), Aborted);
    first.reset();
    second.reset();
    coverage.reset();
    this->ExpectRight();
  }
}
