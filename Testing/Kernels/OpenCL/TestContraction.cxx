// SPDX-License-Identifier: BSD-3-Clause
// Compilers may fuse multiplications and additions, and some compilers do so even if the program
// forbids it. Results must be the same bit for bit with every driver.
//
// Programs are compiled once in a process. The test therefore runs itself twice, with compilers
// that must not fuse and with compilers that must fuse (FakeDriver), and compares the results.
#include "DeviceNeeds.h"
#include "EditedVolume.h"
#include "FakeDriver.h"
#include "OpenCLContext.h"
#include "RasterCase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include <unistd.h>

using namespace deformvolume;

namespace
{

/// The result of each case by its name: a text of a hash and a count.
using Results = std::map<std::string, std::string>;

class Hash
{
public:
  void Add(const void* data, std::size_t bytes)
  {
    const auto* begin = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i)
    {
      this->Value = (this->Value ^ begin[i]) * 1099511628211ULL;
    }
  }
  std::string Get() const { return std::to_string(this->Value); }

private:
  std::uint64_t Value = 14695981039346656037ULL;
};

std::string Describe(const Deformed& deformed)
{
  Hash hash;
  for (const auto& output : deformed.Outputs)
  {
    hash.Add(output.data(), output.size());
  }
  hash.Add(deformed.Coverage.data(), deformed.Coverage.size());
  return hash.Get() + " " + std::to_string(deformed.Report.NumberOfCoveredVoxels);
}

/// Values of all types for a volume of `size` voxels, for one kind of mapping. Kernels of the
/// others have the usual arrays.
struct Values
{
  explicit Values(std::size_t size)
    : Shorts(MakeRandomValues<std::uint16_t>(size, 1))
    , Bytes(MakeRandomValues<std::int8_t>(2 * size, 2))
    , Floats(MakeRandomValues<float>(size, 3))
    , Doubles(MakeRandomValues<double>(size, 4))
    , Longs(MakeRandomValues<std::int64_t>(size, 5))
  {
  }
  std::vector<VolumeArray> GetArrays() const
  {
    std::vector<VolumeArray> arrays{ MakeArray(this->Shorts), MakeArray(this->Bytes, 2),
      MakeArray(this->Floats), MakeArray(this->Shorts, 1, true) };
    if (HasDoublePrecision())
    {
      arrays.push_back(MakeArray(this->Doubles));
      arrays.push_back(MakeArray(this->Longs));
    }
    return arrays;
  }

  std::vector<std::uint16_t> Shorts;
  std::vector<std::int8_t> Bytes;
  std::vector<float> Floats;
  std::vector<double> Doubles;
  std::vector<std::int64_t> Longs;
};

glm::dvec3 Bend(const glm::dvec3& at)
{
  return at * 1.07 +
    glm::dvec3(3.0 * std::sin(0.11 * at.y), 2.3 * std::cos(0.17 * at.x + 0.03 * at.z),
      1.9 * std::sin(0.07 * at.x + 0.19 * at.y));
}

void RunBoth(VolumeDeformer& deformer, const Extent& output, const std::vector<VolumeArray>& arrays,
  const std::string& name, Results& results)
{
  DeformerCase made;
  made.Output = output;
  for (const Resampling method : { Resampling::Exact, Resampling::ExactByCell })
  {
    results[name + (method == Resampling::Exact ? "" : ", by cell")] =
      Describe(RunDeformer(deformer, made, arrays, method));
  }
}

