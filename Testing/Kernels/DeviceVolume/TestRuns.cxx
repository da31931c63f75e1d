// SPDX-License-Identifier: BSD-3-Clause
// The deformation mapping by runs, compared with links and with displacements computed in long
// double.
#include "DeformerCase.h"
#include "DeviceNeeds.h"
#include "DeviceVolume.h"
#include "KernelMaking.h"
#include "KernelText.h"
#include "MappingProgram.h"
#include "MemoryNeeds.h"
#include "SamplingMeshText.h"
#include "VertexRuns.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>

using namespace deformvolume;

namespace
{

// A volume whose voxels are assigned to random tetrahedra, row by row, in runs of random lengths.
// Many voxels lie outside their tetrahedron. This is irrelevant for an affine map.
struct RunCase
{
  VoxelGrid Shape;
  std::vector<glm::dvec3> Points; // in local indices
  std::vector<Tetrahedron> Tetrahedra;
  VertexRuns Runs;
  std::vector<VertexLink> Links;

  int GetSize(int axis) const
  {
    return static_cast<int>(deformvolume::GetSize(this->Shape.VertexExtent, axis));
  }
  std::int64_t GetNumberOfVoxels() const { return GetNumberOfPoints(this->Shape.VertexExtent); }
  glm::dvec3 GetVoxel(std::int64_t voxel) const
  {
    const std::int64_t row = voxel / this->GetSize(0);
    return glm::dvec3(voxel % this->GetSize(0), row % this->GetSize(1), row / this->GetSize(1));
  }
};

// Gradients of the first three weights.
std::array<glm::dvec3, 3> GetGradients(const RunCase& runCase, const Tetrahedron& nodes)
{
  const glm::dvec3& last = runCase.Points[nodes[3]];
  const glm::dvec3 a = runCase.Points[nodes[0]] - last;
  const glm::dvec3 b = runCase.Points[nodes[1]] - last;
  const glm::dvec3 c = runCase.Points[nodes[2]] - last;
  const double determinant = glm::dot(a, glm::cross(b, c));
  return { { glm::cross(b, c) / determinant, glm::cross(c, a) / determinant,
    glm::cross(a, b) / determinant } };
}

RunCase MakeRunCase(const Extent& extent, unsigned int seed)
{
  std::mt19937 random(seed);
  RunCase made;
  made.Shape.VertexExtent = extent;
  std::uniform_real_distribution<double> between(-10.0, 40.0);
  constexpr int tetrahedra = 30;
  while (made.Tetrahedra.size() < tetrahedra)
  {
    const auto first = static_cast<std::int32_t>(made.Points.size());
    for (int node = 0; node < 4; ++node)
    {
      const double x = between(random);
      const double y = between(random);
      made.Points.emplace_back(x, y, between(random));
    }
    const Tetrahedron nodes{ { first, first + 1, first + 2, first + 3 } };
    const auto gradients = GetGradients(made, nodes);
    if (std::all_of(gradients.begin(), gradients.end(),
          [](const glm::dvec3& gradient) { return glm::length(gradient) < 0.2; }))
    {
      made.Tetrahedra.push_back(nodes);
    }
    else
    {
      made.Points.resize(first);
    }
  }
  // Some tetrahedra have several records, others have none, and the order is random.
  std::uniform_int_distribution<int> tetrahedron(1, tetrahedra - 1);
  for (int record = 0; record < 40; ++record)
  {
    RestTetrahedron rest;
    rest.Tetrahedron = tetrahedron(random);
    const auto gradients = GetGradients(made, made.Tetrahedra[rest.Tetrahedron]);
    glm::dvec3 origin;
    for (int axis = 0; axis < 3; ++axis)
    {
      origin[axis] = static_cast<double>(random() % static_cast<unsigned>(made.GetSize(axis)));
      rest.Origin[axis] = origin[axis];
    }
    for (int k = 0; k < 3; ++k)
    {
      const glm::dvec3& last = made.Points[made.Tetrahedra[rest.Tetrahedron][3]];
      rest.Weights[k] = glm::dot(gradients[k], origin - last);
      for (int axis = 0; axis < 3; ++axis)
      {
        rest.Gradients[k][axis] = gradients[k][axis];
      }
    }
    made.Runs.Tetrahedra.push_back(rest);
  }
  const std::array<int, 6> lengths{ { 1, 1, 2, 3, 7, 20 } };
  for (std::int64_t row = 0; row < made.GetNumberOfVoxels() / made.GetSize(0); ++row)
  {
    made.Runs.RowBegins.push_back(static_cast<std::uint32_t>(made.Runs.Runs.size()));
    const bool outside = random() % 8 == 0;
    for (int x = 0; x < made.GetSize(0);)
    {
      VertexRun run;
      run.Begin = x;
      run.Tetrahedron =
        outside || random() % 5 == 0 ? -1 : static_cast<std::int32_t>(random() % 40);
      made.Runs.Runs.push_back(run);
      const int end =
        outside ? made.GetSize(0) : std::min(made.GetSize(0), x + lengths[random() % 6]);
      for (; x < end; ++x)
      {
        VertexLink link;
        if (run.Tetrahedron >= 0)
        {
          const RestTetrahedron& rest = made.Runs.Tetrahedra[run.Tetrahedron];
          link.Tetrahedron = rest.Tetrahedron;
          const Tetrahedron& nodes = made.Tetrahedra[link.Tetrahedron];
          const auto gradients = GetGradients(made, nodes);
          const glm::dvec3 offset =
            made.GetVoxel(row * made.GetSize(0) + x) - made.Points[nodes[3]];
          for (int k = 0; k < 3; ++k)
          {
            link.Weights[k] = static_cast<float>(glm::dot(gradients[k], offset));
          }
        }
        made.Links.push_back(link);
      }
    }
  }
  made.Runs.RowBegins.push_back(static_cast<std::uint32_t>(made.Runs.Runs.size()));
  return made;
}

// Maps the vertices of some planes into rows: first x of the vertices of a row, then y, then z. A
// vertex without a position has INT_MIN in x.
const char* const MapPositions =
  "__kernel void MapPositions(MAPPING_PARAMETERS, __global const uchar* state,\n"
  "  __global int* positions, const KernelParameters p)\n"
  "{\n"
  "  const Mapping m = MAPPING_ARGUMENTS;\n"
  "  const int x = get_global_id(0);\n"
  "  const int y = get_global_id(1);\n"
  "  const int z = p.PlanesBegin + (int)get_global_id(2);\n"
  "  const int isSource = StateOf(state, x, y, z, &p) & DEFORMVOLUME_VERTEX_SOURCE;\n"
  "  const int4 q = isSource ? PositionOf(&m, x, y, z, &p) : (int4)(INT_MIN, 0, 0, 0);\n"
  "  __global int* place =\n"
  "    positions + ((size_t)get_global_id(2) * p.Size[1] + y) * 3 * p.Size[0] + x;\n"
  "  place[0] = q.x;\n"
  "  place[p.Size[0]] = q.y;\n"
  "  place[2 * p.Size[0]] = q.z;\n"
  "}\n";

// The result of a mapping on the device: three ints per voxel, and the state, one byte per voxel.
struct Mapped
{
  std::vector<std::array<int, 3>> Positions;
  std::vector<unsigned char> States;
};

class Device
{
public:
  // allocationLimit: the largest allocation, which determines the number of chunks.
  Device(const RunCase& runCase, std::uint64_t allocationLimit)
    : Case(runCase)
    , Context(OpenCLContext::Get(FindDevice("")))
    , Queue(Context.GetContext(), Context.GetDevice().Device, CL_QUEUE_PROFILING_ENABLE)
    , Mesh(Context, Queue, runCase.Shape, 1, allocationLimit)
  {
  }

