// SPDX-License-Identifier: BSD-3-Clause
#include "DeviceCut.h"

#include "BrickGrid.h"
#include "FiveTetrahedra.h"
#include "HostMemory.h"
#include "KernelMaking.h"
#include "MaskChanges.h"
#include "VertexCuboids.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>

namespace deformvolume
{
namespace
{

struct CrossedCell
{
  int X, Y;
  unsigned int Tetrahedra;
};

// Finds the cells with crossed tetrahedra in each layer.
std::vector<std::vector<CrossedCell>> FindCells(
  const std::array<int, 3>& size, const unsigned char* crossed)
{
  std::vector<std::vector<CrossedCell>> layers(static_cast<std::size_t>(size[2]));
  const MaskValues wanted{ crossed, DEFORMVOLUME_ALL_TETRAHEDRA, 0 };
  for (const Extent& box : FindMaskChanges(size, {}, wanted))
  {
    ForEachPoint(box,
      [&](int x, int y, int z)
      {
        const std::int64_t cell = (std::int64_t{ z } * size[1] + y) * size[0] + x;
        const unsigned int crossedHere = wanted.Get(static_cast<std::size_t>(cell));
        if (crossedHere != 0)
        {
          layers[static_cast<std::size_t>(z)].push_back({ x, y, crossedHere });
        }
      });
  }
  return layers;
}

// Builds the list of cut vertices plane by plane.
class CutVertexListBuilder
{
public:
  CutVertexListBuilder(const VoxelGrid& voxelGrid, const float* distances)
    : Grid(voxelGrid)
    , Distances(distances)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Size[axis] = static_cast<std::size_t>(GetSize(voxelGrid.VertexExtent, axis));
    }
    this->Plane.resize(this->Size[0] * this->Size[1], Unlisted);
    this->HasListed.resize(this->Size[1]);
  }

  void Build(const std::vector<std::vector<CrossedCell>>& layers, std::vector<CutVertex>& list,
    std::vector<std::uint32_t>& rows)
  {
    for (std::size_t z = 0; z < this->Size[2]; ++z)
    {
      for (std::size_t above = 0; above < 2; ++above)
      {
        // The layer below the plane, then the one above it.
        const std::size_t layer = z - 1 + above;
        if (layer < layers.size())
        {
          this->Mark(layers[layer], static_cast<int>(layer), above == 0 ? 1 : 0);
        }
      }
      this->Append(z, list, rows);
    }
    rows.push_back(static_cast<std::uint32_t>(list.size()));
  }

private:
  static constexpr unsigned char Unlisted = 255;

  // Marks the vertices of cells of a layer in its lower (upper = 0) or upper plane (upper = 1).
  void Mark(const std::vector<CrossedCell>& cells, int layer, int upper)
  {
    const Extent& extent = this->Grid.VertexExtent;
    for (const CrossedCell& cell : cells)
    {
      const int mirror =
        DEFORMVOLUME_MIRROR(extent[0] + cell.X, extent[2] + cell.Y, extent[4] + layer);
      unsigned int corners = 0; // of crossed tetrahedra, as bits of offsets
      for (unsigned int t = 0; t < 5; ++t)
      {
        for (const int v : FiveTetrahedra[t])
        {
          corners |= (cell.Tetrahedra >> t & 1U) << (v ^ mirror);
        }
      }
      for (unsigned int offset = 0; offset < 8; ++offset)
      {
        if ((offset >> 1U & 1U) != static_cast<unsigned int>(upper))
        {
          continue;
        }
        unsigned char& entry =
          this->Plane[(static_cast<std::size_t>(cell.Y) + (offset >> 2U)) * this->Size[0] +
            static_cast<std::size_t>(cell.X) + (offset & 1U)];
        entry = entry == Unlisted ? 0 : entry;
        this->HasListed[static_cast<std::size_t>(cell.Y) + (offset >> 2U)] = 1;
        entry |= static_cast<unsigned char>((corners >> offset & 1U) * DEFORMVOLUME_CUT_CORNER);
        entry |= static_cast<unsigned char>(offset == 0 ? cell.Tetrahedra : 0U);
      }
    }
  }

  // Appends the marked vertices of a plane to the list, and resets the marks.
  void Append(std::size_t z, std::vector<CutVertex>& list, std::vector<std::uint32_t>& rows)
  {
    for (std::size_t y = 0; y < this->Size[1]; ++y)
    {
      rows.push_back(static_cast<std::uint32_t>(list.size()));
      for (std::size_t x = 0; this->HasListed[y] && x < this->Size[0]; ++x)
      {
        const std::size_t vertex = y * this->Size[0] + x;
        unsigned char& entry = this->Plane[vertex];
        if (entry != Unlisted)
        {
          list.push_back({ static_cast<int>(x), static_cast<int>(y), static_cast<int>(z), entry,
            this->Distances[z * this->Plane.size() + vertex] });
          entry = Unlisted;
        }
      }
      this->HasListed[y] = 0;
    }
  }

