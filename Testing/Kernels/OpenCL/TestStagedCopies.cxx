// SPDX-License-Identifier: BSD-3-Clause
// Copies to and from a device with its own memory that pass through page-locked memory in portions:
// failing copies, boxes, many threads, and whole outputs. Also failing small copies.
#include "DeformerCase.h"
#include "DeviceNeeds.h"
#include "DeviceVectors.h"
#include "FakeDriver.h"
#include "HostMemory.h"
#include "StagedCopies.h"
#include "WorkDevice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <random>
#include <thread>

using namespace deformvolume;

namespace
{

constexpr std::size_t Half = StagedCopies::HalfBytes;
constexpr std::size_t Least = StagedCopies::LeastBytes;
constexpr cl_int Failure = -5;

using Bytes = std::vector<unsigned char>;

Bytes MakeBytes(std::size_t size, unsigned int seed)
{
  return MakeRandomValues<std::uint8_t>(size, seed);
}

class Staged : public testing::Test
{
protected:
  Staged() { FakeDriver::Reset(); }
  ~Staged() override { FakeDriver::Reset(); }
  void SetUp() override { SKIP_UNLESS_GRAPHICS(); }

  const cl::CommandQueue& GetQueue() { return this->Device.GetQueue(); }
  cl::Buffer MakeBuffer(std::size_t bytes)
  {
    return cl::Buffer(this->Device.GetContext().GetContext(), CL_MEM_READ_WRITE, bytes);
  }
  /// Uses calls that bypass the code under test.
  cl::Buffer MakeBuffer(const Bytes& bytes)
  {
    const cl::Buffer buffer = this->MakeBuffer(bytes.size());
    this->GetQueue().enqueueWriteBuffer(buffer, CL_TRUE, 0, bytes.size(), bytes.data());
    return buffer;
  }
  Bytes Read(const cl::Buffer& buffer, std::size_t size)
  {
    Bytes bytes(size);
    this->GetQueue().enqueueReadBuffer(buffer, CL_TRUE, 0, size, bytes.data());
    return bytes;
  }
  /// Checks that large copies work in both directions.
  void ExpectRight()
  {
    const Bytes bytes = MakeBytes(3 * Half + 17, 5);
    const cl::Buffer buffer = this->MakeBuffer(bytes.size());
    Write(this->GetQueue(), buffer, 0, bytes.size(), bytes.data());
    EXPECT_TRUE(this->Read(buffer, bytes.size()) == bytes);
    Bytes read(bytes.size());
    BeginToRead(this->GetQueue(), buffer, bytes.size(), read.data()).Check();
    EXPECT_TRUE(read == bytes);
  }

  WorkDevice Device;
};

// A volume that takes long to read: a few planes have many bytes.
class StagedOutputs : public Staged
{
protected:
  static constexpr int Components = 4;

  StagedOutputs() { this->Arrays[1].Background = -3.0; }

  DeformRequest MakeRequest(std::vector<Bytes>& memory) const
  {
    const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(this->Case.Output));
    memory = { Bytes(2 * voxels + 2, 77), Bytes(Components * 4 * voxels + 2, 77),
      Bytes(voxels + 2, 77) };
    DeformRequest request;
    request.OutputExtent = this->Case.Output;
    request.Outputs = { memory[0].data() + 1, memory[1].data() + 1 };
    request.Coverage = reinterpret_cast<signed char*>(memory[2].data() + 1);
    return request;
  }
  /// Returns the reference of the case, which all tests share.
  const reference::Result& GetReference() const
  {
    static const reference::Result result = ResampleByReference(this->Case);
    return result;
  }
  void LoadInPlanes(std::uint64_t planes)
  {
    const Extent& output = this->Case.Output;
    const auto plane = static_cast<std::uint64_t>(GetSize(output, 0) * GetSize(output, 1));
    this->Deformer.SetDevice("");
    this->Deformer.SetAllocationLimit(Components * 4 * planes * plane);
    Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  }

  DeformerCase Case = MakeCase({ { 0, 51, -2, 48, 3, 52 } }, { { 1, 1, 1 } }, MakeJitter(5, 0.15));
  std::vector<std::uint16_t> Values =
    MakeRandomValues<std::uint16_t>(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()), 3);
  std::vector<float> Others = MakeRandomValues<float>(
    static_cast<std::size_t>(Components * this->Case.GetNumberOfVoxels()), 4);
  std::vector<VolumeArray> Arrays{ MakeArray(this->Values),
    MakeArray(this->Others, Components, true) };
  VolumeDeformer Deformer;
};

} // namespace

