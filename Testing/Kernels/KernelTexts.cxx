// SPDX-License-Identifier: BSD-3-Clause
// Writes the OpenCL programs that this library builds into a folder, one of each kind, for
// Testing/gpu-compilers.sh. It deforms volumes in all supported ways, on any device, which appears
// to be a graphics card.
//
// Usage: KernelTexts FOLDER (double | single | processor) [texts | linked DRIVER LINKER]
//   double     the device appears to be a graphics card with double precision
//   single     the device appears to be a graphics card without double precision
//   processor  the device is a CPU, and is not disguised
//   texts      no kernel is run, which saves their compilation. Programs that depend on results of
//              kernels are written for few kinds of arrays only, and no launches are recorded
//   linked     as texts, with all types of arrays in one program instead of several programs. The
//              OpenCL driver with the path DRIVER compiles and links all kernels, with the program
//              ld in the folder LINKER: see Testing/Wheel/link_kernels.py
//
// The folder gets, for each program, a file NAME.cl, a file NAME.options, and a file NAME.nvidia
// with the options that only NVIDIA's drivers have. The list kernels.txt has a line for each
// kernel: the name of the program, the name of the kernel, and over all of its launches the largest
// number of work-items of a group and the largest number of bytes of local memory in arguments.
// Both are 0 if the kernel was not launched.
#include "ChainMailSubject.h"
#include "Device.h"
#include "FakeDriver.h"
#include "LatticeBody.h"
#include "MassSpringModel.h"
#include "OpenCLContext.h"
#include "RasterCase.h"
#include "ResamplingProgram.h"
#include "VectorBounds.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numeric>
#include <string>

using namespace deformvolume;

