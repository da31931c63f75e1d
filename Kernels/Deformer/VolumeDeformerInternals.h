// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVolumeDeformerInternals_h
#define DeformVolumeVolumeDeformerInternals_h

#include "DeviceVolume.h"
#include "IncrementalUpdate.h"
#include "KernelParameters.h"
#include "MeshRasterizer.h"
#include "OpenCLContext.h"
#include "OutputSlab.h"
#include "ResamplingProgram.h"
#include "VolumeDeformer.h"

#include <chrono>
#include <optional>

namespace deformvolume
{

/// Throws an Error that names the bytes where there are too few.
void CheckBytes(std::uint64_t needed, std::uint64_t available, const char* where);

/// Points of a field. Throws an Error where it has none.
std::size_t CountPoints(const DisplacementField& field);

/// Throws an Error where a tetrahedron has a node that is none: the kernels trust these indices,
/// and a wrong one would read beyond a buffer.
void CheckIndices(const Tetrahedron* tetrahedra, std::size_t count, std::size_t numberOfNodes);

/// What a VolumeDeformer holds on its device, and how it runs the kernels.
class VolumeDeformer::Internals
{
public:
  /// Runs a function, with floating-point traps off and OpenCL's errors put into words.
  template <typename Function>
  auto Guard(Function&& function)
  {
    const FloatingPointTrapGuard guard;
    try
    {
      return function();
    }
    catch (const cl::Error& error)
    {
      this->Forget(); // what is on the device may be half done
      throw Error(GetMessage(error));
    }
  }