// This must be the first test, as page-locked memory is kept once it exists.
TEST_F(StagedOutputs, WithoutPageLockedMemory)
{
  FakeDriver& driver = FakeDriver::Get();
  driver.RefusesPinned = true;
  ASSERT_EQ(this->Device.GetContext().GetStagedCopies(), nullptr);
  driver.Reads = driver.Writes = 0;
  this->ExpectRight();
  EXPECT_EQ(driver.Reads, 2) << "one read by the test itself";
  EXPECT_EQ(driver.Writes, 1);
  const reference::Result& reference = this->GetReference();
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  ExpectEqualsReference(
    this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
  driver.ReadError = Failure;
  std::vector<Bytes> memory;
  EXPECT_THROW(this->Deformer.Deform(this->MakeRequest(memory)), Error);
  driver.ReadError = 0;
  // Later the driver has page-locked memory.
  driver.RefusesPinned = false;
  EXPECT_NE(this->Device.GetContext().GetStagedCopies(), nullptr);
  driver.Reads = driver.Writes = 0;
  this->ExpectRight();
  EXPECT_EQ(driver.Reads, 1 + 4);
  EXPECT_EQ(driver.Writes, 4);
}

// Each failing portion is reported, and nothing outside the copied range changes.
TEST_F(Staged, ReadsThatFail)
{
  FakeDriver& driver = FakeDriver::Get();
  constexpr int portions = 7;
  const Bytes bytes = MakeBytes((portions - 1) * Half + 3, 2);
  const cl::Buffer buffer = this->MakeBuffer(bytes);
  for (const bool atOnce : { false, true })
  {
    for (int good = 0; good <= portions; ++good)
    {
      SCOPED_TRACE(
        testing::Message() << "fails at once: " << atOnce << ", good copies before: " << good);
      driver.FailsAtOnce = atOnce;
      driver.ReadError = Failure;
      driver.ReadsBeforeError = good;
      Bytes read(bytes.size() + 2, 77);
      PendingCopies reads;
      reads.Add(BeginToRead(this->GetQueue(), buffer, bytes.size(), read.data() + 1));
      if (good < portions)
      {
        try
        {
          reads.Check();
          ADD_FAILURE() << "expected an exception, but none was thrown";
        }
        catch (const cl::Error& error)
        {
          EXPECT_EQ(error.err(), Failure);
        }
        EXPECT_NO_THROW(reads.Check()) << "a failure is reported only once";
      }
      else
      {
        EXPECT_NO_THROW(reads.Check());
        EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), read.begin() + 1));
      }
      EXPECT_EQ(read.front(), 77);
      EXPECT_EQ(read.back(), 77);
      driver.ReadError = 0;
      this->ExpectRight();
    }
  }
}

// If one of several copies fails, all copies have ended after the error.
TEST_F(Staged, ReadsBesideOneThatFails)
{
  FakeDriver& driver = FakeDriver::Get();
  const Bytes bytes = MakeBytes(3 * Half, 2);
  const cl::Buffer buffer = this->MakeBuffer(bytes);
  for (int good = 0; good <= 9; ++good)
  {
    for (const bool checks : { true, false })
    {
      std::vector<Bytes> read(3, Bytes(bytes.size()));
      driver.ReadError = Failure;
      driver.ReadsBeforeError = good;
      {
        PendingCopies reads;
        for (Bytes& one : read)
        {
          reads.Add(BeginToRead(this->GetQueue(), buffer, bytes.size(), one.data()));
        }
        if (checks && good < 9)
        {
          EXPECT_THROW(reads.Check(), cl::Error) << "after " << good << " good reads";
        }
        else if (checks)
        {
          EXPECT_NO_THROW(reads.Check());
        }
        // otherwise the reads are destroyed without a check
      }
      const std::vector<Bytes> ended = read;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      EXPECT_TRUE(read == ended);
      driver.ReadError = 0;
    }
  }
  this->ExpectRight();
}

TEST_F(Staged, WritesThatFail)
{
  FakeDriver& driver = FakeDriver::Get();
  const Bytes bytes = MakeBytes(5 * Half, 2);
  for (const bool atOnce : { false, true })
  {
    for (int good = 0; good <= 5; ++good)
    {
      SCOPED_TRACE(
        testing::Message() << "fails at once: " << atOnce << ", good copies before: " << good);
      const cl::Buffer buffer = this->MakeBuffer(bytes.size());
      driver.FailsAtOnce = atOnce;
      driver.WriteError = Failure;
      driver.WritesBeforeError = good;
      if (good < 5)
      {
        EXPECT_THROW(Write(this->GetQueue(), buffer, 0, bytes.size(), bytes.data()), cl::Error);
      }
      else
      {
        EXPECT_NO_THROW(Write(this->GetQueue(), buffer, 0, bytes.size(), bytes.data()));
      }
      driver.WriteError = 0;
      this->ExpectRight();
    }
  }
}

