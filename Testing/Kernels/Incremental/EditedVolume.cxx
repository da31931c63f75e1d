// SPDX-License-Identifier: BSD-3-Clause
#include "EditedVolume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

using namespace deformvolume;

namespace
{

std::array<int, 3> GetOrder(int permutation)
{
  static const std::array<int, 3> orders[6] = { { { 0, 1, 2 } }, { { 0, 2, 1 } }, { { 1, 0, 2 } },
    { { 1, 2, 0 } }, { { 2, 0, 1 } }, { { 2, 1, 0 } } };
  return orders[permutation];
}

} // namespace

EditedVolume::EditedVolume(const Extent& extent, bool hasCorner)
{
  this->Shape.VertexExtent = extent;
  for (int axis = 0; axis < 3; ++axis)
  {
    this->Nodes[axis] =
      static_cast<int>(GetSize(this->Shape.VertexExtent, axis) + Step - 2) / Step + 1;
  }
  const auto voxels = static_cast<std::size_t>(GetNumberOfPoints(this->Shape.VertexExtent));
  this->Arrays = UsualArrays(voxels);
  this->Displacements.assign(
    3 * static_cast<std::size_t>(this->Nodes[0]) * this->Nodes[1] * this->Nodes[2], 0.0F);
  this->Output = this->Shape.VertexExtent;
  this->MakeTetrahedra();
  this->MakeLinks(hasCorner);
}

std::size_t EditedVolume::GetNumberOfNodes() const
{
  return this->Displacements.size() / 3;
}

std::int32_t EditedVolume::GetNode(const std::array<int, 3>& place) const
{
  return (place[2] * this->Nodes[1] + place[1]) * this->Nodes[0] + place[0];
}

void EditedVolume::MakeTetrahedra()
{
  for (int z = 0; z + 1 < this->Nodes[2]; ++z)
  {
    for (int y = 0; y + 1 < this->Nodes[1]; ++y)
    {
      for (int x = 0; x + 1 < this->Nodes[0]; ++x)
      {
        for (int permutation = 0; permutation < 6; ++permutation)
        {
          std::array<int, 3> place{ { x, y, z } };
          Tetrahedron tetrahedron{ { this->GetNode(place) } };
          for (int k = 0; k < 3; ++k)
          {
            ++place[GetOrder(permutation)[k]];
            tetrahedron[k + 1] = this->GetNode(place);
          }
          this->Tetrahedra.push_back(tetrahedron);
        }
      }
    }
  }
}

void EditedVolume::MakeLinks(bool hasCorner)
{
  const Extent& extent = this->Shape.VertexExtent;
  std::vector<std::int32_t> records(this->Tetrahedra.size(), -1);
  for (int z = 0; z < GetSize(extent, 2); ++z)
  {
    for (int y = 0; y < GetSize(extent, 1); ++y)
    {
      this->Runs.RowBegins.push_back(static_cast<std::uint32_t>(this->Runs.Runs.size()));
      std::int32_t last = -2;
      for (int x = 0; x < GetSize(extent, 0); ++x)
      {
        this->AddVoxel({ { x, y, z } }, !hasCorner || x + y + z >= 12, records, last);
      }
    }
  }
  this->Runs.RowBegins.push_back(static_cast<std::uint32_t>(this->Runs.Runs.size()));
}