  std::size_t GetNumberOfChunks() const { return this->Mesh.GetChunks().size(); }

  Mapped Map(bool byRuns, const std::vector<float>& displacements, const unsigned char* blanked)
  {
    this->Mesh.GetMasks().SetBlanked(blanked, 255, nullptr);
    const cl::Buffer tetrahedra =
      this->Send(GetNodeOffsets(this->Case.Tetrahedra.data(), this->Case.Tetrahedra.size()));
    std::vector<float> padded;
    for (std::size_t i = 0; i < displacements.size(); i += 3)
    {
      padded.insert(padded.end(), &displacements[i], &displacements[i] + 3);
      padded.push_back(0.0F);
    }
    const cl::Buffer nodes = this->Send(padded);
    if (byRuns)
    {
      this->Mesh.SetRuns(this->Case.Runs);
      this->Mesh.GetRecords().Evaluate(
        GetMappingProgram(this->Context, MappingKind::Runs), tetrahedra, nodes);
    }
    else
    {
      this->Mesh.SetLinks(this->Case.Links.data());
    }
    const MappingKind form = byRuns ? MappingKind::Runs : MappingKind::Links;
    const auto setMapping = [&](cl::Kernel& kernel, const VolumeChunk& chunk)
    {
      kernel.setArg(0, byRuns ? chunk.Runs : chunk.Links);
      kernel.setArg(1, byRuns ? chunk.RowRanges : tetrahedra);
      kernel.setArg(2, byRuns ? this->Mesh.GetRecords().Get() : nodes);
      kernel.setArg(3, this->Mesh.GetRestPositions());
      return cl_uint{ 4 };
    };
    this->Mesh.UpdateState(GetMappingProgram(this->Context, form), false, setMapping);
    const cl::Program program = this->Context.GetProgram(ProgramText(GetReal(this->Context)) +
        GetSamplingMeshText() + GetMappingText(form) + MapPositions,
      KernelOptions);
    Mapped mapped;
    mapped.Positions.resize(this->Case.GetNumberOfVoxels(), { { 1, 2, 3 } });
    mapped.States.resize(this->Case.GetNumberOfVoxels(), 99);
    for (const VolumeChunk& chunk : this->Mesh.GetChunks())
    {
      cl::Kernel kernel(program, "MapPositions");
      this->MapChunk(kernel, setMapping(kernel, chunk), chunk, mapped);
    }
    return mapped;
  }

private:
  template <typename T>
  cl::Buffer Send(const std::vector<T>& values)
  {
    const cl::Buffer buffer(
      this->Context.GetContext(), CL_MEM_READ_ONLY, values.size() * sizeof(T));
    this->Queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, values.size() * sizeof(T), values.data());
    return buffer;
  }