// Arrays whose copy failed are discarded.
TEST_F(StagedOutputs, ArraysThatFail)
{
  FakeDriver& driver = FakeDriver::Get();
  const reference::Result& reference = this->GetReference();
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  for (const int good : { 0, 1, 3 })
  {
    driver.WriteError = Failure;
    driver.WritesBeforeError = good;
    EXPECT_THROW(this->Deformer.SetArrays(this->Arrays), Error)
      << "after " << good << " good writes";
    driver.WriteError = 0;
    std::vector<Bytes> memory;
    EXPECT_THROW(this->Deformer.Deform(this->MakeRequest(memory)), Error)
      << "after " << good << " good writes";
    Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
    ExpectEqualsReference(
      this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
  }
}

// The memory of a request is not written after the call has ended, with or without an error.
TEST_F(StagedOutputs, PortionsOfSlabsThatFail)
{
  FakeDriver& driver = FakeDriver::Get();
  const reference::Result& reference = this->GetReference();
  for (const std::uint64_t planes : { 12, 1000 })
  {
    for (const int good : { 0, 1, 2, 4 })
    {
      SCOPED_TRACE(testing::Message() << "planes: " << planes << ", good reads before: " << good);
      this->LoadInPlanes(planes);
      std::vector<Bytes> memory;
      const DeformRequest request = this->MakeRequest(memory);
      driver.ReadError = Failure;
      driver.ReadsBeforeError = good;
      EXPECT_THROW(this->Deformer.Deform(request), Error);
      const std::vector<Bytes> ended = memory;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      EXPECT_TRUE(memory == ended);
      driver.ReadError = 0;
      this->LoadInPlanes(planes);
      ExpectEqualsReference(
        this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
    }
  }
}

TEST_F(StagedOutputs, AbortBetweenSlabs)
{
  const reference::Result& reference = this->GetReference();
  int aborted = 0;
  for (const int calls : { 1, 4, 8, 12, 16, 20 })
  {
    SCOPED_TRACE(calls);
    this->LoadInPlanes(12);
    std::vector<Bytes> memory;
    DeformRequest request = this->MakeRequest(memory);
    int left = calls;
    request.Progress = [&left](double) { return --left > 0; };
    const std::vector<Bytes> before = memory;
    EXPECT_THROW(this->Deformer.Deform(request), Aborted);
    const std::vector<Bytes> ended = memory;
    aborted += ended != before ? 1 : 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_TRUE(memory == ended);
    memory.clear();
    ExpectEqualsReference(
      this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
  }
  EXPECT_GT(aborted, 0) << "no slab was read before an abort";
}

TEST_F(Staged, RangesOfAllSizes)
{
  FakeDriver& driver = FakeDriver::Get();
  this->ExpectRight(); // afterwards page-locked memory exists
  constexpr std::size_t offset = 13;
  for (const std::size_t middle : { Least, Half, 2 * Half, 3 * Half })
  {
    for (std::size_t size = middle - 1; size <= middle + 1; ++size)
    {
      SCOPED_TRACE(size);
      const auto portions = size < Least ? 1 : static_cast<int>((size + Half - 1) / Half);
      const Bytes bytes = MakeBytes(size, 3);
      Bytes whole = MakeBytes(size + 2 * offset, 4);
      const cl::Buffer buffer = this->MakeBuffer(whole);
      driver.Reads = driver.Writes = 0;
      Write(this->GetQueue(), buffer, offset, size, bytes.data());
      EXPECT_EQ(driver.Writes, portions);
      std::copy(bytes.begin(), bytes.end(), whole.begin() + offset);
      EXPECT_TRUE(this->Read(buffer, whole.size()) == whole);
      Bytes read(size + 2, 77);
      driver.Reads = 0;
      BeginToReadRange(this->GetQueue(), buffer, offset, size, read.data() + 1).Check();
      EXPECT_EQ(driver.Reads, portions);
      EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), read.begin() + 1));
      EXPECT_EQ(read.front(), 77);
      EXPECT_EQ(read.back(), 77);
    }
  }
}