/// Links and runs of a mesh, with displacements that cause rounding errors.
void DeformByMesh(Results& results)
{
  EditedVolume volume(Extent{ { -5, 90, 0, 40, 3, 40 } });
  std::mt19937 random(5);
  for (int times = 0; times < 40; ++times)
  {
    volume.Move(random, 20, 1.3F);
  }
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(volume.Shape.VertexExtent));
  const Values values(voxels);
  const UsualArrays usual(voxels);
  for (const Route route : { Route::Mesh, Route::Runs })
  {
    const std::vector<VolumeArray> arrays = route == Route::Mesh ? values.GetArrays() : usual.Get();
    VolumeDeformer deformer;
    deformer.SetDevice("");
    deformer.SetVoxelGrid(volume.Shape);
    deformer.SetArrays(arrays);
    if (route == Route::Mesh)
    {
      deformer.SetMesh(volume.Tetrahedra.data(), volume.Tetrahedra.size(),
        volume.GetNumberOfNodes(), volume.Links.data());
    }
    else
    {
      deformer.SetMesh(
        volume.Tetrahedra.data(), volume.Tetrahedra.size(), volume.GetNumberOfNodes(), volume.Runs);
    }
    volume.SendDisplacements(deformer, route);
    RunBoth(deformer, volume.Output, arrays, route == Route::Mesh ? "links" : "runs", results);
  }
}

/// A field that is coarser than the volume, a field at its voxels, and a rotated field.
void DeformByField(Results& results)
{
  VoxelGrid voxelGrid;
  voxelGrid.VertexExtent = { { -3, 70, 2, 45, 0, 40 } };
  const Extent output{ { -8, 100, -5, 80, -5, 80 } };
  const UsualArrays usual(static_cast<std::size_t>(GetNumberOfPoints(voxelGrid.VertexExtent)));
  for (const bool coarse : { true, false })
  {
    DisplacementField field;
    field.Extrapolate = true;
    std::size_t points = 3;
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto size = static_cast<int>(GetSize(voxelGrid.VertexExtent, axis));
      field.Dimensions[axis] = coarse ? size / 3 : size;
      points *= static_cast<std::size_t>(field.Dimensions[axis]);
      if (coarse)
      {
        field.IndexToField[4 * axis + axis] = 0.317;
        field.IndexToField[4 * axis + (axis + 1) % 3] = 0.0113;
      }
      field.IndexToField[4 * axis + 3] =
        -field.IndexToField[5 * axis] * voxelGrid.VertexExtent[2 * axis];
    }
    std::vector<float> vectors = MakeRandomValues<float>(points, 6);
    for (float& number : vectors)
    {
      // Large floats have few bits for fractions of 1/256 voxel, so differences in the last bits
      // change positions.
      number = number * 4e-4F + 20.3F;
    }
    field.Vectors = vectors.data();
    for (const bool turned : { false, true })
    {
      if (turned)
      {
        field.ToDisplacement = { { 0.8, -0.6, 0.1, 0.6, 0.8, -0.3, 0.01, 1.0 / 7.0, 1.1 } };
      }
      for (const bool owned : { false, true })
      {
        field.Owner = owned ? std::make_shared<int>(0) : nullptr;
        VolumeDeformer deformer;
        deformer.SetDevice("");
        deformer.SetVoxelGrid(voxelGrid);
        deformer.SetArrays(usual.Get());
        deformer.SetDisplacementField(field);
        RunBoth(deformer, output, usual.Get(),
          std::string(coarse ? "coarse" : "fine") + " field" + (turned ? ", turned" : "") +
            (owned ? ", in place" : ""),
          results);
      }
    }
  }
}

/// Mesh rasterization, and an inverse field.
void RasterizeMesh(Results& results)
{
  const RasterCase raster =
    MakeRasterCase(Extent{ { 0, 40, -3, 33, 0, 37 } }, 5, Bend, { { 1.25, 1, 0.75 } });
  const Values values(static_cast<std::size_t>(raster.GetNumberOfVoxels()));
  const std::vector<VolumeArray> arrays = values.GetArrays();
  VolumeDeformer deformer;
  deformer.SetDevice("");
  for (const Interpolation interpolation : { Interpolation::Linear, Interpolation::Cubic })
  {
    const std::string name = interpolation == Interpolation::Linear ? ", linear" : ", cubic";
    Load(deformer, raster, arrays);
    results["mesh" + name] = Describe(Rasterize(deformer, raster, arrays, interpolation));
    DisplacementField inverse;
    inverse.Dimensions = { { 9, 8, 7 } };
    for (int axis = 0; axis < 3; ++axis)
    {
      inverse.IndexToField[4 * axis + axis] = 0.173;
      inverse.IndexToField[4 * axis + (axis + 2) % 3] = 0.0171;
      inverse.IndexToField[4 * axis + 3] = 0.611;
    }
    std::vector<float> vectors = MakeRandomValues<float>(3 * 9 * 8 * 7, 8);
    for (float& number : vectors)
    {
      number *= 2e-3F;
    }
    inverse.Vectors = vectors.data();
    deformer.SetInverseField(inverse);
    DeformerCase made;
    made.Output = raster.Output;
    results["inverse field" + name] =
      Describe(RunDeformer(deformer, made, arrays, Resampling::MeshRasterization, interpolation));
  }
}

