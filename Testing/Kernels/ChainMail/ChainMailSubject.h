// SPDX-License-Identifier: BSD-3-Clause
// A ChainMailModel for comparisons with the reference; random tissue and random handles.
#ifndef ChainMailSubject_h
#define ChainMailSubject_h

#include "ChainMailModel.h"
#include "ChainMailReference.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace chainMailTesting
{

using namespace deformvolume;

// A model with its output, set up like a reference. Displacements are in voxels, without rounding
// errors.
struct Subject
{
  explicit Subject(const Extent& extent, const std::array<double, 3>& spacing = { { 1, 1, 1 } },
    std::size_t workGroupSize = 0, unsigned int order = 0)
    : Output(static_cast<std::size_t>(3 * GetNumberOfPoints(extent)))
    , Spacing(spacing)
  {
    this->Model.SetWorkGroupSize(workGroupSize);
    this->Model.SetBlockOrder(order);
    this->Model.SetVoxelGrid(extent, { { spacing[0], 0, 0, 0, spacing[1], 0, 0, 0, spacing[2] } });
    this->Model.SetOutput(this->Output.data());
  }
  void Set(const ChainMailReference& reference)
  {
    this->Model.SetMaterials(reference.Table, reference.Materials.data());
    this->Model.SetActiveTetrahedra(reference.Active.data());
    this->Model.SetPinned(reference.Pinned.data());
  }
  ChainMailReport Step(const std::vector<ChainMailHandle>& handles, int sweeps = 0)
  {
    ChainMailRequest request;
    request.Handles = handles;
    request.RelaxationSweeps = sweeps;
    return this->Model.Step(request);
  }
  double Get(std::size_t voxel, std::size_t component) const
  {
    return static_cast<double>(this->Output[3 * voxel + component]) / this->Spacing[component];
  }
  // Spacings are powers of two, so divisions by them are exact.
  void ExpectEqual(const ChainMailReference& reference) const
  {
    std::size_t different = 0;
    for (std::size_t i = 0; i < reference.GetNumberOfVoxels(); ++i)
    {
      for (std::size_t c = 0; c < 3; ++c)
      {
        different +=
          this->Get(i, c) * 65536.0 != static_cast<double>(reference.Displacements[i][c]);
      }
    }
    ASSERT_EQ(different, 0U);
  }

  ChainMailModel Model;
  std::vector<float> Output;
  std::array<double, 3> Spacing;
};

inline ChainMailHandle MakeHandle(
  const std::array<double, 3>& at, const std::array<double, 3>& displacement, double radius = 0.0)
{
  ChainMailHandle handle;
  handle.RestPosition = at;
  handle.Displacement = displacement;
  handle.Radius = radius;
  return handle;
}

inline const std::vector<ChainMailMaterial> Tissues{ { 0.1, 2.0, 1.0 }, { 0.5, 1.5, 0.5 },
  { 0.8, 1.2, 0.2 }, { 0.95, 1.05, 0.05 }, { 0.99, 1.01, 0.01 }, { 1.0, 1.0, 0.0 } };

inline void ExpectSame(const std::vector<ChainMailHandleReport>& found,
  const std::vector<ChainMailHandleReport>& expected)
{
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t h = 0; h < found.size(); ++h)
  {
    EXPECT_EQ(found[h].NumberOfVoxels, expected[h].NumberOfVoxels) << "handle " << h;
    EXPECT_EQ(found[h].IsHeld, expected[h].IsHeld) << "handle " << h;
    EXPECT_EQ(found[h].Reduction, expected[h].Reduction) << "handle " << h;
  }
}

inline void MakeRandom(ChainMailReference& reference, std::mt19937& random, bool withRigid = true)
{
  reference.Table.assign(Tissues.begin(), Tissues.end() - (withRigid ? 0 : 1));
  // Runs of voxels of one material, as in segmentations, with single voxels of other materials.
  unsigned char material = 1;
  for (unsigned char& m : reference.Materials)
  {
    material =
      random() % 5 ? material : static_cast<unsigned char>(random() % reference.Table.size());
    m = material;
  }
}

inline ChainMailHandle MakeRandomHandle(const Extent& extent, std::mt19937& random, double reach)
{
  ChainMailHandle handle;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const int size = extent[2 * axis + 1] - extent[2 * axis] + 1;
    handle.RestPosition[axis] =
      extent[2 * axis] + static_cast<int>(random() % static_cast<unsigned int>(size));
    handle.Displacement[axis] = (static_cast<double>(random() % 2001) / 1000.0 - 1.0) * reach;
  }
  handle.Radius = random() % 3 ? 0.0 : 1.7;
  return handle;
}

} // namespace chainMailTesting

#endif
