// SPDX-License-Identifier: BSD-3-Clause
// Failing calls of the driver, settings that fail halfway, and CPUs with little local memory.
#include "DeformerCase.h"
#include "DeviceNeeds.h"
#include "FakeDriver.h"
#include "GuardedCall.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <new>

using namespace deformvolume;

namespace
{

class Faults : public testing::Test
{
protected:
  ~Faults() override { FakeDriver::Reset(); }

  DeformerCase Case = MakeCase({ { 0, 21, 0, 18, -1, 17 } }, { { 1, 1, 1 } }, MakeJitter(5, 0.15));
  reference::Result Reference = ResampleByReference(this->Case);
  std::vector<std::int16_t> Values =
    MakeRandomValues<std::int16_t>(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()), 3);
  std::vector<float> Others =
    MakeRandomValues<float>(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()), 4);
  std::vector<VolumeArray> Arrays{ MakeArray(this->Values), MakeArray(this->Others) };
  VolumeDeformer Deformer;

  void ExpectRight(Resampling method = Resampling::Exact)
  {
    ExpectEqualsReference(this->Case, this->Reference, this->Arrays,
      RunDeformer(this->Deformer, this->Case, this->Arrays, method));
  }
};

} // namespace

// Outputs in memory that is not aligned for their elements are copied.
TEST_F(Faults, ReadsThatFail)
{
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(this->Case.Output));
  const std::uint64_t plane =
    static_cast<std::uint64_t>(GetSize(this->Case.Output, 0) * GetSize(this->Case.Output, 1));
  for (const Resampling method : { Resampling::Exact, Resampling::MeshRasterization })
  {
    for (const std::uint64_t planes : { 6, 1000 })
    {
      SCOPED_TRACE(testing::Message() << "method " << int(method) << " planes " << planes);
      this->Deformer.SetDevice("");
      this->Deformer.SetAllocationLimit(16 * planes * plane);
      Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
      if (method == Resampling::MeshRasterization)
      {
        if (planes < 1000)
        {
          continue;
        }
        const Tetrahedron tetrahedron{ { 0, 1, 2, 3 } };
        const std::vector<double> nodes{ 0, 0, 0, 12, 0, 0, 0, 12, 0, 0, 0, 12 };
        const std::vector<float> displacements(12, 0.0F);
        this->Deformer.SetRestMesh(&tetrahedron, 1, 4, nodes.data());
        this->Deformer.SetNodeDisplacements(displacements.data());
      }
      std::vector<char> first(2 * voxels + 1);
      std::vector<char> second(4 * voxels + 1);
      std::vector<signed char> coverage(voxels);
      DeformRequest request;
      request.Method = method;
      request.OutputExtent = this->Case.Output;
      request.Outputs = { first.data() + 1, second.data() + 1 };
      request.Coverage = coverage.data();
      EXPECT_NO_THROW(this->Deformer.Deform(request));
      FakeDriver::Get().ReadError = -5;
      EXPECT_THROW(this->Deformer.Deform(request), Error);
      FakeDriver::Get().ReadError = 0;
      Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
      this->ExpectRight();
    }
  }
}

// The second array exceeds the allocation limit after the first array was already copied.
TEST_F(Faults, ArraysThatDoNotFit)
{
  const std::uint64_t plane = 22 * 19;
  this->Deformer.SetDevice("");
  this->Deformer.SetAllocationLimit(16 * plane * 30);
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  const auto bytes =
    MakeRandomValues<std::uint8_t>(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()), 3);
  const auto large =
    MakeRandomValues<double>(static_cast<std::size_t>(8 * this->Case.GetNumberOfVoxels()), 4);
  EXPECT_THROW(this->Deformer.SetArrays({ MakeArray(bytes), MakeArray(large, 8) }), Error);
  // The previous arrays are discarded or complete.
  try
  {
    this->ExpectRight();
  }
  catch (const Error& error)
  {
    EXPECT_NE(std::string(error.what()).find("SetArrays"), std::string::npos) << error.what();
  }
  this->Deformer.SetArrays(this->Arrays);
  this->ExpectRight();
}

TEST_F(Faults, RefusedMeshChangesNothing)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  const std::vector<VertexLink> links(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()));
  const Tetrahedron tetrahedron{ { 0, 1, 2, 3 } };
  const std::size_t tooMany = (std::size_t{ 1 } << 30) + 1;
  EXPECT_THROW(this->Deformer.SetMesh(&tetrahedron, 1, tooMany, links.data()), Error);
  this->ExpectRight();
}

TEST_F(Faults, RefusedFieldChangesNothing)
{
  Load(this->Deformer, this->Case, this->Arrays, Route::Field);
  std::vector<float> vectors(24, 0.0F);
  vectors[5] = std::numeric_limits<float>::quiet_NaN();
  DisplacementField field;
  field.Dimensions = { { 2, 2, 2 } };
  field.Extrapolate = true;
  field.Vectors = vectors.data();
  EXPECT_THROW(this->Deformer.SetDisplacementField(field), Error);
  this->ExpectRight();
}

TEST_F(Faults, ShortHostMemory)
{
  bool isClean = false;
  EXPECT_THROW(
    CallGuarded([] { throw std::bad_alloc(); }, [&] { isClean = true; }), std::bad_alloc);
  EXPECT_TRUE(isClean);
}

