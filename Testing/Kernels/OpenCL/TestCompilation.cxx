// SPDX-License-Identifier: BSD-3-Clause
// Which kernels are compiled, the messages of the compiler, and the separation of the compilation
// time from the time of kernels.
#include "BinningProgram.h"
#include "CompilationWatch.h"
#include "DeformerCase.h"
#include "Device.h"
#include "FakeDriver.h"
#include "KernelText.h"
#include "RasterizationProgram.h"
#include "ResamplingProgram.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

using namespace deformvolume;

namespace
{

// Kernels in a cache take no time, and cause no messages of the compiler. This process therefore
// begins with empty caches.
class Compilation : public testing::Test
{
protected:
  static void SetUpTestSuite()
  {
    Directory = testing::TempDir() + "empty-caches-XXXXXX";
    ASSERT_TRUE(mkdtemp(Directory.data()));
    setenv("POCL_CACHE_DIR", (Directory + "/pocl").c_str(), 1);
    setenv("CUDA_CACHE_PATH", (Directory + "/nvidia").c_str(), 1);
    setenv("MESA_SHADER_CACHE_DIR", (Directory + "/mesa").c_str(), 1);
  }
  static void TearDownTestSuite()
  {
    std::error_code error;
    std::filesystem::remove_all(Directory, error);
  }

private:
  static inline std::string Directory;
};

bool IsDevice(const char* part)
{
  return ResolveDevice("").find(part) != std::string::npos;
}

OpenCLContext& GetContext()
{
  return OpenCLContext::Get(FindDevice(""));
}

/// Returns the messages of the compiler for a program.
std::string GetLog(const cl::Program& program)
{
  return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(GetContext().GetDevice().Device);
}

std::vector<VolumeArray> MakeArrays(const std::vector<ElementType>& types, bool categorical)
{
  std::vector<VolumeArray> arrays;
  for (const ElementType type : types)
  {
    VolumeArray array;
    array.Type = type;
    array.Categorical = categorical;
    if (type != ElementType::Float64 || HasDouble(GetContext()))
    {
      arrays.push_back(array);
    }
  }
  return arrays;
}

std::vector<ElementType> GetAllTypes()
{
  std::vector<ElementType> types;
#define ADD(name, type, cl) types.push_back(ElementType::name);
  DEFORMVOLUME_ELEMENT_TYPES(ADD)
#undef ADD
  return types;
}

const ResamplingKernel AllForms[] = { ResamplingKernel::Cells, ResamplingKernel::Lanes,
  ResamplingKernel::Columns, ResamplingKernel::DeferredInt64, ResamplingKernel::LargeCells };

bool HasBits(ResamplingKernel form)
{
  return form == ResamplingKernel::Columns || form == ResamplingKernel::DeferredInt64;
}

struct Compiled
{
  DeformReport Report;
  double Seconds; // in total
  std::vector<bool> Calls;
};

Compiled Deform(VolumeDeformer& deformer, const DeformerCase& deformerCase)
{
  std::vector<float> output(static_cast<std::size_t>(GetNumberOfPoints(deformerCase.Output)));
  std::vector<signed char> coverage(output.size());
  Compiled compiled;
  DeformRequest request;
  request.OutputExtent = deformerCase.Output;
  request.Outputs = { output.data() };
  request.Coverage = coverage.data();
  request.Compiling = [&](bool begins) { compiled.Calls.push_back(begins); };
  const auto begin = std::chrono::steady_clock::now();
  compiled.Report = deformer.Deform(request);
  compiled.Seconds =
    std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return compiled;
}

} // namespace

