// SPDX-License-Identifier: BSD-3-Clause
// Ten-node tetrahedra: rotations, forces and stiffness.
#include "BlockMatrix.h"
#include "FiniteElementCase.h"
#include "FiniteElements.h"
#include "SingularValues.h"

#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

using namespace deformvolume;

namespace
{

glm::dmat3 GetMatrix(const LaneMatrix& matrix, int lane)
{
  glm::dmat3 result;
  for (int j = 0; j < 3; ++j)
  {
    result[j] =
      glm::dvec3(matrix.Columns[j].X[lane], matrix.Columns[j].Y[lane], matrix.Columns[j].Z[lane]);
  }
  return result;
}

LaneMatrix MakeLaneMatrix(const glm::dmat3& matrix)
{
  LaneMatrix result;
  for (int j = 0; j < 3; ++j)
  {
    result.Columns[j] = { MakeLanes(matrix[j].x), MakeLanes(matrix[j].y), MakeLanes(matrix[j].z) };
  }
  return result;
}

double LargestOfMatrix(const glm::dmat3& matrix)
{
  return std::max({ LargestOf(matrix[0]), LargestOf(matrix[1]), LargestOf(matrix[2]) });
}

struct Decomposition
{
  glm::dmat3 U;
  glm::dmat3 V;
  glm::dvec3 Values;
};

Decomposition Decompose(const glm::dmat3& matrix)
{
  const LaneMatrix lanes = MakeLaneMatrix(matrix);
  const SingularValues values = FindSingularValues(lanes);
  return { GetMatrix(values.U, 1), GetMatrix(values.V, 1),
    { values.Values[0][1], values.Values[1][1], values.Values[2][1] } };
}

void CheckDecomposition(const glm::dmat3& matrix)
{
  const Decomposition d = Decompose(matrix);
  glm::dmat3 scaled = d.U;
  for (int i = 0; i < 3; ++i)
  {
    scaled[i] *= d.Values[i];
  }
  const double size = std::max(1e-300, LargestOfMatrix(matrix));
  // The error of some tens of rounded operations.
  constexpr double rounding = 1e-14;
  EXPECT_LT(LargestOfMatrix(scaled * glm::transpose(d.V) - matrix), rounding * size);
  EXPECT_LT(LargestOfMatrix(glm::transpose(d.U) * d.U - glm::dmat3(1.0)), rounding);
  EXPECT_LT(LargestOfMatrix(glm::transpose(d.V) * d.V - glm::dmat3(1.0)), rounding);
  EXPECT_NEAR(glm::determinant(d.U), 1.0, rounding);
  EXPECT_NEAR(glm::determinant(d.V), 1.0, rounding);
  EXPECT_GE(d.Values[0], d.Values[1]);
  EXPECT_GE(d.Values[1], std::abs(d.Values[2]) - rounding * size);
}

// A stretched and rotated body. None of its eigenvalues is clamped.
struct Stretched
{
  Stretched()
    : Lattice({ 3, 2, 2 }, 0.1, MakeMaterial(1e4, 0.45))
  {
    this->Displacements = MapPoints(this->Lattice.Body,
      MakeRotation(1.2, { 0.3, 1.0, -0.4 }) * glm::dmat3(1.3, 0, 0, 0, 1.25, 0, 0, 0, 1.2),
      glm::dvec3(0.1, 0.2, 0.3));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> jitter(-0.003, 0.003);
    for (glm::dvec3& displacement : this->Displacements)
    {
      displacement += glm::dvec3(jitter(random), jitter(random), jitter(random));
    }
  }

  // Renumbers the nodes, so that mid-side nodes come before the ends of their edges.
  void NumberAnew()
  {
    ElasticBody& body = this->Lattice.Body;
    const std::size_t nodes = body.Points.size();
    std::vector<std::int32_t> numbers(nodes);
    std::iota(numbers.begin(), numbers.end(), 0);
    std::shuffle(numbers.begin(), numbers.end(), std::mt19937(2));
    const auto move = [&](std::vector<glm::dvec3>& vectors)
    {
      const std::vector<glm::dvec3> before = vectors;
      for (std::size_t node = 0; node < nodes; ++node)
      {
        vectors[static_cast<std::size_t>(numbers[node])] = before[node];
      }
    };
    move(body.Points);
    move(this->Displacements);
    for (std::size_t t = 0; t < body.Tetrahedra.size(); ++t)
    {
      for (std::int32_t& node : body.Tetrahedra[t])
      {
        node = numbers[static_cast<std::size_t>(node)];
      }
      for (std::int32_t& node : body.MidSides[t])
      {
        node = numbers[static_cast<std::size_t>(node)];
      }
    }
  }

  QuadraticLattice Lattice;
  std::vector<glm::dvec3> Displacements;
};

class ElementModels : public testing::TestWithParam<MaterialModel>
{
};

} // namespace

INSTANTIATE_TEST_SUITE_P(Materials, ElementModels,
  testing::Values(MaterialModel::StableNeoHookean, MaterialModel::Corotational));

