// SPDX-License-Identifier: BSD-3-Clause
// The elastic constants of springs: of lattices of cubes, and of simulated bodies.
#include "LatticeBody.h"
#include "MassSpringModel.h"
#include "Measured.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

using namespace deformvolume;
using namespace physicsTesting;

namespace
{

constexpr double CellSize = 2.5e-3;
constexpr double Strain = 1e-3;

ElasticMaterial MakeMaterial(double poissonRatio)
{
  ElasticMaterial material;
  material.PoissonRatio = poissonRatio;
  return material;
}

struct Constants
{
  double YoungModulus;
  double PoissonRatio;
};

// Pulls a bar along x. Both ends stay plane, and slide in their planes. Conjugate gradients find
// the equilibrium from the forces of the model.
class BarTest
{
public:
  BarTest(MassSpringModel& model, const ElasticBody& body)
    : Model(model)
    , Body(body)
  {
    this->Low = this->High = body.Points.front();
    for (const glm::dvec3& point : body.Points)
    {
      this->Low = glm::min(this->Low, point);
      this->High = glm::max(this->High, point);
    }
  }

  Constants Measure()
  {
    const std::size_t size = this->Body.Points.size() * 3;
    std::vector<double> x(size, 0.0);
    for (std::size_t i = 0; i < size; i += 3)
    {
      x[i] = Strain * (this->Body.Points[i / 3].x - this->Low.x);
    }
    std::vector<double> residual = this->Project(this->Force(x));
    std::vector<double> direction = residual;
    double squared = Dot(residual, residual);
    const double wanted = 1e-12 * Dot(this->Force(x), this->Force(x));
    for (int i = 0; i < 1000 && squared > wanted; ++i)
    {
      // Forces of a body near rest are linear. The sign is that of the stiffness.
      std::vector<double> product = this->Project(this->Force(direction));
      const double length = -squared / Dot(direction, product);
      for (std::size_t j = 0; j < size; ++j)
      {
        x[j] += length * direction[j];
        residual[j] += length * product[j];
      }
      const double before = squared;
      squared = Dot(residual, residual);
      for (std::size_t j = 0; j < size; ++j)
      {
        direction[j] = residual[j] + squared / before * direction[j];
      }
    }
    return this->Evaluate(x);
  }

private:
  static double Dot(const std::vector<double>& a, const std::vector<double>& b)
  {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  }

  bool IsAtEnd(std::size_t node) const
  {
    const double x = this->Body.Points[node].x;
    return x == this->Low.x || x == this->High.x;
  }

  std::vector<double> Project(std::vector<double> force) const
  {
    for (std::size_t i = 0; i < force.size(); i += 3)
    {
      force[i] = this->IsAtEnd(i / 3) ? 0.0 : force[i];
    }
    return force;
  }

  // Returns the forces of displacements, linearized near rest: they are scaled down first.
  std::vector<double> Force(const std::vector<double>& x) const
  {
    double largest = 1e-300;
    for (const double value : x)
    {
      largest = std::max(largest, std::abs(value));
    }
    const double factor = 1e-4 * CellSize / largest;
    std::vector<float> small(x.size());
    std::transform(x.begin(), x.end(), small.begin(),
      [&](double value) { return static_cast<float>(factor * value); });
    this->Model.SetState(small, std::vector<float>(x.size(), 0.0F));
    const std::vector<float> forces = this->Model.GetForces();
    std::vector<double> result(x.size());
    std::transform(forces.begin(), forces.end(), result.begin(),
      [&](float force) { return static_cast<double>(force) / factor; });
    return result;
  }

  Constants Evaluate(const std::vector<double>& x) const
  {
    const glm::dvec3 size = this->High - this->Low;
    const std::vector<double> force = this->Force(x);
    double pulled = 0.0;
    for (std::size_t node = 0; node < this->Body.Points.size(); ++node)
    {
      pulled -= this->Body.Points[node].x == this->High.x ? force[3 * node] : 0.0;
    }
    // A least-squares fit. Without the volume energy, every second node on a free surface stays
    // behind. This is no property of the material, so the surface is excluded.
    const glm::dvec3 middle = 0.5 * (this->Low + this->High);
    const glm::dvec3 half = this->High - middle - glm::dvec3(0.5 * CellSize);
    double narrowing = 0.0;
    double width = 0.0;
    for (std::size_t node = 0; node < this->Body.Points.size(); ++node)
    {
      const glm::dvec3 place = this->Body.Points[node] - middle;
      if (std::abs(place.y) < half.y && std::abs(place.z) < half.z)
      {
        narrowing -= x[3 * node + 1] * place.y + x[3 * node + 2] * place.z;
        width += place.y * place.y + place.z * place.z;
      }
    }
    Constants constants{};
    constants.YoungModulus = pulled / (size.y * size.z * Strain);
    constants.PoissonRatio = narrowing / (width * Strain);
    return constants;
  }

  MassSpringModel& Model;
  const ElasticBody& Body;
  glm::dvec3 Low, High;
};

} // namespace

TEST(MassSpringStatics, LatticesAreIsotropic)
{
  for (const double poissonRatio : { 0.25, 0.4, 0.45 })
  {
    const ElasticMaterial material = MakeMaterial(poissonRatio);
    const ElasticBody body = MakeLatticeBody({ { 9, 9, 9 } }, glm::dvec3(CellSize), material);
    MassSpringModel model;
    model.SetBody(body);
    const Constants constants = BarTest(model, body).Measure();
    EXPECT_NEAR(constants.YoungModulus, material.YoungModulus, 0.02 * material.YoungModulus);
    EXPECT_NEAR(constants.PoissonRatio, poissonRatio, 0.02 * poissonRatio);
    const std::string of = std::to_string(std::lround(100.0 * poissonRatio));
    RecordMeasured("E, " + of, constants.YoungModulus / material.YoungModulus);
    RecordMeasured("nu, " + of, constants.PoissonRatio);
  }
}