  /// Like Guard, for functions that send data: their time belongs to the next execution.
  template <typename Function>
  void Send(Function&& function)
  {
    const auto begin = std::chrono::steady_clock::now();
    this->Guard(function);
    this->SendingTime +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  void Forget();
  /// Of these what is about the nodes and tetrahedra of a mesh.
  void ForgetNodes();

  OpenCLContext& GetContext();

  void SelectDevice(const std::string& request);

  DeviceVolume& GetMesh();

  std::uint64_t GetAllocationLimit();

  /// Bytes allocated on the device.
  std::uint64_t GetHeldMemory() const;
  /// Bytes that may be allocated there, those included that are and will be freed or used again:
  /// all that the device has, and for a processor no more than GetSystemMemory().
  std::uint64_t GetUsableMemory();
  /// Bytes that the system had left when this was asked first in an update (it takes half a
  /// millisecond), and for a processor those held then, which are of the same memory; 0: unknown.
  std::uint64_t GetSystemMemory();
  void ForgetSystemMemory() { this->SystemMemory.reset(); }
  /// Forgets it at the end of an update, also of one that fails.
  class SystemMemoryGuard
  {
  public:
    explicit SystemMemoryGuard(Internals& internals)
      : Owner(internals)
    {
    }
    ~SystemMemoryGuard() { this->Owner.ForgetSystemMemory(); }
    SystemMemoryGuard(const SystemMemoryGuard&) = delete;
    SystemMemoryGuard& operator=(const SystemMemoryGuard&) = delete;

  private:
    Internals& Owner;
  };
  /// Whether there is room for the winners of a slab of the output, or an Error where there is not.
  bool HasRoomForWinners(const OutputSlab& slab);
  void CheckWinners(const OutputSlab& slab);

  cl::Buffer SendBuffer(const void* data, std::size_t bytes, const cl::Buffer& previous);

  void SendTetrahedra(const Tetrahedron* tetrahedra, std::size_t numberOfTetrahedra,
    std::size_t numberOfNodes, MeshOrder&& order);

  bool UseLanes(Resampling method, const OutputSlab& output) const;
  void CheckRequest(const DeformRequest& request);
  MappingForm GetMappingForm() const;
  /// Sets a kernel's first arguments, those of the mapping, and returns how many they are.
  cl_uint SetMappingArguments(cl::Kernel& kernel, const VolumeChunk& chunk) const;
  void Map(const VolumeChunk& chunk, const KernelParameters& p);
  void Launch(cl::Kernel& kernel, const cl::NDRange& items, const cl::NDRange& group);
  /// bricks: those to run, null: all.
  void Run(const DeformRequest& request, OutputSlab& output, int pass,
    const std::vector<cl_uint>* bricks = nullptr);
  void RunPublished(const DeformRequest& request, OutputSlab& output);
  cl::Kernel MakeResamplingKernel(ResamplingForm form);
  void SetResamplingArguments(cl::Kernel& kernel, const VolumeChunk& chunk,
    const OutputSlab& output, ResamplingForm form, const KernelParameters& p) const;
  struct PlannedLaunch
  {
    const VolumeChunk& Chunk;
    KernelParameters Parameters;
  };
  /// The launches of a pass over all cells. bricks: where these go brick by brick, their list.
  std::vector<PlannedLaunch> PlanLaunches(
    const OutputSlab& output, int pass, std::vector<cl_uint>* bricks) const;
  void RunExact(const DeformRequest& request, OutputSlab& output, int pass);
  /// Has a resampling kernel compiled before it runs (OpenCLContext::Prepare).
  void PrepareKernel(cl::Kernel& kernel, const VolumeChunk& chunk, const OutputSlab& output,
    ResamplingForm form, const KernelParameters& parameters);
  void LaunchBricks(cl::Kernel& kernel, const KernelParameters& p);
  void LaunchCells(cl::Kernel& kernel, const KernelParameters& p);
  void RunBricks(
    const DeformRequest& request, OutputSlab& output, int pass, const std::vector<cl_uint>& bricks);
  /// The large cells that a pass has put off.
  void RunLargeCells(const DeformRequest& request, OutputSlab& output, int pass);
  /// Waits for the launch before the last one, so that the device always has work, and reports.
  void ReportLaunch(const DeformRequest& request, cl::Event& previous);
  std::size_t GetGroupSize(const cl::Kernel& kernel) const;
  std::size_t GetCellGroup(const cl::Kernel& kernel) const;
  /// Cell layers in a launch, whole bricks of them: few enough that progress is reported, and
  /// enough that processors are not kept waiting at its end.
  int GetLayersPerLaunch() const;
  std::size_t GetNumberOfLaunches() const;
  /// False where a winner had to be chosen.
  bool RunSlab(const DeformRequest& request, OutputSlab& output, bool first, DeformReport& report);
  /// spare: bytes of device memory that may be used beyond those of one slab.
  DeformReport Deform(const DeformRequest& request, std::uint64_t spare);
  void DeformSlabs(const DeformRequest& request, std::uint64_t spare, DeformReport& report);

  /// Displacements and incremental updates; in VolumeDeformerUpdate.cxx.
  /// changes: see VolumeDeformer::SetNodeDisplacements.
  static void CheckVectors(
    const float* vectors, std::size_t count, const char* what, const PointRanges* changes);
  /// numbers: what the device calls each vector, empty: as it comes.
  void SendVectors(const float* vectors, std::size_t count,
    const std::vector<std::int32_t>& numbers, cl::Buffer& buffer, const PointRanges* changes);
  /// Displacement fields; in VolumeDeformerField.cxx.
  /// Whether the vectors of a field can be read where they lie, and what has them read there.
  bool CanReadInPlace(const DisplacementField& field, const FieldParameters& parameters);
  BufferInPlace GetFieldInPlace() const;
  void SetFieldInPlace(const DisplacementField& field);
  void ForgetField();
  void PrepareBrickPoints();
  void TellMask(const unsigned char* next, bool ofCells);
  /// See IncrementalUpdate::IsInside.
  bool IsChangeInside() const;
  bool CanUpdate(const DeformRequest& request);
  void CopyLastOutput(const DeformRequest& request) const;
  /// False where the whole output has to be made.
  bool UpdateOutput(const DeformRequest& request, OutputSlab& output, DeformReport& report);
  /// What mesh rasterisation needs and does; in VolumeDeformerRasterization.cxx.
  MeshRasterizer::Setting GetRasterizerSetting();
  void CheckRasterization(const DeformRequest& request) const;
  DeformReport Rasterize(const DeformRequest& request, std::uint64_t spare);

  OpenCLContext* Context = nullptr;
  cl::CommandQueue Queue;
  cl::CommandQueue ReadQueue; // for copies to the caller
  std::uint64_t MemoryLimit = 0;
  std::optional<std::uint64_t> SystemMemory;
  std::uint64_t AllocationLimit = 0;
  std::size_t WorkGroupSize = 0;

  std::unique_ptr<DeviceVolume> Mesh;
  std::vector<VolumeArray> Arrays; // their Data is not used after it was sent
  cl::Buffer Tetrahedra;
  cl::Buffer Nodes;
  std::vector<std::int32_t> NodeNumbers; // see MeshOrder
  std::size_t NumberOfNodes = 0;
  std::size_t NumberOfTetrahedra = 0;
  bool NodesSet = false;
  bool LastVectorsSent = false; // the last displacements that were given are on the device
  FieldParameters Field = {};
  cl::Buffer FieldVectors;
  DisplacementField FieldInPlace; // with an owner, where FieldVectors lies over its vectors
  cl::Buffer Positions;
  cl::Buffer Bricks;      // the list of those to work on
  cl::Buffer BrickRows;   // what these need, where local memory is too small
  cl::Buffer TakenBricks; // how many of these the launch that runs has taken
  cl::Buffer Pieces;      // of large cells, to work on
  /// Work on one slab goes on while the other is copied to the caller.
  std::array<OutputSlab, 2> Targets;
  MeshRasterizer Rasterizer;

  IncrementalUpdate Update;
  PointSet Changed; // vectors, while they are sent
  Resampling LastMethod = Resampling::Exact;
  Extent LastWholeExtent{ { 0, -1, 0, -1, 0, -1 } };
  std::uint64_t LastCovered = 0;
  bool WasContested = false; // whether cells of the last output overlapped

  double SendingTime = 0.0;
  double PlanningTime = 0.0; // of an incremental update
  std::vector<cl::Event> MappingEvents;
  std::vector<cl::Event> ResamplingEvents;
  // Progress: launches done, and to do as far as is known.
  std::size_t LaunchesDone = 0;
  std::size_t LaunchesExpected = 1;
};

} // namespace deformvolume

#endif