  const VoxelGrid& Grid;
  const float* Distances;
  std::array<std::size_t, 3> Size{};
  std::vector<unsigned char> Plane;
  std::vector<unsigned char> HasListed; // nonzero for rows of Plane with marked vertices
};

bool ComesBefore(const CutVertex& a, const CutVertex& b)
{
  return std::array<int, 3>{ { a.Z, a.Y, a.X } } < std::array<int, 3>{ { b.Z, b.Y, b.X } };
}

// Finds the vertices whose entries in two lists differ. Returns at most one bounding box of such
// vertices for each block of the volume.
std::vector<Extent> FindChanges(const std::vector<CutVertex>& a, const std::vector<CutVertex>& b)
{
  constexpr int block = 16;
  std::map<std::array<int, 3>, Extent> boxes;
  const auto add = [&](const CutVertex& v)
  {
    const Extent vertex{ { v.X, v.X, v.Y, v.Y, v.Z, v.Z } };
    Include(boxes.try_emplace({ { v.Z / block, v.Y / block, v.X / block } }, vertex).first->second,
      vertex);
  };
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() || j != b.end())
  {
    if (j == b.end() || (i != a.end() && ComesBefore(*i, *j)))
    {
      add(*i++);
    }
    else if (i == a.end() || ComesBefore(*j, *i))
    {
      add(*j++);
    }
    else
    {
      if (std::memcmp(&*i, &*j, sizeof(CutVertex)) != 0)
      {
        add(*i);
      }
      ++i;
      ++j;
    }
  }
  std::vector<Extent> changes;
  for (const auto& box : boxes)
  {
    changes.push_back(box.second);
  }
  return changes;
}

} // namespace

std::vector<Extent> DeviceCut::Set(const OpenCLContext& context, const cl::CommandQueue& queue,
  const VoxelGrid& voxelGrid, const unsigned char* crossed, const float* distances)
{
  std::vector<CutVertex> list;
  std::vector<std::uint32_t> rows;
  if (crossed)
  {
    std::array<int, 3> cells;
    for (int axis = 0; axis < 3; ++axis)
    {
      cells[axis] = static_cast<int>(GetSize(voxelGrid.VertexExtent, axis)) - 1;
    }
    CutVertexListBuilder(voxelGrid, distances).Build(FindCells(cells, crossed), list, rows);
  }
  std::vector<Extent> changes = FindChanges(this->List, list);
  if (!changes.empty())
  {
    this->List = std::move(list);
    this->RowBegins = std::move(rows);
    this->Send(context, queue);
  }
  return changes;
}

void DeviceCut::Send(const OpenCLContext& context, const cl::CommandQueue& queue)
{
  queue.finish(); // no command may use the buffers that are released
  if (this->List.empty())
  {
    this->Now = this->Last = ListBuffers();
    this->Invalidate();
    return;
  }
  if (this->Known && !this->Last.Stencils())
  {
    this->Last = this->Now;
  }
  const auto make = [&](std::size_t bytes)
  { return cl::Buffer(context.GetContext(), CL_MEM_READ_WRITE, bytes); };
  const std::size_t listBytes = this->List.size() * sizeof(CutVertex);
  const std::size_t rowBytes = this->RowBegins.size() * sizeof(std::uint32_t);
  this->Now = ListBuffers();
  this->Numbers = cl::Buffer();
  this->Now.Rows = make(rowBytes);
  this->Now.Vertices = make(listBytes);
  this->Now.Stencils = make(this->List.size() * sizeof(cl_uint2));
  this->Now.Positions = make(this->List.size() * sizeof(cl_int4));
  this->Numbers = make(this->List.size() * sizeof(cl_uint));
  queue.enqueueWriteBuffer(this->Now.Rows, CL_TRUE, 0, rowBytes, this->RowBegins.data());
  queue.enqueueWriteBuffer(this->Now.Vertices, CL_TRUE, 0, listBytes, this->List.data());
}