  void MapChunk(cl::Kernel& kernel, cl_uint i, const VolumeChunk& chunk, Mapped& mapped)
  {
    const KernelParameters p = this->Mesh.GetParameters(chunk);
    const std::size_t plane = static_cast<std::size_t>(p.Size[0]) * p.Size[1];
    const std::size_t voxels = plane * (p.PlanesEnd - p.PlanesBegin);
    const cl::Buffer positions(
      this->Context.GetContext(), CL_MEM_READ_WRITE, voxels * 3 * sizeof(int));
    SetArguments(kernel, i, chunk.State, positions, p);
    this->Queue.enqueueNDRangeKernel(
      kernel, cl::NullRange, cl::NDRange(p.Size[0], p.Size[1], p.PlanesEnd - p.PlanesBegin));
    std::vector<int> values(3 * voxels);
    this->Queue.enqueueReadBuffer(
      positions, CL_TRUE, 0, values.size() * sizeof(int), values.data());
    std::vector<unsigned char> states(voxels); // all 0 if the chunk stores no states
    if (chunk.State())
    {
      this->Queue.enqueueReadBuffer(chunk.State, CL_TRUE, 0, voxels, states.data());
    }
    // The planes beyond the layers of a chunk belong to the neighboring chunks.
    const int end = std::min(p.LayersEnd + 1, p.Size[2]);
    for (int z = p.LayersBegin; z < end; ++z)
    {
      for (std::size_t v = 0; v < plane; ++v)
      {
        const std::size_t local = (z - p.PlanesBegin) * plane + v;
        const std::size_t row = local / p.Size[0] * 3 * p.Size[0] + local % p.Size[0];
        mapped.Positions[z * plane + v] = { { values[row], values[row + p.Size[0]],
          values[row + 2 * p.Size[0]] } };
        // A plane between two chunks has its cells in the second chunk.
        mapped.States[z * plane + v] = states[local];
      }
    }
  }

