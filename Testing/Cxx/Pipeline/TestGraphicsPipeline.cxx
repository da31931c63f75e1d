// SPDX-License-Identifier: BSD-3-Clause
// Pipelines on a device that appears to be a graphics card with memory of its own. Vectors stay on
// the device, several filters share one copy, and vectors are copied to the host only when they are
// read.
#include "ChainMailTesting.h"
#include "FakeDriver.h"
#include "FilterTesting.h"
#include "vtkArrayChanges.h"
#include "vtkDeviceVectorArray.h"

#include "Device.h"
#include "DeviceVectors.h"

#include <cstdint>
#include <string>

using namespace filterTesting;
using chainMailTesting::MakeHandles;

namespace
{

// The largest size, in bytes, of parameters and results of an update.
constexpr std::uint64_t Few = 4096;

// The largest number of bytes that an update may copy: parameters and results, eight counts for
// each of the 24 sections of a brick, and bounds of positions and displacements, six numbers, for
// each of its 48 sub-bricks.
std::uint64_t GetLargestTransfer(const Deformed& deformed)
{
  return Few +
    (24 * 8 + 48 * 6) * 4 *
    static_cast<std::uint64_t>(GetReported(deformed.Filter, "Bricks of the volume"));
}

void ResetCounts()
{
  FakeDriver::Get().BytesRead = 0;
  FakeDriver::Get().BytesWritten = 0;
}

const WorldMap Bend = [](const glm::dvec3& p)
{ return p + glm::dvec3(1.3 * std::sin(0.1 * p.y), 0.7, 0.9 * std::cos(0.07 * p.x)); };

// Adds a vtkDeviceVectorArray with a copy of vectors to a deformation.
template <typename DataSet>
vtkSmartPointer<vtkDeviceVectorArray> AddArray(DataSet* deformation, vtkDataArray* vectors)
{
  auto array = vtkSmartPointer<vtkDeviceVectorArray>::New();
  array->DeepCopy(vectors);
  array->SetName("displacement");
  deformation->GetPointData()->SetVectors(array);
  return array;
}

void SetOutput(Deformed& deformed)
{
  // An output that is much smaller than the displacements.
  deformed.Filter->SetOutputBoundsModeToCustomBounds();
  deformed.Filter->SetCustomBounds(20, 24, 20, 24, 20, 24);
}

// An image and its segmentation, which has another spacing, with one deformation.
TEST(GraphicsPipeline, TwoVolumes)
{
  const auto image = MakeVolume({ { 0, 40, 0, 40, 0, 40 } });
  const auto labels = MakeImage({ { 0, 27, 0, 27, 0, 27 } }, glm::dvec3(1.5, 1.5, 1.4));
  AddScalars<unsigned char>(
    labels, "label", [](const glm::dvec3& p) { return p.x + p.y > 40.0 ? 3.0 : 1.0; });
  const auto floats = MakeMesh(image, 25);
  SetDisplacements(floats, Bend);
  vtkNew<vtkUnstructuredGrid> mesh;
  mesh->ShallowCopy(floats);
  const auto array = AddArray(mesh.Get(), floats->GetPointData()->GetVectors());
  const std::uint64_t bytes = 12 * static_cast<std::uint64_t>(array->GetNumberOfTuples());
  Deformed found[2] = { { image, mesh }, { labels, mesh } };
  Deformed expected[2] = { { image, floats }, { labels, floats } };
  vtkNew<vtkArrayChanges> log;
  log->SetArray(array);
  auto* moved = vtkFloatArray::SafeDownCast(floats->GetPointData()->GetVectors());
  for (int frame = 0; frame < 5; ++frame)
  {
    const bool isLogged = frame >= 3;
    const vtkIdType last = isLogged ? 1009 : array->GetNumberOfTuples() - 1;
    for (vtkIdType id = isLogged ? 1000 : 0; id <= last; ++id)
    {
      const float x = 0.01F * static_cast<float>((id + 3 * frame) % 50);
      moved->SetComponent(id, 0, x);
      array->SetTypedComponent(id, 0, x);
    }
    moved->Modified();
    if (isLogged)
    {
      log->AddTuples(1000, 1009);
    }
    else
    {
      array->Modified();
    }
    for (int i = 0; i < 2; ++i)
    {
      SetOutput(expected[i]);
      SetOutput(found[i]);
      expected[i].Update();
    }
    ResetCounts();
    for (Deformed& one : found)
    {
      one.Update();
    }
    EXPECT_EQ(array->GetNumberOfUploads(), frame + 1);
    if (frame > 0)
    {
      EXPECT_GE(FakeDriver::Get().BytesWritten, isLogged ? 120 : bytes);
      EXPECT_LT(FakeDriver::Get().BytesWritten, (isLogged ? 120 : bytes) + Few);
      EXPECT_LT(
        FakeDriver::Get().BytesRead, GetLargestTransfer(found[0]) + GetLargestTransfer(found[1]));
      std::cout << "Frame " << frame << ": " << FakeDriver::Get().BytesWritten
                << " bytes written for two volumes, " << bytes << " in all vectors\n";
    }
    for (int i = 0; i < 2; ++i)
    {
      EXPECT_TRUE(AreEqual(expected[i].Filter->GetOutput(), found[i].Filter->GetOutput()));
    }
  }
  // With DEFORMED_BOUNDS and with mesh rasterization the host reads the vectors: it has them
  // already.
  for (int i = 0; i < 2; ++i)
  {
    expected[i].Filter->SetOutputBoundsModeToDeformedBounds();
    found[i].Filter->SetOutputBoundsModeToDeformedBounds();
    EXPECT_TRUE(AreEqual(expected[i].Update(), found[i].Update()));
    expected[i].Filter->SetResamplerToMeshRasterization();
    found[i].Filter->SetResamplerToMeshRasterization();
    EXPECT_TRUE(AreEqual(expected[i].Update(), found[i].Update()));
    expected[i].Filter->SetResamplerToExact();
    found[i].Filter->SetResamplerToExact();
    EXPECT_TRUE(AreEqual(expected[i].Update(), found[i].Update()));
  }
  EXPECT_EQ(array->GetNumberOfDownloads(), 0);
  // An error names the vector that is not finite, and the filters work again afterwards.
  array->SetTypedComponent(1234, 2, static_cast<float>(std::nan("")));
  array->Modified();
  SetOutput(found[0]);
  SetOutput(expected[0]);
  found[0].Filter->Update();
  EXPECT_EQ(found[0].TakeErrors(), 1);
  EXPECT_TRUE(HasPart(found[0].LastError, "node 1234 "));
  array->SetTypedComponent(1234, 2, moved->GetTypedComponent(1234, 2));
  array->Modified();
  EXPECT_TRUE(AreEqual(expected[0].Update(), found[0].Update()));
  // A vtkFloatArray replaces the array, then is replaced by it.
  mesh->GetPointData()->SetVectors(moved);
  moved->SetComponent(1234, 2, 0.5);
  moved->Modified();
  EXPECT_TRUE(AreEqual(expected[0].Update(), found[0].Update()));
  mesh->GetPointData()->SetVectors(array);
  array->SetTypedComponent(1234, 2, 0.5F);
  array->Modified();
  EXPECT_TRUE(AreEqual(expected[0].Update(), found[0].Update()));
}

// A field whose points are at voxels, and one with another spacing.
TEST(GraphicsPipeline, Fields)
{
  const auto volume = MakeVolume({ { 0, 66, 0, 65, 0, 64 } });
  for (const double spacing : { 1.0, 1.3 })
  {
    const auto floats = MakeImage({ { 0, 66, 0, 65, 0, 64 } }, glm::dvec3(spacing));
    SetDisplacements(floats, Bend);
    const auto field = MakeImage({ { 0, 66, 0, 65, 0, 64 } }, glm::dvec3(spacing));
    const auto array = AddArray(field.Get(), floats->GetPointData()->GetVectors());
    Deformed expected(volume, floats);
    Deformed found(volume, field);
    for (const double scale : { 1.0, 0.7 })
    {
      for (const int mode :
        { vtkDeformVolumeFilter::VOLUME_BOUNDS, vtkDeformVolumeFilter::DEFORMED_BOUNDS })
      {
        for (Deformed* one : { &expected, &found })
        {
          one->Filter->SetDisplacementScale(scale);
          one->Filter->SetOutputBoundsMode(mode);
        }
        EXPECT_TRUE(AreEqual(expected.Update(), found.Update()));
      }
    }
    EXPECT_EQ(array->GetNumberOfUploads(), 1);
    // An error names the vector that is not finite, with each mode of output bounds.
    array->SetTypedComponent(5000, 2, static_cast<float>(std::nan("")));
    array->Modified();
    for (const int mode :
      { vtkDeformVolumeFilter::DEFORMED_BOUNDS, vtkDeformVolumeFilter::VOLUME_BOUNDS })
    {
      found.Filter->SetOutputBoundsMode(mode);
      found.Filter->Update();
      EXPECT_EQ(found.TakeErrors(), 1);
      EXPECT_TRUE(HasPart(found.LastError, " 5000 "));
    }
  }
}

// ChainMail moves a volume: the bytes that are copied between host and device in a drag.
TEST(GraphicsPipeline, ChainMail)
{
  const auto volume = MakeVolume({ { 0, 47, 0, 47, 0, 47 } });
  vtkNew<vtkChainMailDeformation> chain;
  chain->SetInputData(volume);
  chain->SetRelaxationSweeps(0);
  Deformed found;
  found.Filter->SetInputData(volume);
  found.Filter->SetDeformationConnection(chain->GetOutputPort());
  SetOutput(found);
  vtkDeviceVectorArray* array = nullptr;
  for (int step = 1; step <= 4; ++step)
  {
    chain->SetHandlesData(
      MakeHandles({ { glm::dvec3(24.0), glm::dvec3(24.0 + 5.0 + 2.5 * step, 24.0, 24.0) } }));
    ResetCounts();
    found.Update();
    const std::uint64_t moved = 12 * static_cast<std::uint64_t>(chain->GetNumberOfMovedVoxels());
    vtkDataArray* output = chain->GetOutput()->GetPointData()->GetArray("Displacement");
    array = vtkDeviceVectorArray::SafeDownCast(output);
    if (!array)
    {
      EXPECT_NE(array, nullptr);
      return;
    }
    EXPECT_TRUE(array->IsOnDevice());
    EXPECT_EQ(array->GetNumberOfUploads(), 0);
    if (step > 1) // the first update sends the volume
    {
      EXPECT_GT(moved, 4 * GetLargestTransfer(found));
      EXPECT_LT(FakeDriver::Get().BytesWritten, GetLargestTransfer(found));
      EXPECT_LT(FakeDriver::Get().BytesRead, GetLargestTransfer(found));
      EXPECT_EQ(array->GetNumberOfDownloads(), 0);
      std::cout << "Step " << step << ": " << moved << " bytes of displacements have changed, "
                << FakeDriver::Get().BytesRead << " were read and "
                << FakeDriver::Get().BytesWritten << " written\n";
    }
    // With DEFORMED_BOUNDS the device computes the bounds.
    found.Filter->SetOutputBoundsModeToDeformedBounds();
    found.Update();
    EXPECT_EQ(array->GetNumberOfDownloads(), 0);
    const Extent extent = GetExtent(found.Filter->GetOutput());
    SetOutput(found);
    found.Update();
    if (step < 3)
    {
      continue;
    }
    // The reference is a filter with a copy of the displacements on the host.
    vtkNew<vtkImageData> copied;
    copied->CopyStructure(chain->GetOutput());
    vtkNew<vtkFloatArray> floats;
    const auto vectors = array->GetVectors(deformvolume::ResolveDevice(""));
    floats->SetNumberOfComponents(3);
    floats->SetNumberOfTuples(array->GetNumberOfTuples());
    std::copy_n(vectors->Read(), floats->GetNumberOfValues(), floats->GetPointer(0));
    copied->GetPointData()->SetVectors(floats);
    Deformed expected(volume, copied);
    SetOutput(expected);
    EXPECT_TRUE(AreEqual(expected.Update(), found.Filter->GetOutput()));
    Deformed whole(volume, copied);
    EXPECT_EQ(GetExtent(whole.Update()), extent);
    if (step == 4)
    {
      // A tuple of the output is written: the filter uses it, and the next step restores it.
      const double tuple[3] = { 0.5, 0.25, 0.0 };
      floats->SetTuple(22 * 48 * 48 + 22 * 48 + 22, tuple);
      array->SetTuple(22 * 48 * 48 + 22 * 48 + 22, tuple);
      floats->Modified();
      array->Modified();
      EXPECT_EQ(array->GetNumberOfDownloads(), 1);
      Deformed again(volume, chain->GetOutput());
      SetOutput(again);
      EXPECT_TRUE(AreEqual(expected.Update(), again.Update()));
      EXPECT_EQ(array->GetNumberOfUploads(), 1);
    }
  }
  // The next step starts from the displacements of the model, without the written tuple.
  chain->SetHandlesData(MakeHandles({ { glm::dvec3(24.0), glm::dvec3(31.5, 24.0, 24.0) } }));
  EXPECT_NE(found.Update(), nullptr);
  vtkNew<vtkChainMailDeformation> other;
  other->SetInputData(volume);
  other->SetRelaxationSweeps(0);
  for (const double x : { 31.5, 34.0, 36.5, 39.0, 31.5 })
  {
    other->SetHandlesData(MakeHandles({ { glm::dvec3(24.0), glm::dvec3(x, 24.0, 24.0) } }));
    other->Update();
  }
  EXPECT_TRUE(AreEqual(other->GetOutput(), chain->GetOutput()));
}

// A drag resamples only the parts of the output that move.
TEST(GraphicsPipeline, Parts)
{
  const auto volume = MakeVolume({ { 0, 95, 0, 79, 0, 79 } });
  vtkNew<vtkChainMailDeformation> chain;
  chain->SetInputData(volume);
  chain->SetRelaxationSweeps(0);
  Deformed found;
  found.Filter->SetInputData(volume);
  found.Filter->SetDeformationConnection(chain->GetOutputPort());
  found.Filter->SetOutputBoundsModeToVolumeBounds();
  for (int step = 1; step <= 6; ++step)
  {
    chain->SetHandlesData(
      MakeHandles({ { glm::dvec3(24.0), glm::dvec3(24.0 + 0.7 * step, 24.0, 24.0) } }));
    found.Update();
    EXPECT_EQ(GetReported(found.Filter, "Bricks resampled") <
        GetReported(found.Filter, "Bricks of the volume"),
      step > 2);
    vtkDataArray* output = chain->GetOutput()->GetPointData()->GetArray("Displacement");
    auto* array = vtkDeviceVectorArray::SafeDownCast(output);
    EXPECT_EQ(array->GetNumberOfDownloads(), 0);
    vtkNew<vtkImageData> copied;
    copied->CopyStructure(chain->GetOutput());
    vtkNew<vtkFloatArray> floats;
    floats->SetNumberOfComponents(3);
    floats->SetNumberOfTuples(array->GetNumberOfTuples());
    std::copy_n(array->GetVectors(deformvolume::ResolveDevice(""))->Read(),
      floats->GetNumberOfValues(), floats->GetPointer(0));
    copied->GetPointData()->SetVectors(floats);
    Deformed expected(volume, copied);
    expected.Filter->SetOutputBoundsModeToVolumeBounds();
    EXPECT_TRUE(AreEqual(expected.Update(), found.Filter->GetOutput()));
  }
}

} // namespace