TEST(ElementMechanics, SingularValues)
{
  CheckDecomposition(glm::dmat3(1.0));
  CheckDecomposition(glm::dmat3(0.0));
  CheckDecomposition(glm::dmat3(2.0, 0, 0, 0, 0, 0, 0, 0, 0));
  CheckDecomposition(glm::dmat3(0, 0, 0, 0, 0, 0, 0, 0, -3.0));
  CheckDecomposition(glm::outerProduct(glm::dvec3(1, 2, 3), glm::dvec3(-2, 1, 0.5)));
  CheckDecomposition(glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, 1e-9));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i)
  {
    glm::dmat3 matrix;
    for (int j = 0; j < 3; ++j)
    {
      matrix[j] = glm::dvec3(normal(random), normal(random), normal(random));
    }
    CheckDecomposition(matrix);
    // A matrix that is nearly a rotation, and a nearly singular one.
    CheckDecomposition(MakeRotation(normal(random), matrix[0]) + 1e-8 * matrix);
    matrix[2] = matrix[0] + 1e-7 * matrix[1];
    CheckDecomposition(matrix);
  }
}

TEST(ElementMechanics, RotationOfInverted)
{
  const Decomposition d = Decompose(glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, -0.5));
  EXPECT_LT(LargestOfMatrix(d.U * glm::transpose(d.V) - glm::dmat3(1.0)), 1e-15);
  EXPECT_EQ(d.Values[2], -0.5);
}

TEST_P(ElementModels, ForcesAreThoseOfTheEnergy)
{
  Stretched stretched;
  FiniteElementModel model;
  model.SetMaterialModel(GetParam());
  model.SetBody(stretched.Lattice.Body);
  model.SetDisplacements(stretched.Displacements);
  const std::vector<glm::dvec3> forces = model.GetForces();
  const std::vector<double> volumes = GetVolumes(stretched.Lattice.Body);
  const auto getEnergy = [&](const std::vector<glm::dvec3>& displacements)
  {
    model.SetDisplacements(displacements);
    const std::vector<ElementResults> results = model.GetElementResults();
    double energy = 0.0;
    for (std::size_t t = 0; t < results.size(); ++t)
    {
      energy += volumes[t] * results[t].StrainEnergyDensity;
    }
    return energy;
  };
  constexpr double step = 1e-6;
  for (std::size_t node = 0; node < forces.size(); ++node)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      std::vector<glm::dvec3> moved = stretched.Displacements;
      moved[node][axis] += step;
      const double more = getEnergy(moved);
      moved[node][axis] -= 2.0 * step;
      const double difference = (more - getEnergy(moved)) / (2.0 * step);
      // The energy of 2 J has a rounding error of 1e-15 of its value, and the positions differ by
      // 1e-6 m.
      EXPECT_NEAR(difference, forces[node][axis], 1e-7 * LargestOf(forces));
    }
  }
}

TEST_P(ElementModels, TangentIsThatOfTheForces)
{
  Stretched stretched;
  stretched.NumberAnew();
  const ElasticBody& body = stretched.Lattice.Body;
  AbortCheck abortCheck(nullptr);
  FiniteElements elements(abortCheck, body);
  elements.SetMaterialModel(GetParam());
  BlockMatrix matrix;
  matrix.SetPattern(abortCheck, MakeNodePattern(abortCheck, body));
  elements.SetPattern(abortCheck, matrix.GetPattern());
  elements.AssembleTangent(abortCheck, stretched.Displacements, false, matrix);
  const std::size_t nodes = body.Points.size();
  const std::vector<unsigned char> isFree(nodes, 1);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr double step = 1e-6;
  for (int turn = 0; turn < 5; ++turn)
  {
    std::vector<glm::dvec3> direction(nodes);
    std::vector<glm::dvec3> product(nodes);
    std::vector<glm::dvec3> more = stretched.Displacements;
    std::vector<glm::dvec3> less = stretched.Displacements;
    for (std::size_t node = 0; node < nodes; ++node)
    {
      direction[node] = glm::dvec3(uniform(random), uniform(random), uniform(random));
      more[node] += step * direction[node];
      less[node] -= step * direction[node];
    }
    matrix.Multiply(0, nodes, isFree.data(), direction.data(), product.data());
    std::vector<glm::dvec3> forcesMore;
    std::vector<glm::dvec3> forcesLess;
    elements.FindForces(abortCheck, more, forcesMore);
    elements.FindForces(abortCheck, less, forcesLess);
    for (std::size_t node = 0; node < nodes; ++node)
    {
      const glm::dvec3 difference = (forcesMore[node] - forcesLess[node]) / (2.0 * step);
      // The error of a central difference is the square of the step, which is 1e-5 of an edge.
      EXPECT_LT(LargestOf(difference - product[node]), 1e-8 * LargestOf(product));
    }
  }
}

