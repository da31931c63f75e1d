// SPDX-License-Identifier: BSD-3-Clause
#include "VertexCuboids.h"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace deformvolume
{
namespace
{

constexpr std::array<int, 3> Sizes{ { DEFORMVOLUME_CUBOID_X, DEFORMVOLUME_CUBOID_Y,
  DEFORMVOLUME_CUBOID_Z } };

} // namespace

VertexCuboids::VertexCuboids(const KernelParameters& p)
  : First{ { 0, 0, p.PlanesBegin } }
  , End{ { p.Size[0], p.Size[1], p.PlanesEnd } }
{
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Count[axis] =
      (std::int64_t{ this->End[axis] } - this->First[axis] + Sizes[axis] - 1) / Sizes[axis];
  }
}

std::vector<cl_uint> VertexCuboids::GetAll() const
{
  std::vector<cl_uint> all(
    static_cast<std::size_t>(this->Count[0] * this->Count[1] * this->Count[2]));
  std::iota(all.begin(), all.end(), cl_uint{ 0 });
  return all;
}

std::vector<cl_uint> VertexCuboids::Find(const std::vector<Extent>& boxes, int halo) const
{
  std::vector<cl_uint> cuboids;
  for (const Extent& box : boxes)
  {
    Extent touched; // first and last cuboid on each axis
    for (int axis = 0; axis < 3; ++axis)
    {
      const int first = std::max(box[2 * axis] - halo, this->First[axis]) - this->First[axis];
      const int last = std::min(box[2 * axis + 1] + halo, this->End[axis] - 1) - this->First[axis];
      touched[2 * axis] = first / Sizes[axis];
      touched[2 * axis + 1] = last < first ? touched[2 * axis] - 1 : last / Sizes[axis];
    }
    ForEachPoint(touched,
      [&](int x, int y, int z)
      { cuboids.push_back(static_cast<cl_uint>((z * this->Count[1] + y) * this->Count[0] + x)); });
  }
  std::sort(cuboids.begin(), cuboids.end());
  cuboids.erase(std::unique(cuboids.begin(), cuboids.end()), cuboids.end());
  return cuboids;
}

Extent VertexCuboids::GetVertices(cl_uint cuboid) const
{
  std::int64_t number = cuboid;
  Extent vertices;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int begin =
      this->First[axis] + static_cast<int>(number % this->Count[axis]) * Sizes[axis];
    vertices[2 * axis] = begin;
    vertices[2 * axis + 1] = std::min(begin + Sizes[axis], this->End[axis]) - 1;
    number /= this->Count[axis];
  }
  return vertices;
}

Extent VertexCuboids::GetCells(cl_uint cuboid) const
{
  Extent cells = this->GetVertices(cuboid);
  for (int axis = 0; axis < 3; ++axis)
  {
    cells[2 * axis + 1] = std::min(cells[2 * axis + 1], this->End[axis] - 2);
  }
  return cells;
}

void VertexCuboids::ForAll(OpenCLContext& context, const cl::CommandQueue& queue,
  const std::vector<cl_uint>& cuboids, const cl::Buffer& list,
  const std::function<void(const Launch& launch, std::size_t begin, std::size_t count)>& run)
{
  const std::size_t items = context.GetDevice().HasVectors ? 1 : DEFORMVOLUME_CUBOID_X;
  for (std::size_t begin = 0; begin < cuboids.size(); begin += AtOnce)
  {
    const std::size_t count = std::min(AtOnce, cuboids.size() - begin);
    queue.enqueueWriteBuffer(list, CL_TRUE, 0, count * sizeof(cl_uint), cuboids.data() + begin);
    run([&](const cl::Kernel& kernel)
      { context.Launch(queue, kernel, cl::NDRange(items, count), cl::NDRange(items, 1)); },
      begin, count);
  }
}

std::vector<cl_uint> JoinLists(const std::vector<cl_uint>& a, const std::vector<cl_uint>& b)
{
  std::vector<cl_uint> joined;
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(joined));
  return joined;
}

} // namespace deformvolume