void EditedVolume::AddVoxel(const std::array<int, 3>& voxel, bool linked,
  std::vector<std::int32_t>& records, std::int32_t& last)
{
  double place[3];
  int cell[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    cell[axis] = std::min(voxel[axis] / Step, this->Nodes[axis] - 2);
    place[axis] = double(voxel[axis]) / Step - cell[axis];
  }
  int permutation = 0;
  std::array<int, 3> order = GetOrder(0);
  while (!(place[order[0]] >= place[order[1]] && place[order[1]] >= place[order[2]]))
  {
    order = GetOrder(++permutation);
  }
  VertexLink link;
  if (linked)
  {
    link.Tetrahedron =
      6 * ((cell[2] * (this->Nodes[1] - 1) + cell[1]) * (this->Nodes[0] - 1) + cell[0]) +
      permutation;
    link.Weights[0] = static_cast<float>(1.0 - place[order[0]]);
    link.Weights[1] = static_cast<float>(place[order[0]] - place[order[1]]);
    link.Weights[2] = static_cast<float>(place[order[1]] - place[order[2]]);
  }
  this->Links.push_back(link);
  if (link.Tetrahedron == last)
  {
    return;
  }
  last = link.Tetrahedron;
  VertexRun run;
  run.Begin = voxel[0];
  if (link.Tetrahedron >= 0)
  {
    if (records[link.Tetrahedron] < 0)
    {
      records[link.Tetrahedron] = static_cast<std::int32_t>(this->Runs.Tetrahedra.size());
      RestTetrahedron rest;
      rest.Tetrahedron = link.Tetrahedron;
      for (int k = 0; k < 3; ++k)
      {
        rest.Origin[k] = voxel[k];
        rest.Weights[k] = link.Weights[k];
      }
      rest.Gradients[0][order[0]] = -1.0 / Step;
      rest.Gradients[1][order[0]] = 1.0 / Step;
      rest.Gradients[1][order[1]] = -1.0 / Step;
      rest.Gradients[2][order[1]] = 1.0 / Step;
      rest.Gradients[2][order[2]] = -1.0 / Step;
      this->Runs.Tetrahedra.push_back(rest);
    }
    run.Tetrahedron = records[link.Tetrahedron];
  }
  this->Runs.Runs.push_back(run);
}

std::vector<VolumeArray> EditedVolume::GetArrays() const
{
  std::vector<VolumeArray> arrays = this->Arrays.Get();
  for (VolumeArray& array : arrays)
  {
    array.Background = this->Background;
  }
  return arrays;
}

void EditedVolume::SendDisplacements(
  VolumeDeformer& deformer, Route route, const PointRanges* changes) const
{
  if (route != Route::Field)
  {
    deformer.SetNodeDisplacements(this->Displacements.data(), changes);
    return;
  }
  deformer.SetDisplacementField(this->GetField(), changes);
}

DisplacementField EditedVolume::GetField() const
{
  DisplacementField field;
  field.Dimensions = this->Nodes;
  field.Vectors = this->Displacements.data();
  for (int axis = 0; axis < 3; ++axis)
  {
    field.IndexToField[5 * axis] = 1.0 / Step;
    field.IndexToField[4 * axis + 3] = -double(this->Shape.VertexExtent[2 * axis]) / Step;
  }
  return field;
}

PointRanges EditedVolume::FindChanges(const std::vector<float>& last, std::mt19937& random) const
{
  PointRanges changes;
  for (std::size_t point = 0; point < this->GetNumberOfNodes(); ++point)
  {
    if (std::equal(last.begin() + 3 * point, last.begin() + 3 * point + 3,
          this->Displacements.begin() + 3 * point) &&
      random() % 50)
    {
      continue;
    }
    if (changes.empty() || changes.back()[1] != point)
    {
      changes.push_back({ { point, point } });
    }
    changes.back()[1] = point + 1;
  }
  return changes;
}

void EditedVolume::SendMasks(VolumeDeformer& deformer) const
{
  deformer.SetBlanked(this->Blanked.empty() ? nullptr : this->Blanked.data());
  deformer.SetActiveTetrahedra(this->Active.empty() ? nullptr : this->Active.data());
  deformer.SetBoundaryDistances(this->Distances.empty() ? nullptr : this->Distances.data());
  deformer.SetCut(this->Crossed.empty() ? nullptr : this->Crossed.data(),
    this->Crossed.empty() ? nullptr : this->CutDistances.data());
}

void EditedVolume::SendAll(VolumeDeformer& deformer, Route route) const
{
  deformer.SetDevice("");
  deformer.SetVoxelGrid(this->Shape);
  deformer.SetArrays(this->GetArrays());
  this->SendMasks(deformer);
  if (route == Route::Mesh)
  {
    deformer.SetMesh(this->Tetrahedra.data(), this->Tetrahedra.size(), this->GetNumberOfNodes(),
      this->Links.data());
  }
  else if (route == Route::Runs)
  {
    deformer.SetMesh(
      this->Tetrahedra.data(), this->Tetrahedra.size(), this->GetNumberOfNodes(), this->Runs);
  }
  this->SendDisplacements(deformer, route);
}