namespace
{

/// Computes the expected result of copying a box of voxels from a buffer into memory with other
/// voxels.
void CopyBox(const Bytes& from, const Extent& whole, const Extent& part, std::size_t bytes,
  Bytes& to, const Extent& held)
{
  const auto place = [&](const Extent& extent, int x, int y, int z)
  {
    return static_cast<std::size_t>(
             ((z - extent[4]) * GetSize(extent, 1) + y - extent[2]) * GetSize(extent, 0) + x -
             extent[0]) *
      bytes;
  };
  for (int z = part[4]; z <= part[5]; ++z)
  {
    for (int y = part[2]; y <= part[3]; ++y)
    {
      std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(place(whole, part[0], y, z)),
        bytes * static_cast<std::size_t>(GetSize(part, 0)),
        to.begin() + static_cast<std::ptrdiff_t>(place(held, part[0], y, z)));
    }
  }
}

} // namespace

TEST_F(Staged, Boxes)
{
  struct Shape
  {
    Extent Whole;
    std::size_t Bytes;
  };
  // Planes of a few kilobytes, planes larger than a half, and rows larger than a half.
  const std::vector<Shape> shapes{ { { { -5, 94, 3, 62, 7, 70 } }, 8 },
    { { { 0, 1099, -4, 900, 0, 3 } }, 4 }, { { { 2, 140001, 0, 1, -1, 1 } }, 16 } };
  std::mt19937 random(4);
  FakeDriver& driver = FakeDriver::Get();
  int large = 0;
  for (const Shape& shape : shapes)
  {
    const auto size = shape.Bytes * static_cast<std::size_t>(GetNumberOfPoints(shape.Whole));
    const Bytes bytes = MakeBytes(size, 7);
    const cl::Buffer buffer = this->MakeBuffer(bytes);
    for (int times = 0; times < 48; ++times)
    {
      Extent part;
      Extent held;
      for (int axis = 0; axis < 3; ++axis)
      {
        const int first = shape.Whole[2 * axis];
        const int last = shape.Whole[2 * axis + 1];
        std::uniform_int_distribution<int> places(first, last);
        part[2 * axis] = times & 1 << axis ? first : places(random);
        part[2 * axis + 1] = times & 1 << axis ? last : places(random);
        if (part[2 * axis] > part[2 * axis + 1])
        {
          std::swap(part[2 * axis], part[2 * axis + 1]);
        }
        // The memory has the same voxels, only those of the box, or some more.
        held[2 * axis] = times % 3 == 0 ? first : part[2 * axis] - (times % 3 - 1) * 2;
        held[2 * axis + 1] = times % 3 == 0 ? last : part[2 * axis + 1] + (times % 3 - 1);
      }
      SCOPED_TRACE(testing::Message() << "bytes " << shape.Bytes << " times " << times);
      Bytes read(shape.Bytes * static_cast<std::size_t>(GetNumberOfPoints(held)), 77);
      Bytes expected = read;
      CopyBox(bytes, shape.Whole, part, shape.Bytes, expected, held);
      driver.Reads = 0;
      BeginToReadBox(this->GetQueue(), buffer, shape.Whole, part, shape.Bytes, read.data(), held)
        .Check();
      ASSERT_TRUE(read == expected);
      large += driver.Reads > 1 ? 1 : 0;
    }
  }
  EXPECT_GT(large, 40) << "number of boxes in several portions";
}

// Boxes that are contiguous on both sides are copied as one range.
TEST_F(Staged, WholePlanes)
{
  const Extent whole{ { 0, 1023, 0, 63, 0, 63 } };
  const auto size = static_cast<std::size_t>(GetNumberOfPoints(whole));
  const Bytes bytes = MakeBytes(size, 7);
  const cl::Buffer buffer = this->MakeBuffer(bytes);
  Bytes read(size, 77);
  FakeDriver::Get().Reads = 0;
  BeginToReadBox(
    this->GetQueue(), buffer, whole, { { 0, 1023, 0, 63, 8, 39 } }, 1, read.data(), whole)
    .Check();
  EXPECT_EQ(FakeDriver::Get().Reads, 2);
  Bytes expected(size, 77);
  CopyBox(bytes, whole, { { 0, 1023, 0, 63, 8, 39 } }, 1, expected, whole);
  EXPECT_TRUE(read == expected);
}

