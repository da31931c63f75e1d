// SPDX-License-Identifier: BSD-3-Clause
#include "ElementBatches.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace deformvolume
{
namespace
{

// Puts two zero bits after each bit of a number.
std::uint64_t SpreadBits(std::uint64_t value)
{
  std::uint64_t spread = 0;
  for (int bit = 0; bit < 21; ++bit)
  {
    spread |= (value >> bit & 1) << (3 * bit);
  }
  return spread;
}

// The position of a tetrahedron on a space-filling (Morton) curve, and its number.
using CurveCode = std::pair<std::uint64_t, std::int32_t>;

// Sorts parts and merges them in pairs: a single sort would run too long without a check for an
// abort.
void Sort(AbortCheck& abortCheck, std::vector<CurveCode>& codes)
{
  constexpr std::size_t partsAtOnce = 16;
  const auto at = [&](std::size_t index)
  { return codes.begin() + static_cast<std::ptrdiff_t>(std::min(index, codes.size())); };
  std::size_t size = std::size_t(1) << 14;
  ForParts(abortCheck, (codes.size() + size - 1) / size, partsAtOnce,
    [&](std::size_t part) { std::sort(at(part * size), at((part + 1) * size)); });
  for (; size < codes.size(); size *= 2)
  {
    ForParts(abortCheck, (codes.size() + 2 * size - 1) / (2 * size), partsAtOnce,
      [&](std::size_t part)
      {
        const std::size_t begin = 2 * part * size;
        std::inplace_merge(at(begin), at(begin + size), at(begin + 2 * size));
      });
  }
}

// Orders tetrahedra along a Morton curve, so that the tetrahedra of a chunk are near each other.
std::vector<std::int32_t> OrderTetrahedra(AbortCheck& abortCheck, const ElasticBody& body)
{
  glm::dvec3 lower(std::numeric_limits<double>::max());
  glm::dvec3 upper(-std::numeric_limits<double>::max());
  for (const glm::dvec3& point : body.Points)
  {
    lower = glm::min(lower, point);
    upper = glm::max(upper, point);
  }
  const glm::dvec3 size = upper - lower;
  const double scale = ((1 << 20) - 1) / std::max({ size.x, size.y, size.z });
  std::vector<CurveCode> codes(body.Tetrahedra.size());
  ForItemsInParallel(abortCheck, codes.size(),
    [&](std::size_t t)
    {
      glm::dvec3 center(0.0);
      for (const std::int32_t node : body.Tetrahedra[t])
      {
        center += 0.25 * (body.Points[static_cast<std::size_t>(node)] - lower);
      }
      const auto code = [&](double value)
      { return SpreadBits(static_cast<std::uint64_t>(std::max(0.0, value * scale))); };
      codes[t] = { code(center.x) | code(center.y) << 1 | code(center.z) << 2,
        static_cast<std::int32_t>(t) };
    });
  Sort(abortCheck, codes);
  std::vector<std::int32_t> order(codes.size());
  std::transform(
    codes.begin(), codes.end(), order.begin(), [](const CurveCode& code) { return code.second; });
  return order;
}

// The nodes of a tetrahedron, in the order of ElementBatch::Nodes.
std::array<std::int32_t, ElementBatch::NumberOfNodes> GetNodes(
  const ElasticBody& body, std::size_t tetrahedron)
{
  const Tetrahedron& corners = body.Tetrahedra[tetrahedron];
  std::array<std::size_t, 4> order{ { 0, 1, 2, 3 } };
  std::sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b) { return corners[a] < corners[b]; });
  std::array<std::int32_t, ElementBatch::NumberOfNodes> nodes;
  std::array<std::size_t, 4> ranks;
  for (std::size_t rank = 0; rank < order.size(); ++rank)
  {
    nodes[rank] = corners[order[rank]];
    ranks[order[rank]] = rank;
  }
  for (std::size_t edge = 0; edge < std::size(TetrahedronEdges); ++edge)
  {
    const auto& ends = TetrahedronEdges[edge];
    const int index = BatchMiddle[ranks[ends[0]]][ranks[ends[1]]];
    nodes[static_cast<std::size_t>(index)] = body.MidSides[tetrahedron][edge];
  }
  return nodes;
}

void SetLane(
  ElementBatch& batch, int lane, const ElasticBody& body, std::int32_t number, bool hasVolume)
{
  constexpr std::size_t numberOfNodes = QuadraticTetrahedron::NumberOfNodes;
  const auto nodes = GetNodes(body, static_cast<std::size_t>(number));
  std::array<glm::dvec3, numberOfNodes> points{};
  for (std::size_t i = 0; i < numberOfNodes; ++i)
  {
    batch.Nodes[i][lane] = nodes[i];
  }
  // QuadraticTetrahedron expects its own order of mid-side nodes.
  for (std::size_t i = 0; i < 4; ++i)
  {
    points[i] = body.Points[static_cast<std::size_t>(nodes[i])];
  }
  for (std::size_t edge = 0; edge < std::size(TetrahedronEdges); ++edge)
  {
    const auto& ends = TetrahedronEdges[edge];
    const auto middle = static_cast<std::size_t>(BatchMiddle[ends[0]][ends[1]]);
    points[4 + edge] = body.Points[static_cast<std::size_t>(nodes[middle])];
  }
  double volume = 0.0;
  for (std::size_t point = 0; point < QuadraticTetrahedron::NumberOfGaussPoints; ++point)
  {
    const glm::dmat3 jacobian =
      QuadraticTetrahedron::GetJacobian(points, QuadraticTetrahedron::GetGaussPoint(point));
    const double determinant = glm::determinant(jacobian);
    for (int i = 0; i < 3; ++i)
    {
      const glm::dvec3 gradient =
        glm::cross(jacobian[(i + 1) % 3], jacobian[(i + 2) % 3]) / determinant;
      batch.Gradients[point][i].X[lane] = gradient.x;
      batch.Gradients[point][i].Y[lane] = gradient.y;
      batch.Gradients[point][i].Z[lane] = gradient.z;
    }
    batch.Volumes[point][lane] =
      hasVolume ? QuadraticTetrahedron::GetGaussVolume(determinant) : 0.0;
    volume += batch.Volumes[point][lane];
  }
  batch.InverseVolume[lane] = hasVolume ? 1.0 / volume : 0.0;
}