void EditedVolume::Move(std::mt19937& random, int radius, float amount)
{
  std::array<int, 3> center;
  for (int axis = 0; axis < 3; ++axis)
  {
    center[axis] = static_cast<int>(random() % this->Nodes[axis]);
  }
  this->MoveRound(center, random, radius, amount);
}

void EditedVolume::MoveInside(std::mt19937& random, float amount)
{
  std::array<int, 3> center;
  for (int axis = 0; axis < 3; ++axis)
  {
    const int border = this->Nodes[axis] / 2 - 1;
    center[axis] = border + static_cast<int>(random() % (this->Nodes[axis] - 2 * border));
  }
  this->MoveRound(center, random, 0, amount);
}

std::vector<TetrahedronChange> EditedVolume::Split(std::mt19937& random, int reach)
{
  const int first = static_cast<int>(random() % this->Tetrahedra.size());
  const int end = std::min(
    first + 1 + static_cast<int>(random()) % reach, static_cast<int>(this->Tetrahedra.size()));
  std::uniform_real_distribution<float> move(-0.2F, 0.2F); // small: few tetrahedra are inverted
  std::map<std::int32_t, std::int32_t> twins;
  std::vector<TetrahedronChange> changes;
  for (int t = first; t < end; ++t)
  {
    TetrahedronChange change;
    change.Number = t;
    change.Before = change.After = this->Tetrahedra[t];
    for (std::int32_t& node : change.After)
    {
      if (random() % 2)
      {
        const auto inserted =
          twins.emplace(node, static_cast<std::int32_t>(this->GetNumberOfNodes()));
        if (inserted.second)
        {
          for (int c = 0; c < 3; ++c)
          {
            this->Displacements.push_back(this->Displacements[3 * node + c] + move(random));
          }
        }
        node = inserted.first->second;
      }
    }
    this->Tetrahedra[t] = change.After;
    if (change.After != change.Before)
    {
      changes.push_back(change);
    }
  }
  return changes;
}

void EditedVolume::CutAlong(double place, double slope, int end)
{
  const Extent& extent = this->Shape.VertexExtent;
  std::array<int, 3> size;
  for (int axis = 0; axis < 3; ++axis)
  {
    size[axis] = static_cast<int>(GetSize(extent, axis));
  }
  const auto distance = [=](int x, int y, int z) { return x - place + slope * y - 0.125 * z; };
  this->CutDistances.clear();
  for (int z = 0; z < size[2]; ++z)
  {
    for (int y = 0; y < size[1]; ++y)
    {
      for (int x = 0; x < size[0]; ++x)
      {
        this->CutDistances.push_back(static_cast<float>(distance(x, y, z)));
      }
    }
  }
  this->Crossed.clear();
  for (int z = 0; z + 1 < size[2]; ++z)
  {
    for (int y = 0; y + 1 < size[1]; ++y)
    {
      for (int x = 0; x + 1 < size[0]; ++x)
      {
        // Tetrahedra with all vertices on one side are not divided. Some of these cells may have
        // such tetrahedra.
        const bool isNear = std::abs(distance(x, y, z)) < 2.0;
        this->Crossed.push_back(isNear && y < end ? 31 : 0);
      }
    }
  }
}

void EditedVolume::EditCut(const std::vector<unsigned char>& crossed, std::mt19937& random)
{
  if (this->Crossed.empty())
  {
    return;
  }
  const Extent& extent = this->Shape.VertexExtent;
  const auto sizeX = static_cast<std::size_t>(GetSize(extent, 0));
  const auto sizeY = static_cast<std::size_t>(GetSize(extent, 1));
  const std::size_t firstY = random() % 40;
  const std::size_t firstZ = random() % 30;
  const bool joins = random() % 4 == 0;
  for (std::size_t z = firstZ; z < firstZ + 4; ++z)
  {
    for (std::size_t y = firstY; y < firstY + 4; ++y)
    {
      for (std::size_t x = 0; x + 1 < sizeX; ++x)
      {
        this->CutDistances[(z * sizeY + y) * sizeX + x] += 0.3F;
        const std::size_t cell = (z * (sizeY - 1) + y) * (sizeX - 1) + x;
        this->Crossed[cell] = joins ? 0 : crossed[cell];
      }
    }
  }
}