  const RunCase& Case;
  OpenCLContext& Context;
  cl::CommandQueue Queue;
  DeviceVolume Mesh;
};

constexpr std::uint64_t NoLimit = std::uint64_t{ 1 } << 30;

std::vector<float> MakeDisplacements(const RunCase& runCase, double largest, unsigned int seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(
    -static_cast<float>(largest), static_cast<float>(largest));
  std::vector<float> displacements(3 * runCase.Points.size());
  std::generate(displacements.begin(), displacements.end(), [&] { return uniform(random); });
  return displacements;
}

// Checks the error bound of VertexRuns.h plus the rounding of positions to 1/256.
void ExpectPositionsWithinBound(
  const RunCase& runCase, const std::vector<float>& displacements, const Mapped& mapped)
{
  const long double unit = std::ldexp(1.0L, -24);
  std::int64_t row = -1;
  std::uint32_t run = 0;
  for (std::int64_t voxel = 0; voxel < runCase.GetNumberOfVoxels(); ++voxel)
  {
    const int x = static_cast<int>(voxel % runCase.GetSize(0));
    if (x == 0)
    {
      run = runCase.Runs.RowBegins[++row];
    }
    else if (run + 1 < runCase.Runs.RowBegins[row + 1] && runCase.Runs.Runs[run + 1].Begin == x)
    {
      ++run;
    }
    const std::int32_t record = runCase.Runs.Runs[run].Tetrahedron;
    if (record < 0)
    {
      ASSERT_EQ(mapped.Positions[voxel][0], INT_MIN) << "voxel " << voxel;
      continue;
    }
    const RestTetrahedron& rest = runCase.Runs.Tetrahedra[record];
    const Tetrahedron& nodes = runCase.Tetrahedra[rest.Tetrahedron];
    const glm::dvec3 at = runCase.GetVoxel(voxel);
    for (int axis = 0; axis < 3; ++axis)
    {
      const long double last = displacements[3 * nodes[3] + axis];
      long double origin = last;
      std::array<long double, 3> along{};
      for (int k = 0; k < 3; ++k)
      {
        const long double difference = displacements[3 * nodes[k] + axis] - last;
        origin += rest.Weights[k] * difference;
        for (int j = 0; j < 3; ++j)
        {
          along[j] += rest.Gradients[k][j] * difference * (at[j] - rest.Origin[j]);
        }
      }
      const long double exact = origin + along[0] + along[1] + along[2];
      const long double sum = std::fabs(along[0]) + std::fabs(along[1]) + std::fabs(along[2]);
      if (std::fabs(exact) > LargestDisplacement)
      {
        continue; // clamped
      }
      // 1 % for products of rounding errors, and an absolute term for the errors of doubles.
      const long double bound =
        1.01L * unit * (4.0L * sum + std::fabs(origin) + std::fabs(exact) + 1e-6L);
      const long double found =
        mapped.Positions[voxel][axis] - 256 * (runCase.Shape.VertexExtent[2 * axis] + at[axis]);
      const long double error = std::fabs(found - 256.0L * exact) - 0.5L;
      ASSERT_LE(error, 256.0L * bound) << "voxel " << voxel << " axis " << axis;
    }
  }
}

const Extent Extents[] = { { { -3, 40, 2, 14, 5, 20 } }, { { 0, 130, 0, 4, -2, 9 } },
  { { 7, 8, 0, 1, 0, 1 } } };

} // namespace

TEST(Runs, PositionsAreThoseOfTheAffineMaps)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  unsigned int seed = 0;
  for (const Extent& extent : Extents)
  {
    const RunCase runCase = MakeRunCase(extent, ++seed);
    Device device(runCase, NoLimit);
    for (const double largest : { 0.01, 1.0, 50.0, 2000.0, 16000.0 })
    {
      SCOPED_TRACE(largest);
      const std::vector<float> displacements = MakeDisplacements(runCase, largest, ++seed);
      ExpectPositionsWithinBound(runCase, displacements, device.Map(true, displacements, nullptr));
    }
  }
}