// This test comes first, while nothing is compiled yet.
TEST_F(Compilation, TimeIsReportedSeparately)
{
  if (IsEmulated(FindDevice("").Description))
  {
    GTEST_SKIP() << "on an emulated device the kernels run for as long as their compilation takes";
  }
  const DeformerCase deformerCase =
    MakeCase({ { 0, 15, 0, 15, 0, 15 } }, { { 1, 1, 1 } }, MakeJitter(1, 0.15));
  const std::vector<float> values(static_cast<std::size_t>(deformerCase.GetNumberOfVoxels()), 1.0F);
  const std::vector<VolumeArray> arrays{ MakeArray(values) };
  VolumeDeformer deformer;
  Load(deformer, deformerCase, arrays, Route::Field);
  const Compiled first = Deform(deformer, deformerCase);
  const Compiled second = Deform(deformer, deformerCase);
  // The remaining time is the work for some thousand voxels.
  const double work = first.Report.ResamplingTime;
  EXPECT_GT(first.Report.CompilationTime, 0.5 * first.Seconds);
  EXPECT_LE(first.Report.CompilationTime + work, first.Seconds);
  EXPECT_LT(work, 0.3 * first.Seconds);
  EXPECT_GE(first.Calls.size(), 2U);
  for (std::size_t i = 0; i < first.Calls.size(); ++i)
  {
    EXPECT_EQ(first.Calls[i], i % 2 == 0) << "call " << i << ": begin and end must alternate";
  }
  EXPECT_EQ(second.Report.CompilationTime, 0.0);
  EXPECT_TRUE(second.Calls.empty());
}

TEST_F(Compilation, ProgramsCompileConcurrently)
{
  std::promise<void> isCompiling;
  std::promise<void> hasOther;
  bool came = false;
  FakeDriver::Get().OnBuild =
    [&](const std::string& text, const std::string& /*options*/, const std::string& /*kernels*/)
  {
    if (text.find("Slow") != std::string::npos)
    {
      isCompiling.set_value();
      came = hasOther.get_future().wait_for(std::chrono::seconds(20)) == std::future_status::ready;
    }
  };
  std::thread slow(
    [] { GetContext().GetProgram(ProgramText("__kernel void Slow()\n{\n}\n"), ""); });
  isCompiling.get_future().wait();
  GetContext().GetProgram(ProgramText("__kernel void Quick()\n{\n}\n"), "");
  hasOther.set_value();
  slow.join();
  FakeDriver::Reset();
  EXPECT_TRUE(came);
}

TEST_F(Compilation, WaitsForOtherProcesses)
{
  if (!GetContext().SharesHostMemory())
  {
    GTEST_SKIP() << "the driver is not PoCL";
  }
  // A lock of another descriptor is like that of another process.
  const std::string path = std::string(std::getenv("POCL_CACHE_DIR")) + "/deformvolume.lock";
  const int file = open(path.c_str(), O_RDWR | O_CREAT, 0666);
  ASSERT_EQ(flock(file, LOCK_EX), 0);
  std::promise<void> isBuilding;
  FakeDriver::Get().OnBuild = [&](const std::string& /*text*/, const std::string& /*options*/,
                                const std::string& /*kernels*/) { isBuilding.set_value(); };
  std::thread waiting(
    [] { GetContext().GetProgram(ProgramText("__kernel void Waiting()\n{\n}\n"), ""); });
  std::future<void> building = isBuilding.get_future();
  EXPECT_EQ(building.wait_for(std::chrono::seconds(2)), std::future_status::timeout);
  close(file);
  building.wait();
  waiting.join();
  FakeDriver::Reset();
}

TEST_F(Compilation, WatchesMeasureTheirOwnThread)
{
  EXPECT_EQ(CompilationWatch::GetCurrentSeconds(), 0.0);
  {
    const CompilationWatch::Compilation nobodyWatches;
  }
  const CompilationWatch outer(nullptr);
  {
    const CompilationWatch inner(nullptr);
    CompilationWatch::Compilation compilation;
    compilation.Exclude(1000.0);
  }
  EXPECT_EQ(outer.GetSeconds(), 0.0);
  EXPECT_EQ(CompilationWatch::GetCurrentSeconds(), 0.0);
}