// Gives each chunk the first color that no chunk with a common node has.
std::vector<std::vector<std::uint32_t>> ColorChunks(
  AbortCheck& abortCheck, const ElementBatches& batches, std::size_t nodes)
{
  constexpr std::size_t largestNumber = 64;
  std::vector<std::uint64_t> colorsOfNode(nodes, 0);
  std::vector<std::vector<std::uint32_t>> colors;
  std::vector<std::uint32_t> others;
  for (std::size_t chunk = 0; chunk < batches.GetNumberOfChunks(); ++chunk)
  {
    abortCheck.Check();
    const std::size_t begin = chunk * ElementBatches::ChunkSize;
    const std::size_t end = std::min(batches.Batches.size(), begin + ElementBatches::ChunkSize);
    const auto forNodes = [&](auto&& body)
    {
      for (std::size_t batch = begin; batch < end; ++batch)
      {
        for (const auto& lanes : batches.Batches[batch].Nodes)
        {
          for (const std::int32_t node : lanes)
          {
            body(colorsOfNode[static_cast<std::size_t>(node)]);
          }
        }
      }
    };
    std::uint64_t taken = 0;
    forNodes([&](std::uint64_t& mask) { taken |= mask; });
    std::size_t color = 0;
    while (color < largestNumber && (taken >> color & 1) != 0)
    {
      ++color;
    }
    if (color == largestNumber)
    {
      others.push_back(static_cast<std::uint32_t>(chunk));
      continue;
    }
    forNodes([&](std::uint64_t& mask) { mask |= std::uint64_t(1) << color; });
    colors.resize(std::max(colors.size(), color + 1));
    colors[color].push_back(static_cast<std::uint32_t>(chunk));
  }
  for (const std::uint32_t chunk : others)
  {
    colors.push_back({ chunk });
  }
  return colors;
}

} // namespace

ElementBatches MakeElementBatches(AbortCheck& abortCheck, const ElasticBody& body)
{
  ElementBatches result;
  const std::vector<std::int32_t> order = OrderTetrahedra(abortCheck, body);
  const std::size_t number = (order.size() + NumberOfLanes - 1) / NumberOfLanes;
  Grow(abortCheck, result.Batches, number);
  result.Tetrahedra.assign(number * NumberOfLanes, -1);
  std::copy(order.begin(), order.end(), result.Tetrahedra.begin());
  ForItemsInParallel(abortCheck, result.Tetrahedra.size(),
    [&](std::size_t i)
    {
      const bool isThere = result.Tetrahedra[i] >= 0;
      SetLane(result.Batches[i / NumberOfLanes], static_cast<int>(i % NumberOfLanes), body,
        isThere ? result.Tetrahedra[i] : order.back(), isThere);
    });
  SetMaterials(result, body);
  result.Colors = ColorChunks(abortCheck, result, body.Points.size());
  return result;
}

void SetActivePieces(ElementBatches& batches, const ElasticBody& body,
  const std::vector<std::int32_t>& pieceOfTetrahedron, const std::vector<bool>& isActive)
{
  for (std::size_t i = 0; i < batches.Tetrahedra.size(); ++i)
  {
    const std::int32_t tetrahedron = batches.Tetrahedra[i];
    if (tetrahedron >= 0)
    {
      const auto piece = pieceOfTetrahedron[static_cast<std::size_t>(tetrahedron)];
      SetLane(batches.Batches[i / NumberOfLanes], static_cast<int>(i % NumberOfLanes), body,
        tetrahedron, isActive[static_cast<std::size_t>(piece)]);
    }
  }
}

void SetMaterials(ElementBatches& batches, const ElasticBody& body)
{
  for (std::size_t i = 0; i < batches.Tetrahedra.size(); ++i)
  {
    const std::int32_t tetrahedron = batches.Tetrahedra[i];
    const ElasticMaterial& material =
      body.GetMaterial(tetrahedron < 0 ? 0 : static_cast<std::size_t>(tetrahedron));
    ElementBatch& batch = batches.Batches[i / NumberOfLanes];
    const auto lane = static_cast<int>(i % NumberOfLanes);
    batch.Mu[lane] = material.GetShearModulus();
    // Lambda / mu for a Poisson ratio of 0.4.
    constexpr double largestOfPoints = 4.0;
    const double lambda = material.GetLambda();
    batch.Lambda[lane] = std::min(lambda, largestOfPoints * material.GetShearModulus());
    batch.MeanLambda[lane] = lambda - batch.Lambda[lane];
  }
}

} // namespace deformvolume