TEST(Runs, PositionsAreThoseOfLinks)
{
  unsigned int seed = 20;
  for (const Extent& extent : Extents)
  {
    const RunCase runCase = MakeRunCase(extent, ++seed);
    Device device(runCase, NoLimit);
    for (const double largest : { 0.5, 20.0, 100.0 })
    {
      SCOPED_TRACE(largest);
      const std::vector<float> displacements = MakeDisplacements(runCase, largest, ++seed);
      const Mapped byRuns = device.Map(true, displacements, nullptr);
      const Mapped byLinks = device.Map(false, displacements, nullptr);
      EXPECT_EQ(byRuns.States, byLinks.States);
      for (std::size_t voxel = 0; voxel < byRuns.Positions.size(); ++voxel)
      {
        for (int axis = 0; axis < 3; ++axis)
        {
          // In 1/256 voxel. Both results have an error of at most 1/1024 voxel before they are
          // rounded.
          ASSERT_LE(std::abs(byRuns.Positions[voxel][axis] - byLinks.Positions[voxel][axis]), 1)
            << "voxel " << voxel;
        }
      }
    }
  }
}

TEST(Runs, AllNodesMovingAlikeMoveVoxelsExactly)
{
  const RunCase runCase = MakeRunCase(Extents[0], 3);
  Device device(runCase, NoLimit);
  for (const std::array<float, 3>& shift :
    { std::array<float, 3>{ { 0.0F, 0.0F, 0.0F } }, std::array<float, 3>{ { 3.0F, -5.0F, 8.0F } },
      std::array<float, 3>{ { 16383.0F, -16383.0F, 0.00390625F } } })
  {
    std::vector<float> displacements;
    for (std::size_t node = 0; node < runCase.Points.size(); ++node)
    {
      displacements.insert(displacements.end(), shift.begin(), shift.end());
    }
    const Mapped mapped = device.Map(true, displacements, nullptr);
    for (std::int64_t voxel = 0; voxel < runCase.GetNumberOfVoxels(); ++voxel)
    {
      if (runCase.Links[voxel].Tetrahedron < 0)
      {
        ASSERT_EQ(mapped.Positions[voxel][0], INT_MIN);
        continue;
      }
      const glm::dvec3 at = runCase.GetVoxel(voxel);
      for (int axis = 0; axis < 3; ++axis)
      {
        ASSERT_EQ(mapped.Positions[voxel][axis],
          256.0 * (runCase.Shape.VertexExtent[2 * axis] + at[axis] + shift[axis]));
      }
    }
    if (shift[0] < 100.0F)
    {
      EXPECT_EQ(mapped.Positions, device.Map(false, displacements, nullptr).Positions);
    }
  }
}

TEST(Runs, ChunksAndBlankedVoxels)
{
  const RunCase runCase = MakeRunCase({ { 0, 21, -4, 7, 1, 160 } }, 4);
  const std::vector<float> displacements = MakeDisplacements(runCase, 30.0, 5);
  std::vector<unsigned char> blanked(runCase.GetNumberOfVoxels());
  std::mt19937 random(6);
  for (unsigned char& voxel : blanked)
  {
    voxel = random() % 50 == 0 ? 1 : 0;
  }
  Device whole(runCase, NoLimit);
  ASSERT_EQ(whole.GetNumberOfChunks(), 1U);
  const Mapped byLinks = whole.Map(false, displacements, blanked.data());
  const Mapped byRuns = whole.Map(true, displacements, blanked.data());
  EXPECT_EQ(byRuns.States, byLinks.States);
  for (std::size_t voxel = 0; voxel < blanked.size(); ++voxel)
  {
    ASSERT_EQ(byRuns.Positions[voxel][0] != INT_MIN,
      !blanked[voxel] && runCase.Links[voxel].Tetrahedron >= 0);
  }
  // A plane has 22 * 12 voxels of 16 bytes. A chunk has three planes more than layers, or five if
  // there is room.
  for (const std::uint64_t planes : { 5, 6, 50, 100 })
  {
    SCOPED_TRACE(planes);
    Device device(runCase, planes * 22 * 12 * 16);
    const std::uint64_t layers = planes - (planes > 5 ? 5 : 3);
    ASSERT_EQ(device.GetNumberOfChunks(), (159 + layers - 1) / layers);
    const Mapped inChunks = device.Map(true, displacements, blanked.data());
    EXPECT_EQ(inChunks.Positions, byRuns.Positions);
    EXPECT_EQ(inChunks.States, device.Map(false, displacements, blanked.data()).States);
  }
}