// There is only one page-locked memory, and all threads use it.
TEST_F(Staged, ManyThreads)
{
  constexpr int number = 10;
  this->ExpectRight();
  std::vector<std::thread> threads;
  std::vector<int> good(number);
  for (int thread = 0; thread < number; ++thread)
  {
    threads.emplace_back(
      [this, thread, &good]
      {
        WorkDevice device;
        device.Use(this->Device.GetContext());
        const cl::CommandQueue& queue = device.GetQueue();
        for (int times = 0; times < 4; ++times)
        {
          const Bytes bytes = MakeBytes(
            (static_cast<std::size_t>(thread) + 1) * Half / 2 + 11, static_cast<unsigned>(thread));
          const cl::Buffer buffer = this->MakeBuffer(bytes.size());
          Write(queue, buffer, 0, bytes.size(), bytes.data());
          Bytes first(bytes.size());
          Bytes second(bytes.size());
          PendingCopies reads;
          reads.Add(BeginToRead(queue, buffer, bytes.size(), first.data()));
          reads.Add(BeginToRead(device.GetReadQueue(), buffer, bytes.size(), second.data()));
          Write(queue, this->MakeBuffer(bytes.size()), 0, bytes.size(), bytes.data());
          reads.Check();
          good[static_cast<std::size_t>(thread)] += first == bytes && second == bytes ? 1 : 0;
        }
      });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  EXPECT_EQ(good, std::vector<int>(number, 4));
}

// A whole output, and slabs: one slab is read while the next one is computed.
TEST_F(StagedOutputs, Slabs)
{
  const reference::Result& reference = this->GetReference();
  std::vector<std::vector<Bytes>> all;
  for (const std::uint64_t planes : { 10, 15, 29, 1000 })
  {
    SCOPED_TRACE(planes);
    this->LoadInPlanes(planes);
    ExpectEqualsReference(
      this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
    std::vector<Bytes> memory;
    const DeformRequest request = this->MakeRequest(memory);
    FakeDriver::Get().Reads = 0;
    this->Deformer.Deform(request);
    EXPECT_GT(FakeDriver::Get().Reads, 4) << "the output must be read in several portions";
    for (const Bytes& one : memory)
    {
      EXPECT_EQ(one.front(), 77);
      EXPECT_EQ(one.back(), 77);
    }
    all.push_back(memory);
  }
  for (const std::vector<Bytes>& one : all)
  {
    EXPECT_TRUE(one == all.front());
  }
}

// A failure is reported even if no caller waits for the copy.
TEST_F(Staged, SmallWritesThatFail)
{
  FakeDriver& driver = FakeDriver::Get();
  std::vector<float> values = MakeRandomValues<float>(3 * 1000, 5);
  DeviceVectors vectors("", 1000);
  const PointRanges ranges{ { { 7, 30 } }, { { 500, 503 } } };
  for (const bool atOnce : { false, true })
  {
    for (const int good : { 0, 1, 2 })
    {
      driver.FailsAtOnce = atOnce;
      driver.WriteError = Failure;
      driver.WritesBeforeError = good;
      if (good < 2)
      {
        EXPECT_THROW(vectors.Write(values.data(), ranges), Error)
          << "fails at once: " << atOnce << ", good writes before: " << good;
      }
      else
      {
        EXPECT_NO_THROW(vectors.Write(values.data(), ranges));
      }
      driver.WriteError = 0;
    }
  }
  vectors.Write(values.data());
  EXPECT_TRUE(std::equal(values.begin(), values.end(), vectors.Read()));
}

// Writes and reads vectors, some of them or all.
TEST_F(Staged, ChangedVectorsAreCopied)
{
  const std::size_t points = 400001;
  std::vector<float> values = MakeRandomValues<float>(3 * points, 5);
  DeviceVectors vectors("", points);
  vectors.Write(values.data());
  EXPECT_TRUE(std::equal(values.begin(), values.end(), vectors.Read()));
  const PointRanges ranges{ { { 7, 30000 } }, { { 50000, 50003 } }, { { 200000, points } } };
  for (const auto& range : ranges)
  {
    for (std::size_t i = 3 * range[0]; i < 3 * range[1]; ++i)
    {
      values[i] = -values[i];
    }
  }
  FakeDriver::Get().BytesRead = FakeDriver::Get().BytesWritten = 0;
  vectors.Write(values.data(), ranges);
  EXPECT_EQ(FakeDriver::Get().BytesWritten, 12 * (29993 + 3 + points - 200000));
  EXPECT_TRUE(std::equal(values.begin(), values.end(), vectors.Read()));
  EXPECT_EQ(FakeDriver::Get().BytesRead, 12 * (29993 + 3 + points - 200000));
}