// The voxel grid has reserved no memory for links. There is no mesh after the error, and another
// deformation works.
TEST_F(Faults, LinksThatDoNotFit)
{
  const std::uint64_t plane = 22 * 19;
  this->Deformer.SetDevice("");
  this->Deformer.SetAllocationLimit(4 * plane * 30);
  this->Deformer.SetVoxelGrid(this->Case.VoxelGrid, 4, false);
  this->Deformer.SetArrays(this->Arrays);
  const std::vector<VertexLink> links(static_cast<std::size_t>(this->Case.GetNumberOfVoxels()));
  const Tetrahedron tetrahedron{ { 0, 1, 2, 3 } };
  const std::vector<float> displacements(24, 0.0F);
  EXPECT_THROW(this->Deformer.SetMesh(&tetrahedron, 1, 4, links.data()), Error);
  EXPECT_THROW(this->Deformer.SetNodeDisplacements(displacements.data()), Error);
  DisplacementField field;
  field.Dimensions = { { 2, 2, 2 } };
  field.Extrapolate = true;
  field.Vectors = displacements.data();
  this->Deformer.SetDisplacementField(field);
  const Deformed deformed = RunDeformer(this->Deformer, this->Case, this->Arrays);
  EXPECT_EQ(deformed.Report.NumberOfCoveredVoxels, this->Case.GetNumberOfVoxels());
}

TEST_F(Faults, LittleLocalMemory)
{
  SKIP_WITHOUT_VECTORS()
  FakeDriver::Get().LocalMemory = 32768;
  Load(this->Deformer, this->Case, this->Arrays, Route::Mesh);
  this->ExpectRight(Resampling::ExactByLanes);
  const Deformed first =
    RunDeformer(this->Deformer, this->Case, this->Arrays, Resampling::ExactByLanes);
  FakeDriver::Get().LocalMemory = 0;
  const Deformed second =
    RunDeformer(this->Deformer, this->Case, this->Arrays, Resampling::ExactByLanes);
  EXPECT_EQ(first.Outputs, second.Outputs);
}

// Chunks of a volume share planes. The result of commands on several buffers over the same memory
// is undefined.
TEST_F(Faults, BuffersOverTheSameMemory)
{
  FakeDriver::Get().RefusesOverlaps = true;
  std::vector<VolumeArray> owned = this->Arrays;
  owned.push_back(this->Arrays[0]); // the same array twice
  for (VolumeArray& array : owned)
  {
    array.Owner = std::make_shared<int>(0);
  }
  this->Arrays.push_back(this->Arrays[0]);
  const std::uint64_t plane = 22 * 19;
  for (const std::uint64_t planes : { 5, 8, 1000 })
  {
    SCOPED_TRACE(testing::Message() << "planes " << planes);
    this->Deformer.SetDevice("");
    this->Deformer.SetAllocationLimit(16 * planes * plane);
    Load(this->Deformer, this->Case, owned, Route::Mesh);
    for (int times = 0; times < 2; ++times)
    {
      this->ExpectRight();
      this->ExpectRight(Resampling::ExactByCell);
      this->Deformer.SetArrays(owned);
    }
  }
  // An array that is a part of another one.
  const auto longer = MakeRandomValues<float>(this->Others.size() + 1, 6);
  this->Arrays[1].Data = owned[1].Data = longer.data();
  this->Arrays[2] = this->Arrays[1];
  this->Arrays[2].Data = longer.data() + 1;
  owned[2] = this->Arrays[2];
  owned[2].Owner = owned[1].Owner;
  this->Deformer.SetArrays(owned);
  this->ExpectRight();
}

// The vectors of a field may also be an array of the volume.
TEST_F(Faults, FieldInTheMemoryOfAnArray)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  FakeDriver::Get().RefusesOverlaps = true;
  const auto size = static_cast<std::size_t>(this->Case.GetNumberOfVoxels());
  const auto vectors = std::make_shared<std::vector<float>>(this->Case.GetDisplacements());
  const auto numbers = MakeRandomValues<double>(4 * size, 3);
  this->Arrays = { MakeArray(*vectors, 3), MakeArray(numbers, 4) };
  std::vector<VolumeArray> owned = this->Arrays;
  owned[0].Owner = vectors;
  DisplacementField field;
  for (int axis = 0; axis < 3; ++axis)
  {
    field.Dimensions[axis] = static_cast<int>(GetSize(this->Case.VoxelGrid.VertexExtent, axis));
    field.IndexToField[4 * axis + 3] = -this->Case.VoxelGrid.VertexExtent[2 * axis];
  }
  field.Vectors = vectors->data();
  field.Owner = vectors;
  const std::uint64_t plane = 22 * 19;
  for (const std::uint64_t planes : { 10, 1000 })
  {
    SCOPED_TRACE(testing::Message() << "planes " << planes);
    for (const bool fieldFirst : { true, false })
    {
      this->Deformer.SetDevice("");
      this->Deformer.SetAllocationLimit(32 * planes * plane);
      this->Deformer.SetVoxelGrid(this->Case.VoxelGrid, 32, false);
      if (fieldFirst)
      {
        this->Deformer.SetDisplacementField(field);
      }
      this->Deformer.SetArrays(owned);
      if (!fieldFirst)
      {
        this->Deformer.SetDisplacementField(field);
      }
      this->ExpectRight();
      this->Deformer.SetArrays(owned);
      this->ExpectRight();
      this->Deformer.SetArrays(this->Arrays);
      this->ExpectRight();
    }
  }
}