void EditedVolume::MoveRound(
  const std::array<int, 3>& center, std::mt19937& random, int radius, float amount)
{
  std::uniform_real_distribution<float> move(-amount, amount);
  for (int z = 0; z < this->Nodes[2]; ++z)
  {
    for (int y = 0; y < this->Nodes[1]; ++y)
    {
      for (int x = 0; x < this->Nodes[0]; ++x)
      {
        if (std::abs(x - center[0]) <= radius && std::abs(y - center[1]) <= radius &&
          std::abs(z - center[2]) <= radius)
        {
          for (int c = 0; c < 3; ++c)
          {
            this->Displacements[3 * this->GetNode({ { x, y, z } }) + c] = move(random);
          }
        }
      }
    }
  }
}

EditedOutputs::EditedOutputs(const EditedVolume& volume)
  : Shorts(GetNumberOfPoints(volume.Output), 999)
  , Floats(GetNumberOfPoints(volume.Output), 999.0F)
  , Labels(2 * GetNumberOfPoints(volume.Output), 999)
  , Coverage(GetNumberOfPoints(volume.Output), 9)
{
}

DeformRequest EditedOutputs::MakeRequest(const EditedVolume& volume)
{
  DeformRequest request;
  request.Method = volume.Method;
  request.Interpolation = volume.Interpolation;
  request.OutputExtent = volume.Output;
  request.Outputs = { this->Shorts.data(), this->Floats.data(), this->Labels.data() };
  request.Coverage = this->Coverage.data();
  return request;
}

void EditedOutputs::SetLast(DeformRequest& request) const
{
  request.LastOutputs = { this->Shorts.data(), this->Floats.data(), this->Labels.data() };
  request.LastCoverage = this->Coverage.data();
}

bool EditedOutputs::operator==(const EditedOutputs& other) const
{
  return this->Shorts == other.Shorts && this->Labels == other.Labels &&
    this->Coverage == other.Coverage &&
    std::memcmp(this->Floats.data(), other.Floats.data(), this->Floats.size() * sizeof(float)) == 0;
}

void ExpectSame(const DeformReport& report, const DeformReport& wanted)
{
  EXPECT_EQ(report.NumberOfCoveredVoxels, wanted.NumberOfCoveredVoxels);
  EXPECT_EQ(report.NumberOfInvertedTetrahedra, wanted.NumberOfInvertedTetrahedra);
  EXPECT_EQ(report.NumberOfOverstretchedCells, wanted.NumberOfOverstretchedCells);
  EXPECT_EQ(report.Overlapping, wanted.Overlapping);
}

void Twins::SendAll(const EditedVolume& volume, Route route)
{
  volume.SendAll(this->Whole, route);
  volume.SendAll(this->Updated, route);
}

void Twins::Deform(const EditedVolume& volume, Route route)
{
  volume.SendDisplacements(this->Whole, route);
  volume.SendDisplacements(this->Updated, route);
  EditedOutputs expected(volume);
  this->WholeReport = this->Whole.Deform(expected.MakeRequest(volume));
  const bool isFirst = !this->Last;
  if (isFirst)
  {
    this->Last = std::make_unique<EditedOutputs>(volume);
  }
  DeformRequest request = this->Last->MakeRequest(volume);
  request.Incremental = true;
  if (!isFirst)
  {
    this->Last->SetLast(request);
  }
  this->UpdatedReport = this->Updated.Deform(request);
  ASSERT_TRUE(*this->Last == expected);
  ExpectSame(this->UpdatedReport, this->WholeReport);
}

bool Twins::IsPart() const
{
  return this->UpdatedReport.NumberOfResampledBricks < this->UpdatedReport.NumberOfBricks;
}