namespace
{

/// The programs to build, and the device.
struct Plan
{
  std::string Folder;
  bool IsProcessor = false;
  bool HasDouble = true;
  bool IsRun = true;
  std::string Driver; // the driver that links all kernels; empty: no kernel is linked
  std::string Linker;
};

/// Makes the driver compile and link all kernels of a program. PoCL does so if its binary is
/// requested.
void LinkProgram(const std::string& text, const std::string& options)
{
  const OpenCLContext& context = OpenCLContext::Get(FindDevice(""));
  const cl::Program program(context.GetContext(), text);
  program.build({ context.GetDevice().Device }, options.c_str());
  const auto binaries = program.getInfo<CL_PROGRAM_BINARIES>();
  if (binaries.size() != 1 || binaries[0].empty())
  {
    throw Error("The driver has no binary of a program.");
  }
}

class Recorder
{
public:
  explicit Recorder(const Plan& plan)
    : Folder(plan.Folder)
    , IsLinking(!plan.Driver.empty())
  {
    FakeDriver& driver = FakeDriver::Get();
    driver.OnBuild = [this](const std::string& text, const std::string& options,
                       const std::string& kernels) { this->AddProgram(text, options, kernels); };
    driver.OnLaunch = [this](const FakeDriver::Launch& launch)
    {
      Use& use = this->Kernels[{ this->Names.at(launch.Text), launch.Kernel }];
      use.Items = std::max(use.Items, launch.Items);
      use.LocalMemory = std::max(use.LocalMemory, launch.LocalMemory);
    };
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Sets the purpose of the programs that are built from now on. It becomes a part of their names.
  void SetPurpose(const std::string& words) { this->Purpose = words; }

  void WriteKernels() const
  {
    std::ofstream file(this->Folder + "/kernels.txt");
    for (const auto& [kernel, use] : this->Kernels)
    {
      file << kernel.first << " " << kernel.second << " " << use.Items << " " << use.LocalMemory
           << "\n";
    }
    if (!file.flush())
    {
      throw Error("Cannot write to the folder \"" + this->Folder + "\".");
    }
  }

private:
  struct Use
  {
    std::size_t Items = 0;
    std::size_t LocalMemory = 0;
  };

  void AddProgram(const std::string& text, const std::string& options, const std::string& kernels)
  {
    std::string& name = this->Names[text];
    if (!name.empty())
    {
      return;
    }
    // The last kernel of a text belongs to this text. Kernels before it may also belong to other
    // texts.
    name = kernels.substr(kernels.rfind(';') + 1) + "-" + this->Purpose;
    const int count = ++this->Counts[name];
    name += count > 1 ? "-" + std::to_string(count) : "";
    if (this->IsLinking)
    {
      LinkProgram(text, options);
    }
    std::ofstream(this->Folder + "/" + name + ".cl") << text;
    const std::size_t others = std::min(options.find(" -cl-nv-"), options.size());
    std::ofstream(this->Folder + "/" + name + ".options") << options.substr(0, others) << "\n";
    std::ofstream(this->Folder + "/" + name + ".nvidia") << options.substr(others) << "\n";
    for (std::size_t begin = 0; begin < kernels.size();)
    {
      const std::size_t end = std::min(kernels.find(';', begin), kernels.size());
      this->Kernels[{ name, kernels.substr(begin, end - begin) }];
      begin = end + 1;
    }
  }

  std::string Folder;
  bool IsLinking;
  std::string Purpose;
  std::map<std::string, std::string> Names; // of the programs, by their text
  std::map<std::string, int> Counts;        // number of programs with each name
  std::map<std::pair<std::string, std::string>, Use> Kernels;
};

/// A volume that is folded in places, and has cells that are large enough to be deferred.
DeformerCase MakeFolded()
{
  const auto jitter = MakeJitter(3, 1.0);
  return MakeCase({ { 0, 7, 0, 5, 0, 4 } }, NoScale,
    [&jitter](const glm::dvec3& index)
    { return index + (index == glm::dvec3(7, 5, 4) ? glm::dvec3(60) : jitter(index) - index); });
}

/// Computes a whole output, and then an update of a part of it.
void Deform(VolumeDeformer& deformer, const DeformerCase& deformerCase,
  const std::vector<VolumeArray>& arrays, Resampling method = Resampling::Exact)
{
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(deformerCase.Output));
  std::vector<std::vector<char>> outputs;
  DeformRequest request;
  request.Method = method;
  request.OutputExtent = deformerCase.Output;
  for (const VolumeArray& array : arrays)
  {
    outputs.emplace_back(
      voxels * static_cast<std::size_t>(array.Components) * GetElementSize(array.Type));
    request.Outputs.push_back(outputs.back().data());
  }
  std::vector<signed char> coverage(voxels);
  request.Coverage = coverage.data();
  request.MayStayOnDevice = true;
  deformer.Deform(request);
}

/// Values for arrays of all types: their bits are irrelevant here.
const std::vector<std::uint64_t> Values(100000);

VolumeArray MakeArray(ElementType type, int components = 1, bool categorical = false)
{
  VolumeArray array;
  array.Data = Values.data();
  array.Type = type;
  array.Components = components;
  array.Categorical = categorical;
  return array;
}

const std::vector<VolumeArray> OneArray{ MakeArray(ElementType::Int16) };

/// Arrays of all types, and labels of all types.
std::vector<VolumeArray> MakeAllArrays(const Plan& plan)
{
  std::vector<VolumeArray> arrays;
  for (const bool categorical : { false, true })
  {
#define ADD(name, type, cl)                                                                        \
  if (plan.HasDouble || GetElementSize(ElementType::name) < 4 ||                                   \
    ElementType::name == ElementType::Float32)                                                     \
  {                                                                                                \
    arrays.push_back(MakeArray(ElementType::name, 1, categorical));                                \
  }
    DEFORMVOLUME_ELEMENT_TYPES(ADD)
#undef ADD
  }
  arrays.push_back(MakeArray(ElementType::UInt8, 3));
  return arrays;
}

void DeformEach(Recorder& recorder, const std::string& purpose, const DeformerCase& deformerCase)
{
  for (const auto& [route, name] : { std::make_pair(Route::Mesh, "links"),
         std::make_pair(Route::Runs, "runs"), std::make_pair(Route::Field, "field") })
  {
    recorder.SetPurpose(name + purpose);
    VolumeDeformer deformer;
    Load(deformer, deformerCase, OneArray, route);
    Deform(deformer, deformerCase, OneArray);
    if (route != Route::Field)
    {
      // Two nodes coincide.
      std::vector<std::int32_t> places(static_cast<std::size_t>(deformerCase.GetNumberOfVoxels()));
      std::iota(places.begin(), places.end(), 0);
      places.back() = 0;
      deformer.SetCoincidentNodes(places.data());
      Deform(deformer, deformerCase, OneArray);
    }
  }
}

using ArrayKinds = std::vector<std::pair<std::string, std::vector<VolumeArray>>>;

void DeformArrays(Recorder& recorder, const Plan& plan)
{
  const DeformerCase folded = MakeFolded();
  ArrayKinds kinds{
    { "uint8", { MakeArray(ElementType::UInt8) } },
    { "float", { MakeArray(ElementType::Float32) } },
    { "uint8x3", { MakeArray(ElementType::UInt8, 3) } },
    { "labels16", { MakeArray(ElementType::UInt16, 1, true) } },
    { "int16-labels8-floatx3",
      { MakeArray(ElementType::Int16), MakeArray(ElementType::UInt8, 1, true),
        MakeArray(ElementType::Float32, 3) } },
  };
  if (plan.HasDouble)
  {
    kinds.push_back({ "double", { MakeArray(ElementType::Float64) } });
    kinds.push_back({ "int32", { MakeArray(ElementType::Int32) } });
    kinds.push_back({ "int64", { MakeArray(ElementType::Int64) } });
  }
  if (!plan.Driver.empty())
  {
    kinds = { { "all", MakeAllArrays(plan) } };
  }
  for (const auto& [name, arrays] : kinds)
  {
    recorder.SetPurpose("links-" + name);
    VolumeDeformer deformer;
    Load(deformer, folded, arrays, Route::Mesh);
    Deform(deformer, folded, arrays);
  }
}

void DeformByDeviceVectors(Recorder& recorder, const Plan& plan)
{
  const DeformerCase folded = MakeFolded();
  const auto vectors =
    std::make_shared<DeviceVectors>("", static_cast<std::size_t>(folded.GetNumberOfVoxels()));
  std::vector<float> displacements = folded.GetDisplacements();
  vectors->Write(displacements.data());
  DisplacementField field;
  for (int axis = 0; axis < 3; ++axis)
  {
    field.Dimensions[axis] = static_cast<int>(GetSize(folded.VoxelGrid.VertexExtent, axis));
  }
  if (plan.HasDouble)
  {
    field.ToDisplacement = { { 0.5, 0, 0, 0, 1, 0, 0, 0, 1 } };
  }
  recorder.SetPurpose("vectors");
  VolumeDeformer deformer;
  Load(deformer, folded, OneArray, Route::Mesh);
  deformer.SetNodeDisplacements(vectors, field.ToDisplacement);
  Deform(deformer, folded, OneArray);
  recorder.SetPurpose("fieldinplace-int16");
  Load(deformer, folded, OneArray, Route::Field);
  deformer.SetDisplacementField(field, vectors);
  Deform(deformer, folded, OneArray);
  FindDeformedBounds(folded.VoxelGrid, field, *vectors);
}

void DeformCut(Recorder& recorder)
{
  DeformerCase cut = MakeFolded();
  const auto voxels = static_cast<std::size_t>(cut.GetNumberOfVoxels());
  for (std::size_t voxel = 0; voxel < voxels; ++voxel)
  {
    cut.CutDistances.push_back(voxel % 8 < 4 ? -1.0F : 1.0F);
  }
  cut.Crossed.assign(GetNumberOfCells(cut.VoxelGrid.VertexExtent), 31);
  DeformEach(recorder, "-int16-cut", cut);
}

/// A field that ends between the voxels of the volume.
void DeformPart(Recorder& recorder)
{
  DeformerCase deformerCase = MakeFolded();
  DisplacementField field;
  field.Dimensions = { { 3, 3, 3 } };
  const std::vector<float> vectors(81, 0.25F);
  field.Vectors = vectors.data();
  field.IndexToField = { { 1, 0, 0, -1.5, 0, 1, 0, -1.5, 0, 0, 1, -1.5 } };
  recorder.SetPurpose("boundary-int16");
  VolumeDeformer deformer;
  Load(deformer, deformerCase, OneArray, Route::Field);
  deformer.SetDisplacementField(field);
  Deform(deformer, deformerCase, OneArray);
}

void Rasterize(Recorder& recorder, const Plan& plan)
{
  const RasterCase mesh = MakeRasterCase(
    { { 0, 9, 0, 8, 0, 7 } }, 2, [](const glm::dvec3& index) { return index * 1.1; });
  ArrayKinds kinds{ { "int16", OneArray },
    { "float-labels8",
      { MakeArray(ElementType::Float32), MakeArray(ElementType::UInt8, 1, true) } } };
  if (plan.HasDouble)
  {
    kinds.push_back({ "double", { MakeArray(ElementType::Float64) } });
  }
  if (!plan.Driver.empty())
  {
    kinds = { { "all", MakeAllArrays(plan) } };
  }
  for (const auto& [name, arrays] : kinds)
  {
    for (const Interpolation interpolation : { Interpolation::Linear, Interpolation::Cubic })
    {
      recorder.SetPurpose(name + (interpolation == Interpolation::Cubic ? "-cubic" : "-linear"));
      VolumeDeformer deformer;
      Load(deformer, mesh, arrays);
      ::Rasterize(deformer, mesh, arrays, interpolation);
      DisplacementField field;
      field.Dimensions = { { 2, 2, 2 } };
      const std::vector<float> vectors(24, 0.25F);
      field.Vectors = vectors.data();
      deformer.SetVoxelGrid(mesh.VoxelGrid, 16, false);
      deformer.SetArrays(arrays);
      deformer.SetInverseField(field);
      ::Rasterize(deformer, mesh, arrays, interpolation);
    }
  }
  RasterCase masked = mesh;
  masked.Active.assign(static_cast<std::size_t>(GetNumberOfCells(mesh.VoxelGrid.VertexExtent)), 15);
  recorder.SetPurpose("int16-linear-masked");
  LoadAndRun(masked, OneArray);
}

void MoveBodies(Recorder& recorder)
{
  recorder.SetPurpose("chainmail");
  const Extent extent{ { 0, 9, 0, 8, 0, 4 } };
  chainMailTesting::Subject subject(extent);
  subject.Model.SetMaterials({ { 0.5, 1.5, 0.5 } }, nullptr);
  subject.Step({ chainMailTesting::MakeHandle({ { 4, 4, 2 } }, { { 5, 0, 0 } }) }, 2);
  recorder.SetPurpose("massspring");
  ElasticBody body = physicsTesting::MakeLatticeBody({ { 4, 3, 3 } }, glm::dvec3(2.5e-3));
  physicsTesting::FixNodes(body, [](const glm::dvec3& point) { return point.x == 0.0; });
  MassSpringModel model;
  MassSpringRequest request;
  request.Duration = 1e-3;
  try
  {
    model.SetBody(body);
    model.Advance(request);
  }
  catch (const Error&)
  {
    if (!FakeDriver::Get().SkipsLaunches) // without launches, the forces of the springs are missing
    {
      throw;
    }
  }
}

/// Builds programs for volumes of more than 2^30 cells, and other programs that the volumes here
/// may not need.
void BuildOthers(Recorder& recorder)
{
  recorder.SetPurpose("links-int16-wide");
  OpenCLContext& context = OpenCLContext::Get(FindDevice(""));
  for (const ResamplingKernel form : { ResamplingKernel::Columns, ResamplingKernel::DeferredInt64,
         ResamplingKernel::Cells, ResamplingKernel::LargeCells })
  {
    const bool bits = form != ResamplingKernel::Cells;
    GetResamplingProgram(context, MappingKind::Links, OneArray, { form, true, bits, false });
  }
  for (const bool withCut : { false, true })
  {
    recorder.SetPurpose(withCut ? "links-int16-cut" : "links-int16");
    GetResamplingProgram(context, MappingKind::Links, OneArray,
      { ResamplingKernel::LargeCells, false, true, withCut });
    // Programs for outputs that the kernel by columns does not support.
    GetResamplingProgram(
      context, MappingKind::Links, OneArray, { ResamplingKernel::Cells, false, false, withCut });
    recorder.SetPurpose(withCut ? "links-int16-cubic-cut" : "links-int16-cubic");
    for (const ResamplingKernel form : { ResamplingKernel::Cells, ResamplingKernel::LargeCells })
    {
      GetResamplingProgram(
        context, MappingKind::Links, OneArray, { form, false, false, withCut, false, true });
    }
  }
}

void Build(const Plan& plan)
{
  FakeDriver& driver = FakeDriver::Get();
  if (!plan.Driver.empty())
  {
    setenv("COMPILER_PATH", plan.Linker.c_str(), 1);
    AddDriver(plan.Driver); // before its device appears to be a graphics card
  }
  driver.SkipsLaunches = !plan.IsRun;
  driver.SkipsOptimization = !plan.IsRun && plan.Driver.empty();
  driver.IsGraphics = !plan.IsProcessor;
  driver.HasDouble = plan.HasDouble;
  driver.HasNVIDIAOptions = !plan.IsProcessor && plan.Driver.empty();
  Recorder recorder(plan);
  DeformArrays(recorder, plan);
  DeformByDeviceVectors(recorder, plan);
  DeformPart(recorder);
  // If a driver links the programs, those that CPUs and graphics cards share are built only once.
  if (plan.Driver.empty() || plan.IsProcessor)
  {
    DeformEach(recorder, "-int16", MakeFolded());
    DeformCut(recorder);
    Rasterize(recorder, plan);
    MoveBodies(recorder);
  }
  if (plan.Driver.empty() || !plan.IsProcessor)
  {
    BuildOthers(recorder);
  }
  recorder.WriteKernels();
}

} // namespace

int main(int argc, char* argv[])
{
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const std::string device = arguments.size() >= 2 ? arguments[1] : "";
  const std::string way = arguments.size() >= 3 ? arguments[2] : "";
  const std::size_t count = way == "linked" ? 5 : way == "texts" ? 3 : 2;
  if ((device != "double" && device != "single" && device != "processor") ||
    arguments.size() != count)
  {
    std::fprintf(stderr,
      "usage: KernelTexts FOLDER (double | single | processor) [texts | linked DRIVER LINKER]\n");
    return 2;
  }
  Plan plan;
  plan.Folder = arguments[0];
  plan.IsProcessor = device == "processor";
  plan.HasDouble = device != "single";
  plan.IsRun = way.empty();
  if (way == "linked")
  {
    plan.Driver = arguments[3];
    plan.Linker = arguments[4];
  }
  try
  {
    Build(plan);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