TEST_P(ElementModels, TangentIsNeverNegative)
{
  QuadraticLattice lattice({ 2, 2, 3 }, 0.1, MakeMaterial(1e4, 0.45));
  AbortCheck abortCheck(nullptr);
  FiniteElements elements(abortCheck, lattice.Body);
  elements.SetMaterialModel(GetParam());
  BlockMatrix matrix;
  matrix.SetPattern(abortCheck, MakeNodePattern(abortCheck, lattice.Body));
  elements.SetPattern(abortCheck, matrix.GetPattern());
  const std::size_t nodes = lattice.Body.Points.size();
  const std::vector<unsigned char> isFree(nodes, 1);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int turn = 0; turn < 50; ++turn)
  {
    std::vector<glm::dvec3> displacements(nodes);
    std::vector<glm::dvec3> direction(nodes);
    std::vector<glm::dvec3> product(nodes);
    for (std::size_t node = 0; node < nodes; ++node)
    {
      displacements[node] = 0.1 * glm::dvec3(normal(random), normal(random), normal(random));
      direction[node] = glm::dvec3(normal(random), normal(random), normal(random));
    }
    elements.AssembleTangent(abortCheck, displacements, true, matrix);
    // Power iterations with the identity minus a multiple of the matrix converge to the direction
    // of the least eigenvalue.
    for (int i = 0; i < 20; ++i)
    {
      matrix.Multiply(0, nodes, isFree.data(), direction.data(), product.data());
      double curvature = 0.0;
      double length = 0.0;
      for (std::size_t node = 0; node < nodes; ++node)
      {
        curvature += glm::dot(direction[node], product[node]);
        length += glm::dot(direction[node], direction[node]);
      }
      EXPECT_GT(curvature, -1e-10 * length);
      for (std::size_t node = 0; node < nodes; ++node)
      {
        direction[node] -= product[node] / 3e4;
      }
    }
  }
}

// The stress of a tetrahedron is the sum of the products of the forces on its nodes and their
// positions, divided by its volume.
TEST_P(ElementModels, StressIsThatOfTheForces)
{
  ElasticBody body;
  body.Points = { { 0, 0, 0 }, { 0.1, 0, 0 }, { 0.02, 0.1, 0 }, { 0.03, 0.01, 0.1 } };
  body.Tetrahedra = { { 0, 1, 2, 3 } };
  body.Materials = { MakeMaterial(1e4, 0.45) };
  AddMidSideNodes(body);
  const double volume = GetVolumes(body).front();
  FiniteElementModel model;
  model.SetMaterialModel(GetParam());
  model.SetBody(body);
  const glm::dmat3 rotation = MakeRotation(0.7, { 1.0, 2.0, -0.5 });
  // Stretched, unchanged, compressed and inverted.
  for (const double height : { 1.4, 1.0, 0.3, 1e-3, -1e-3, -0.8 })
  {
    const std::vector<glm::dvec3> displacements = MapPoints(
      body, rotation * glm::dmat3(1.1, 0, 0, 0.2, 0.9, 0, 0, 0.1, height), glm::dvec3(0.5));
    model.SetDisplacements(displacements);
    const std::vector<glm::dvec3> forces = model.GetForces();
    glm::dmat3 wanted(0.0);
    for (std::size_t node = 0; node < forces.size(); ++node)
    {
      wanted += glm::outerProduct(forces[node], body.Points[node] + displacements[node]);
    }
    const ElementResults results = model.GetElementResults().front();
    EXPECT_NEAR(results.Determinant, 1.1 * 0.9 * height, 1e-14);
    wanted /= volume * results.Determinant;
    const std::array<double, 6>& s = results.Stress;
    const glm::dmat3 stress(s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2]);
    EXPECT_LT(LargestOfMatrix(stress - wanted), 1e-9 * LargestOfMatrix(wanted))
      << "height " << height;
  }
}

TEST_P(ElementModels, FlatTetrahedraHaveNoStress)
{
  const QuadraticLattice lattice({ 2, 2, 2 }, 0.1, MakeMaterial(1e4, 0.45));
  FiniteElementModel model;
  model.SetMaterialModel(GetParam());
  model.SetBody(lattice.Body);
  const glm::dmat3 rotation = MakeRotation(0.7, { 1.0, 2.0, -0.5 });
  // Singular matrices, exact and with rounding errors. They map to a plane, a line and a point.
  for (const glm::dmat3& matrix :
    { glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, 0), rotation * glm::dmat3(1.2, 0, 0, 0, 0.9, 0, 0, 0, 0),
      glm::dmat3(1, 0, 0, 0, 0, 0, 0, 0, 0), glm::dmat3(0.0) })
  {
    model.SetDisplacements(MapPoints(lattice.Body, matrix, glm::dvec3(0.0)));
    for (const ElementResults& results : model.GetElementResults())
    {
      EXPECT_NEAR(results.Determinant, 0.0, 1e-14);
      EXPECT_EQ(results.Stress, (std::array<double, 6>{}));
      EXPECT_GT(results.StrainEnergyDensity, 1e3);
    }
    // A neo-Hookean tetrahedron that is a point is in equilibrium, although not in a stable one.
    const bool isPoint = matrix == glm::dmat3(0.0);
    if (!isPoint || GetParam() == MaterialModel::Corotational)
    {
      EXPECT_GT(LargestOf(model.GetForces()), 1.0);
    }
  }
}
