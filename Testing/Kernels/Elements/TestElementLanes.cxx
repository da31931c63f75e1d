// SPDX-License-Identifier: BSD-3-Clause
// Code for CPUs with AVX2 must give the results of code for the baseline CPU bit for bit.
#include "BlockMatrix.h"
#include "FiniteElementCase.h"
#include "FiniteElements.h"
#include "Lanes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

using namespace deformvolume;

namespace
{

using Place = LatticeBody::Place;

// Switches the code for AVX2 off and on.
class WideLanes : public ::testing::Test
{
protected:
  void SetUp() override
  {
    if (!HasWideLanes())
    {
      GTEST_SKIP() << "The processor has no AVX2, or there is no code for it.";
    }
  }
  void TearDown() override { UseWideLanes(true); }

  template <typename Call>
  static auto CallPlain(Call&& call)
  {
    UseWideLanes(false);
    EXPECT_FALSE(HasWideLanes());
    auto result = call();
    UseWideLanes(true);
    EXPECT_TRUE(HasWideLanes());
    return result;
  }
};

// Compares bits rather than values: +0 and -0 are equal values.
template <typename Value>
bool HasSameBits(const std::vector<Value>& a, const std::vector<Value>& b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0;
}

QuadraticLattice MakeBar(const Place& nodes)
{
  return QuadraticLattice(
    nodes, 0.01, MakeMaterial(1e4, 0.45), [](const Place& place) { return place[2] == 0; });
}

// The noise is so large that some tetrahedra are inverted. All branches of the singular value
// decomposition are taken.
std::vector<glm::dvec3> MakeNoise(std::size_t nodes, double size)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<glm::dvec3> result(nodes);
  for (glm::dvec3& vector : result)
  {
    vector = glm::dvec3(uniform(random), uniform(random), uniform(random));
  }
  return result;
}

// Sums over elements and matrices.
struct Sums
{
  std::vector<glm::dvec3> Forces;
  std::vector<double> Energy;
  std::vector<glm::dvec3> Product;
};

Sums FindSums(
  const LatticeBody& lattice, const std::vector<glm::dvec3>& displacements, MaterialModel model)
{
  AbortCheck abortCheck(nullptr);
  FiniteElements elements(abortCheck, lattice.Body);
  elements.SetMaterialModel(model);
  BlockMatrix matrix;
  matrix.SetPattern(abortCheck, MakeNodePattern(abortCheck, lattice.Body));
  elements.SetPattern(abortCheck, matrix.GetPattern());
  Sums sums;
  sums.Energy.push_back(elements.FindForces(abortCheck, displacements, sums.Forces).Energy);
  elements.AssembleTangent(abortCheck, displacements, true, matrix);
  const std::size_t nodes = displacements.size();
  const std::vector<unsigned char> isFree(nodes, 1);
  sums.Product.resize(nodes);
  matrix.Multiply(0, nodes, isFree.data(), displacements.data(), sums.Product.data());
  return sums;
}

std::vector<glm::dvec3> SolveFrames(const LatticeBody& lattice, EquilibriumMode mode)
{
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  EquilibriumRequest request;
  request.Mode = mode;
  for (int frame = 1; frame <= 3; ++frame)
  {
    request.Held.clear();
    lattice.ForNodes(
      [&](const Place& place, std::int32_t node)
      {
        if (place[2] == lattice.Nodes[2] - 1)
        {
          request.Held.push_back({ node, glm::dvec3(0.004 * frame, 0.002, -0.001 * frame) });
        }
      });
    request.Loads.Gravity = glm::dvec3(0.0, -frame, 0.0);
    model.Solve(request);
  }
  return model.GetDisplacements();
}

} // namespace

TEST_F(WideLanes, ForcesAndProductsHaveTheSameBits)
{
  const QuadraticLattice lattice = MakeBar({ 3, 3, 4 });
  for (const double size : { 0.0, 1e-9, 1e-3, 6e-3 })
  {
    const std::vector<glm::dvec3> displacements = MakeNoise(lattice.Body.Points.size(), size);
    for (const MaterialModel model :
      { MaterialModel::StableNeoHookean, MaterialModel::Corotational })
    {
      const Sums wide = FindSums(lattice, displacements, model);
      const Sums plain = CallPlain([&] { return FindSums(lattice, displacements, model); });
      EXPECT_TRUE(HasSameBits(wide.Forces, plain.Forces)) << "noise of size " << size;
      EXPECT_TRUE(HasSameBits(wide.Energy, plain.Energy)) << "noise of size " << size;
      EXPECT_TRUE(HasSameBits(wide.Product, plain.Product)) << "noise of size " << size;
    }
  }
}

// The bodies need block Jacobi, and several multigrid levels in single precision.
TEST_F(WideLanes, SolutionsHaveTheSameBits)
{
  for (const Place& nodes : { Place{ 3, 3, 5 }, Place{ 6, 7, 8 } })
  {
    const QuadraticLattice lattice = MakeBar(nodes);
    for (const EquilibriumMode mode : { EquilibriumMode::Interactive, EquilibriumMode::Converged })
    {
      const std::vector<glm::dvec3> wide = SolveFrames(lattice, mode);
      EXPECT_GT(LargestOf(wide), 1e-3);
      EXPECT_TRUE(HasSameBits(CallPlain([&] { return SolveFrames(lattice, mode); }), wide));
    }
  }
}