// PoCL writes "1 warning generated." to the user's terminal. The user cannot change the cause.
TEST_F(Compilation, NoWarnings)
{
  if (!IsDevice("Portable Computing Language"))
  {
    GTEST_SKIP() << "only PoCL writes warnings to the terminal";
  }
  OpenCLContext& context = GetContext();
  const std::vector<VolumeArray> linear = MakeArrays(GetAllTypes(), false);
  const std::vector<VolumeArray> labels = MakeArrays(GetAllTypes(), true);
  const std::vector<VolumeArray> one = MakeArrays({ ElementType::Int16 }, false);
  VoxelGrid voxelGrid;
  voxelGrid.VertexExtent = { { 0, 9, 0, 9, 0, 9 } };
  for (const MappingKind form : { MappingKind::Links, MappingKind::Runs, MappingKind::Field })
  {
    SCOPED_TRACE(static_cast<int>(form));
    for (const bool withCut : { false, true })
    {
      EXPECT_EQ(GetLog(GetMappingProgram(context, form, withCut)), "");
      EXPECT_EQ(GetLog(GetMappingProgram(context, form, withCut, true)), "");
      for (const ResamplingKernel kernel : { ResamplingKernel::Lanes, ResamplingKernel::Columns })
      {
        EXPECT_EQ(GetLog(GetResamplingProgram(
                    context, form, one, { kernel, false, HasBits(kernel), withCut })),
          "");
      }
    }
  }
  for (const ResamplingKernel kernel : AllForms)
  {
    SCOPED_TRACE(static_cast<int>(kernel));
    const bool bits = HasBits(kernel);
    const auto getLog = [&](const std::vector<VolumeArray>& arrays, bool wide, bool withCut)
    {
      return GetLog(
        GetResamplingProgram(context, MappingKind::Links, arrays, { kernel, wide, bits, withCut }));
    };
    EXPECT_EQ(getLog(linear, false, false), "");
    EXPECT_EQ(getLog(linear, true, false), "");
    EXPECT_EQ(getLog(labels, false, false), "");
    EXPECT_EQ(getLog(linear, false, true), "");
  }
  EXPECT_EQ(GetLog(GetResamplingProgram(context, MappingKind::Links, linear,
              { ResamplingKernel::LargeCells, false, true, false })),
    "");
  for (const bool withCut : { false, true })
  {
    EXPECT_EQ(GetLog(GetResamplingProgram(context, MappingKind::Links, linear,
                { ResamplingKernel::Cells, false, false, withCut, false, true })),
      "");
  }
  EXPECT_EQ(GetLog(GetOutputProgram(context)), "");
  EXPECT_EQ(GetLog(GetRangeListsProgram(context)), "");
  EXPECT_EQ(GetLog(GetEntryListsProgram(context)), "");
  for (const Interpolation interpolation : { Interpolation::Linear, Interpolation::Cubic })
  {
    for (const bool masks : { false, true })
    {
      EXPECT_EQ(
        GetLog(GetRasterizationProgram(context, linear, voxelGrid, interpolation, false, masks)),
        "");
    }
  }
}

// A program contains only the kernels of its form. A graphics card, for example, does not need the
// kernel by lanes.
TEST_F(Compilation, KernelsThatAreNotUsedAreNotCompiled)
{
  OpenCLContext& context = GetContext();
  const std::vector<VolumeArray> arrays = MakeArrays({ ElementType::Int16 }, false);
  for (const auto& [form, name] : { std::make_pair(ResamplingKernel::Cells, "Resample"),
         std::make_pair(ResamplingKernel::Lanes, "ResampleBricks"),
         std::make_pair(ResamplingKernel::Columns,
           "ResampleColumns;ResampleDeferredInt32"), // run one after the other
         std::make_pair(ResamplingKernel::DeferredInt64, "ResampleDeferredInt64"),
         std::make_pair(ResamplingKernel::LargeCells, "ResampleLargeCells") })
  {
    const std::string names = GetResamplingProgram(
      context, MappingKind::Field, arrays, { form, false, HasBits(form), false })
                                .getInfo<CL_PROGRAM_KERNEL_NAMES>();
    EXPECT_EQ(std::string(names.c_str()), name);
  }
}