/// Whether the compiler fuses a multiplication and an addition.
bool AreFused()
{
  const OpenCLDevice device = FindDevice("");
  const OpenCLContext& context = OpenCLContext::Get(device);
  cl::Program program(context.GetContext(),
    "#pragma OPENCL FP_CONTRACT OFF\n"
    "__kernel void Fuse(__global float* v) { v[3] = v[0] * v[1] + v[2]; }");
  program.build("-cl-std=CL1.2");
  const float epsilon = 1.0F / 4096.0F;
  std::array<float, 4> numbers{ { 1 + epsilon, 1 + epsilon, -1 - 2 * epsilon, 0 } };
  const cl::Buffer buffer(context.GetContext(), CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR,
    sizeof(numbers), numbers.data());
  const cl::CommandQueue queue(context.GetContext(), context.GetDevice().Device);
  cl::Kernel kernel(program, "Fuse");
  kernel.setArg(0, buffer);
  queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(1), cl::NDRange(1));
  queue.enqueueReadBuffer(buffer, CL_TRUE, 0, sizeof(numbers), numbers.data());
  return numbers[3] != 0.0F;
}

constexpr const char* FileVariable = "DEFORMVOLUME_TEST_RESULTS";

void WriteResults()
{
  const char* const file = std::getenv(FileVariable);
  ASSERT_NE(file, nullptr);
  Results results;
  results["fused"] = AreFused() ? "yes" : "no";
  DeformByMesh(results);
  DeformByField(results);
  RasterizeMesh(results);
  std::ofstream stream(file);
  for (const auto& [name, result] : results)
  {
    stream << name << ": " << result << "\n";
  }
  ASSERT_TRUE(stream.flush());
}

/// Returns the results of a new process, as programs are compiled only once in a process.
Results RunMyself(const std::string& test)
{
  const std::string file =
    testing::TempDir() + "DeformVolumeContraction" + std::to_string(getpid()) + test;
  std::remove(file.c_str());
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  // The new process runs one test, even if this process runs only a shard of the tests.
  const std::string command = "env -u GTEST_TOTAL_SHARDS -u GTEST_SHARD_INDEX " +
    std::string(FileVariable) + "=\"" + file + "\" \"" + program +
    "\" --gtest_also_run_disabled_tests --gtest_filter=ContractionResults.DISABLED_" + test;
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream stream(file);
  Results results;
  for (std::string line; std::getline(stream, line);)
  {
    const std::size_t colon = line.find(": ");
    results[line.substr(0, colon)] = line.substr(colon + 2);
  }
  std::remove(file.c_str());
  return results;
}

} // namespace

// The tests that the new processes run.
TEST(ContractionResults, DISABLED_Separate)
{
  WriteResults();
}

TEST(ContractionResults, DISABLED_Fused)
{
  FakeDriver::Get().FusesProducts = true;
  WriteResults();
}

TEST(Contraction, ChangesNothing)
{
  const Results separate = RunMyself("Separate");
  const Results fused = RunMyself("Fused");
  ASSERT_GT(separate.size(), 15U);
  ASSERT_EQ(separate.size(), fused.size());
  for (const auto& [name, result] : separate)
  {
    if (name != "fused")
    {
      EXPECT_EQ(result, fused.at(name)) << "kernel results " << name;
    }
  }
  if (fused.at("fused") == "no")
  {
    GTEST_SKIP() << "the driver does not contract products and sums even if it may";
  }
}