namespace
{

class DeformerRuns : public testing::Test
{
protected:
  DeformerCase Case = MakeCase({ { 0, 7, 0, 6, 0, 5 } }, { { 1, 1, 1 } }, MakeJitter(1, 0.15));
  std::vector<float> Values = MakeRandomValues<float>(this->Case.GetNumberOfVoxels(), 3);
  std::vector<VolumeArray> Arrays{ MakeArray(this->Values) };
  VertexRuns Good = MakeRuns(this->Case);
  VolumeDeformer Deformer;

  void SetUp() override { Load(this->Deformer, this->Case, this->Arrays, Route::Runs); }

  void ExpectRefused(const VertexRuns& runs, const std::string& words)
  {
    const auto nodes = static_cast<std::size_t>(this->Case.GetNumberOfVoxels());
    const std::vector<Tetrahedron> tetrahedra(nodes, Tetrahedron{ { 0, 1, 2, 3 } });
    try
    {
      this->Deformer.SetMesh(tetrahedra.data(), nodes, nodes, runs);
    }
    catch (const Error& error)
    {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
      return;
    }
    ADD_FAILURE() << "expected the error \"" << words << "\", but none was thrown";
  }
};

} // namespace

TEST_F(DeformerRuns, MisuseIsAnError)
{
  const auto change = [this](auto&& function)
  {
    VertexRuns runs = this->Good;
    function(runs);
    return runs;
  };
  const std::uint32_t row = this->Good.RowBegins[3];
  this->ExpectRefused(VertexRuns(), "rows");
  this->ExpectRefused(change([](VertexRuns& runs) { runs.RowBegins.pop_back(); }), "42 rows");
  this->ExpectRefused(change([](VertexRuns& runs) { runs.Runs.pop_back(); }), "42 rows");
  this->ExpectRefused(change([](VertexRuns& runs) { runs.RowBegins[0] = 1; }), "42 rows");
  this->ExpectRefused(
    change([](VertexRuns& runs) { runs.RowBegins[3] = runs.RowBegins[4]; }), "Row 2");
  this->ExpectRefused(change([](VertexRuns& runs) { runs.RowBegins[5] = 0xFFFFFFFF; }), "Row 4");
  this->ExpectRefused(change([row](VertexRuns& runs) { runs.Runs[row].Begin = 1; }), "first run");
  this->ExpectRefused(
    change([row](VertexRuns& runs) { runs.Runs[row + 1].Begin = 0; }), "ascending order");
  this->ExpectRefused(
    change([row](VertexRuns& runs) { runs.Runs[row + 1].Begin = 8; }), "ascending order");
  this->ExpectRefused(
    change([row](VertexRuns& runs) { runs.Runs[row + 1].Tetrahedron = -2; }), "record -2");
  this->ExpectRefused(
    change([row](VertexRuns& runs)
      { runs.Runs[row + 1].Tetrahedron = static_cast<std::int32_t>(runs.Tetrahedra.size()); }),
    "refers to record");
  this->ExpectRefused(
    change([](VertexRuns& runs) { runs.Tetrahedra[2].Tetrahedron = -1; }), "Record 2");
  this->ExpectRefused(change(
                        [this](VertexRuns& runs) {
                          runs.Tetrahedra[2].Tetrahedron =
                            static_cast<std::int32_t>(this->Case.GetNumberOfVoxels());
                        }),
    "Record 2");
  EXPECT_THROW(this->Deformer.SetMesh(nullptr, 0, 0, this->Good), Error);
  // After all errors the deformer can be used.
  const reference::Result reference = ResampleByReference(this->Case);
  Load(this->Deformer, this->Case, this->Arrays, Route::Runs);
  ExpectEqualsReference(
    this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
}

TEST_F(DeformerRuns, NewMeshNeedsNewDisplacements)
{
  const auto nodes = static_cast<std::size_t>(this->Case.GetNumberOfVoxels());
  const std::vector<Tetrahedron> tetrahedra(nodes, Tetrahedron{ { 0, 1, 2, 3 } });
  this->Deformer.SetMesh(tetrahedra.data(), nodes, nodes, this->Good);
  EXPECT_THROW(RunDeformer(this->Deformer, this->Case, this->Arrays), Error);
}

TEST_F(DeformerRuns, NoVoxelInTheMesh)
{
  VertexRuns outside;
  for (std::uint32_t row = 0; row < 42; ++row)
  {
    outside.RowBegins.push_back(row);
    outside.Runs.emplace_back();
  }
  outside.RowBegins.push_back(42);
  const Tetrahedron tetrahedron{ { 0, 1, 2, 3 } };
  const std::vector<float> displacements(12);
  this->Deformer.SetMesh(&tetrahedron, 1, 4, outside);
  this->Deformer.SetNodeDisplacements(displacements.data());
  EXPECT_EQ(RunDeformer(this->Deformer, this->Case, this->Arrays).Report.NumberOfCoveredVoxels, 0);
}

// Sets runs, links, a field and runs again on one deformer. Data of the previous form must have no
// effect.
TEST_F(DeformerRuns, RunsLinksAndFieldsAlternate)
{
  const reference::Result reference = ResampleByReference(this->Case);
  for (const Route route : { Route::Runs, Route::Mesh, Route::Runs, Route::Field, Route::Runs })
  {
    Load(this->Deformer, this->Case, this->Arrays, route);
    ExpectEqualsReference(
      this->Case, reference, this->Arrays, RunDeformer(this->Deformer, this->Case, this->Arrays));
  }
  // The voxel grid need not be set again.
  DisplacementField field;
  field.Dimensions = { { 1, 1, 1 } };
  const std::array<float, 3> vector{ { 0.0F, 0.0F, 0.0F } };
  field.Vectors = vector.data();
  field.Extrapolate = true;
  this->Deformer.SetDisplacementField(field);
  EXPECT_EQ(RunDeformer(this->Deformer, this->Case, this->Arrays).Report.NumberOfCoveredVoxels,
    this->Case.GetNumberOfVoxels());
}

TEST_F(DeformerRuns, MemoryCheckCountsRuns)
{
  SKIP_WITHOUT_DOUBLE_PRECISION()
  VoxelGrid voxelGrid;
  voxelGrid.VertexExtent = { { 0, 199, 0, 199, 0, 199 } };
  const std::uint64_t voxels = 8000000;
  const std::uint64_t runBytes = GetRunBytes(voxels / 10, 40000, 1000);
  // 4 bytes per voxel for the volume, 3 for states and masks, and 5 for the output if the device
  // does not work in place. The remaining memory suffices for runs, but not for links of 16 bytes
  // per voxel.
  this->Deformer.SetMemoryLimit(voxels * 22);
  const auto check = [&](std::uint64_t mapping)
  {
    this->Deformer.CheckMemory(
      { voxelGrid, this->Arrays, voxelGrid.VertexExtent, 100, 200, mapping, false });
  };
  EXPECT_NO_THROW(check(GetMappingBytes(voxelGrid, false, runBytes)));
  EXPECT_THROW(check(GetMappingBytes(voxelGrid, false, 0)), Error);
  this->Deformer.SetMemoryLimit(0);
  // In this case each run ends after one voxel, so runs alone would save nothing.
  Load(this->Deformer, this->Case, this->Arrays, Route::Runs);
  RunDeformer(this->Deformer, this->Case, this->Arrays);
  EXPECT_GE(this->Deformer.GetDeviceMemory(), GetBytes(this->Good));
}