std::vector<cl_uint> DeviceCut::FindNumbers(
  const KernelParameters& p, const std::vector<Extent>* moved, cl_uint& stencils) const
{
  std::vector<cl_uint> numbers;
  std::vector<unsigned char> isListed(this->List.size());
  // Each chunk has its own states, so vertices between two chunks are processed for both.
  const Extent all{ { 0, p.Size[0] - 1, 0, p.Size[1] - 1, p.LayersBegin, p.LayersEnd } };
  const auto add = [&](const Extent& box, int beyond)
  {
    for (int z = std::max(box[4] - beyond, all[4]); z <= std::min(box[5] + beyond, all[5]); ++z)
    {
      for (int y = std::max(box[2] - beyond, 0); y <= std::min(box[3] + beyond, all[3]); ++y)
      {
        const auto row = static_cast<std::size_t>(std::int64_t{ z } * p.Size[1] + y);
        const auto end = this->List.begin() + this->RowBegins[row + 1];
        auto v = std::lower_bound(this->List.begin() + this->RowBegins[row], end, box[0] - beyond,
          [](const CutVertex& vertex, int x) { return vertex.X < x; });
        for (; v != end && v->X <= box[1] + beyond; ++v)
        {
          const auto number = static_cast<cl_uint>(v - this->List.begin());
          if (!isListed[number])
          {
            isListed[number] = 1;
            numbers.push_back(number);
          }
        }
      }
    }
  };
  const auto addAll = [&](const std::vector<Extent>& boxes, int beyond)
  { std::for_each(boxes.begin(), boxes.end(), [&](const Extent& box) { add(box, beyond); }); };
  if (!this->Known)
  {
    add(all, 0);
  }
  constexpr int halo = BrickGrid::HaloOfCuts;
  addAll(this->Vertices, halo);
  addAll(this->Cells, halo);
  stencils = static_cast<cl_uint>(numbers.size());
  // VertexStates::Update() resets the states of whole cuboids. FindCutPositions completes them.
  const VertexCuboids cuboids(p);
  for (const cl_uint cuboid :
    JoinLists(cuboids.Find(this->Vertices, halo), cuboids.Find(this->Cells, halo)))
  {
    add(cuboids.GetVertices(cuboid), 0);
  }
  addAll(moved ? *moved : std::vector<Extent>{ all }, 0);
  return numbers;
}

void DeviceCut::Update(OpenCLContext& context, const cl::CommandQueue& queue,
  const KernelParameters& p, const VolumeChunk& chunk, const cl::Program& mapping,
  const MappingSetter& set, const cl::Buffer& active, const std::vector<Extent>* moved)
{
  const auto launch = [&](const cl::Kernel& kernel, std::size_t items)
  {
    constexpr std::size_t group = 64;
    if (items > 0)
    {
      context.Launch(
        queue, kernel, cl::NDRange((items + group - 1) / group * group), cl::NDRange(group));
    }
  };
  if (this->Last.Stencils())
  {
    launch(MakeKernel(mapping, "KeepStencils", this->Last.Rows, this->Last.Vertices,
             this->Last.Stencils, this->Last.Positions, this->Now.Vertices, this->Now.Stencils,
             this->Now.Positions, static_cast<cl_uint>(this->List.size()), p),
      this->List.size());
    queue.finish(); // no command may use the buffers that are released
    this->Last = ListBuffers();
  }
  cl_uint stencils = 0;
  const std::vector<cl_uint> numbers = this->FindNumbers(p, moved, stencils);
  if (numbers.empty())
  {
    return;
  }
  const auto count = static_cast<cl_uint>(numbers.size());
  queue.enqueueWriteBuffer(this->Numbers, CL_TRUE, 0, count * sizeof(cl_uint), numbers.data());
  launch(MakeKernel(mapping, "FindCutStencils", chunk.State, active, this->Now.Rows,
           this->Now.Vertices, this->Now.Stencils, this->Numbers, stencils, p),
    stencils);
  cl::Kernel kernel(mapping, "FindCutPositions");
  deformvolume::SetArguments(kernel, set(kernel, chunk), chunk.State, this->Now.Vertices,
    this->Now.Stencils, this->Now.Positions, this->Numbers, count, p);
  launch(kernel, count);
}

cl_uint DeviceCut::SetArguments(cl::Kernel& kernel, cl_uint argument) const
{
  return deformvolume::SetArguments(
    kernel, argument, this->Now.Rows, this->Now.Vertices, this->Now.Positions);
}

std::uint64_t DeviceCut::GetMemory() const
{
  std::uint64_t bytes = deformvolume::GetMemory(this->Numbers);
  for (const ListBuffers& list : { this->Now, this->Last })
  {
    bytes += deformvolume::GetMemory(list.Rows, list.Vertices, list.Stencils, list.Positions);
  }
  return bytes;
}

} // namespace deformvolume