TEST(MassSpringStatics, HangingBar)
{
  ElasticMaterial material = MakeMaterial(0.4);
  const std::array<int, 3> nodes{ { 5, 5, 21 } };
  ElasticBody body = MakeLatticeBody(nodes, glm::dvec3(CellSize), material);
  FixNodes(body, [](const glm::dvec3& point) { return point.z == 0.0; });
  MassSpringModel model;
  model.SetBody(body);
  MassSpringRequest request;
  request.Duration = 4.0;
  request.Damping = 20.0;
  request.Loads.Gravity = { 0, 0, 1.0 };
  model.Advance(request);
  const double length = 20.0 * CellSize;
  const double expected =
    material.Density * request.Loads.Gravity.z * length * length / (2.0 * material.YoungModulus);
  const std::vector<float> displacements = model.GetDisplacements();
  const double found = displacements[3 * GetNode(nodes, 2, 2, 20) + 2];
  // The fixed end cannot get thinner, which makes a bar of this length slightly stiffer.
  EXPECT_NEAR(found, expected, 0.04 * expected);
  EXPECT_LT(found, expected);
  // Lateral drift is less than a thousandth of the length.
  EXPECT_LT(std::abs(displacements[3 * GetNode(nodes, 2, 2, 20)]), 1e-3 * length);
}

TEST(MassSpringStatics, StressOfAStrain)
{
  const ElasticMaterial material = MakeMaterial(0.4);
  const ElasticBody body = MakeLatticeBody({ { 5, 5, 5 } }, glm::dvec3(CellSize), material);
  MassSpringModel model;
  model.SetBody(body);
  std::vector<float> displacements;
  for (const glm::dvec3& point : body.Points)
  {
    displacements.push_back(static_cast<float>(Strain * point.x));
    displacements.push_back(static_cast<float>(-0.4 * Strain * point.y));
    displacements.push_back(static_cast<float>(-0.4 * Strain * point.z));
  }
  model.SetState(displacements, std::vector<float>(displacements.size(), 0.0F));
  const std::vector<ElementResults> results = model.GetElementResults();
  const std::vector<double> volumes = GetVolumes(body);
  std::array<double, 6> mean{};
  double energy = 0.0;
  double volume = 0.0;
  for (std::size_t t = 0; t < results.size(); ++t)
  {
    for (std::size_t i = 0; i < 6; ++i)
    {
      mean[i] += volumes[t] * results[t].Stress[i];
    }
    energy += volumes[t] * results[t].StrainEnergyDensity;
    volume += volumes[t];
    EXPECT_NEAR(results[t].Determinant, 1.0 + 0.2 * Strain, 2e-3 * Strain);
  }
  const double stress = material.YoungModulus * Strain;
  EXPECT_NEAR(mean[0] / volume, stress, 0.01 * stress);
  for (std::size_t i = 1; i < 6; ++i)
  {
    EXPECT_NEAR(mean[i] / volume, 0.0, 0.01 * stress);
  }
  EXPECT_NEAR(energy / volume, 0.5 * stress * Strain, 0.01 * 0.5 * stress * Strain);
}

// The stress of a tetrahedron is the sum of the products of the forces on its nodes and their
// positions, divided by its volume. A flat tetrahedron has no stress.
TEST(MassSpringStatics, StressIsThatOfTheForces)
{
  constexpr double edge = 1.0 / 256.0; // multiples are exact in single precision
  ElasticBody body;
  body.Points = { { 0, 0, 0 }, { edge, 0, 0 }, { 0, edge, 0 }, { 0, 0, edge } };
  body.Tetrahedra = { { 0, 1, 2, 3 } };
  body.Materials.front().PoissonRatio = 0.4;
  const double volume = GetVolumes(body).front();
  MassSpringModel model;
  model.SetBody(body);
  // Stretched, compressed, flat and inverted.
  for (const float height : { 1.5F, 0.5F, 0.0F, -0.5F })
  {
    std::vector<float> displacements(12, 0.0F);
    displacements[7] = 0.25F * static_cast<float>(edge);
    displacements[11] = (height - 1.0F) * static_cast<float>(edge);
    model.SetState(displacements, std::vector<float>(12, 0.0F));
    const std::vector<float> forces = model.GetForces();
    const ElementResults results = model.GetElementResults().front();
    EXPECT_NEAR(results.Determinant, 1.25 * static_cast<double>(height), 1e-6);
    EXPECT_GT(results.StrainEnergyDensity, 0.0);
    constexpr std::size_t axes[6][2] = { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 1, 2 },
      { 0, 2 } };
    std::array<double, 6> wanted{};
    double largest = 0.0;
    for (std::size_t i = 0; i < 6 && height != 0.0F; ++i)
    {
      for (std::size_t node = 0; node < 4; ++node)
      {
        const std::size_t place = 3 * node + axes[i][1];
        // The forces are those that the body exerts on its nodes.
        wanted[i] -= static_cast<double>(forces[3 * node + axes[i][0]]) *
          (body.Points[node][static_cast<int>(axes[i][1])] +
            static_cast<double>(displacements[place])) /
          (volume * results.Determinant);
      }
      largest = std::max(largest, std::abs(wanted[i]));
    }
    for (std::size_t i = 0; i < 6; ++i)
    {
      EXPECT_NEAR(results.Stress[i], wanted[i], 1e-5 * largest) << "height " << height;
    }
  }
}
