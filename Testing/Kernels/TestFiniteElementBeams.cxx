// SPDX-License-Identifier: BSD-3-Clause
// Corotational finite elements beside closed forms: rigid motions, affine maps, bars and beams.
#include "FiniteElementCase.h"
#include "Measured.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>
#include <string>

using namespace deformvolume;

namespace
{

using Place = LatticeBody::Place;

bool IsOutside(const LatticeBody& lattice, const Place& place)
{
  bool isOutside = false;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    isOutside = isOutside || place[axis] == 0 || place[axis] == lattice.Nodes[axis] - 1;
  }
  return isOutside;
}

// A beam along z, fixed at its lower end, of so many cells across and ten times as many along it.
// Its thickness is 1.
LatticeBody MakeBeam(std::int32_t cells, double poissonRatio)
{
  LatticeBody beam(
    { cells + 1, cells + 1, 10 * cells + 1 }, 1.0 / cells, MakeMaterial(1e6, poissonRatio));
  beam.Fix([](const Place& place) { return place[2] == 0; });
  return beam;
}

// A force at the end of a beam, by the share that each node has of the area.
std::vector<glm::dvec3> LoadEnd(const LatticeBody& beam, const glm::dvec3& force)
{
  std::vector<glm::dvec3> forces(beam.Body.Points.size(), glm::dvec3(0.0));
  const double cells = (beam.Nodes[0] - 1) * (beam.Nodes[1] - 1);
  beam.ForNodes(
    [&](const Place& place, std::int32_t node)
    {
      if (place[2] == beam.Nodes[2] - 1)
      {
        const bool isEdge[2] = { place[0] % (beam.Nodes[0] - 1) == 0,
          place[1] % (beam.Nodes[1] - 1) == 0 };
        forces[static_cast<std::size_t>(node)] =
          force / cells * (isEdge[0] ? 0.5 : 1.0) * (isEdge[1] ? 0.5 : 1.0);
      }
    });
  return forces;
}

// The same as linear tetrahedra take it: a third of what acts on each triangle at each of its
// nodes.
std::vector<glm::dvec3> PressEnd(const LatticeBody& beam, const glm::dvec3& pressure)
{
  std::vector<glm::dvec3> forces(beam.Body.Points.size(), glm::dvec3(0.0));
  const double end = beam.Spacing * (beam.Nodes[2] - 1);
  const double area = 0.5 * beam.Spacing * beam.Spacing;
  for (const Tetrahedron& tetrahedron : beam.Body.Tetrahedra)
  {
    std::vector<std::size_t> nodes;
    for (const std::int32_t node : tetrahedron)
    {
      if (std::abs(beam.Body.Points[static_cast<std::size_t>(node)].z - end) < 1e-9)
      {
        nodes.push_back(static_cast<std::size_t>(node));
      }
    }
    if (nodes.size() == 3)
    {
      for (const std::size_t node : nodes)
      {
        forces[node] += pressure * area / 3.0;
      }
    }
  }
  return forces;
}

// The mean displacement of the end.
glm::dvec3 GetTip(const LatticeBody& beam, const FiniteElementModel& model)
{
  glm::dvec3 sum(0.0);
  double number = 0.0;
  beam.ForNodes(
    [&](const Place& place, std::int32_t node)
    {
      if (place[2] == beam.Nodes[2] - 1)
      {
        sum += model.GetDisplacements()[static_cast<std::size_t>(node)];
        number += 1.0;
      }
    });
  return sum / number;
}

// The deflection by a small force, as a part of that of a thin beam.
double GetDeflection(std::int32_t cells, double poissonRatio)
{
  const LatticeBody beam = MakeBeam(cells, poissonRatio);
  FiniteElementModel model;
  model.SetBody(beam.Body);
  constexpr double force = 1e-3;
  EquilibriumRequest request = MakeConverged();
  request.Loads.Forces = LoadEnd(beam, glm::dvec3(force, 0.0, 0.0));
  EXPECT_TRUE(model.Solve(request).IsConverged);
  return GetTip(beam, model).x / (force * 1000.0 / (3.0 * 1e6 / 12.0));
}

} // namespace

TEST(FiniteElementBeams, RigidMotion)
{
  // E h^2 = 2800 N.
  const LatticeBody lattice({ 5, 5, 5 }, 0.1, MakeMaterial(2.8e5, 0.3));
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  model.SetDisplacements(
    MapPoints(lattice.Body, MakeRotation(2.0, { 1.0, 2.0, -0.5 }), glm::dvec3(0.7, -0.3, 1.1)));
  const double force = LargestOf(model.GetForces());
  RecordMeasured("force", force);
  // Rounding of E h^2 and of positions of some ten edges.
  EXPECT_LT(force, 5e-11);
}

TEST(FiniteElementBeams, Patch)
{
  LatticeBody lattice({ 5, 5, 5 }, 0.25, MakeMaterial(1e4, 0.3));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.04, 0.04);
  lattice.ForNodes(
    [&](const Place& place, std::int32_t node)
    {
      if (!IsOutside(lattice, place))
      {
        lattice.Body.Points[static_cast<std::size_t>(node)] +=
          glm::dvec3(jitter(random), jitter(random), jitter(random));
      }
    });
  const glm::dmat3 stretch(1.2, 0.05, 0.0, 0.1, 0.9, 0.03, -0.04, 0.02, 1.1);
  const std::vector<glm::dvec3> wanted = MapPoints(
    lattice.Body, MakeRotation(1.0, { 1.0, -1.0, 0.3 }) * stretch, glm::dvec3(0.2, 0.1, -0.3));
  EquilibriumRequest request = MakeConverged();
  lattice.ForNodes(
    [&](const Place& place, std::int32_t node)
    {
      if (IsOutside(lattice, place))
      {
        request.Held.push_back({ node, wanted[static_cast<std::size_t>(node)] });
      }
    });
  FiniteElementModel model;
  model.SetBody(lattice.Body);
  EXPECT_TRUE(model.Solve(request).IsConverged);
  const double error = LargestDifference(model.GetDisplacements(), wanted);
  RecordMeasured("error", error);
  EXPECT_LT(error, 1e-12);
}

// A bar of 1 x 1 x 2 m that is pulled by a fifth of its length: the stress is E / 5 everywhere, and
// it becomes thinner by nu / 5.
TEST(FiniteElementBeams, Uniaxial)
{
  const double poissonRatio = 0.3;
  LatticeBody bar({ 5, 5, 9 }, 0.25, MakeMaterial(1e5, poissonRatio));
  const double thinner = 1.0 - 0.2 * poissonRatio;
  const std::vector<glm::dvec3> wanted =
    MapPoints(bar.Body, glm::dmat3(thinner, 0, 0, 0, thinner, 0, 0, 0, 1.2), glm::dvec3(0.0));
  EquilibriumRequest request = MakeConverged();
  request.Limits.LinearTolerance = 1e-13;
  bar.ForNodes(
    [&](const Place& place, std::int32_t node)
    {
      if (place[2] % 8 == 0)
      {
        request.Held.push_back({ node, wanted[static_cast<std::size_t>(node)] });
      }
    });
  FiniteElementModel model;
  model.SetBody(bar.Body);
  const EquilibriumReport report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  EXPECT_EQ(report.NewtonSteps, 1);
  EXPECT_LT(LargestDifference(model.GetDisplacements(), wanted), 1e-12);
  double force = 0.0;
  const std::vector<glm::dvec3> forces = model.GetForces();
  bar.ForNodes([&](const Place& place, std::int32_t node)
    { force += place[2] == 8 ? forces[static_cast<std::size_t>(node)].z : 0.0; });
  RecordMeasured("force", force);
  EXPECT_NEAR(force, 20000.0, 1e-7);
  for (const ElementResults& result : model.GetElementResults())
  {
    EXPECT_NEAR(result.Stress[2], 2e4 / (thinner * thinner), 1e-6);
    EXPECT_NEAR(result.Stress[0], 0.0, 1e-6);
    EXPECT_NEAR(result.Stress[4], 0.0, 1e-6);
    EXPECT_NEAR(result.StrainEnergyDensity, 0.5 * 2e4 * 0.2, 1e-7);
    EXPECT_NEAR(result.Determinant, 1.2 * thinner * thinner, 1e-12);
  }
}

// A pressure on the end of a bar, for each area at rest: linear elasticity as long as nothing
// turns, so that strains are p / E and -nu p / E exactly, however large they are.
TEST(FiniteElementBeams, Pressure)
{
  double largest = 0.0;
  for (const double youngModulus : { 1.0, 2.0 })
  {
    for (const double poissonRatio : { 0.0, 0.3, 0.49 })
    {
      for (const double pressure : { 0.2, -0.2, 0.6, -0.6 })
      {
        LatticeBody bar({ 5, 5, 9 }, 0.25, MakeMaterial(youngModulus, poissonRatio));
        const double axial = 1.0 + pressure / youngModulus;
        const double radial = 1.0 - poissonRatio * pressure / youngModulus;
        const std::vector<glm::dvec3> wanted =
          MapPoints(bar.Body, glm::dmat3(radial, 0, 0, 0, radial, 0, 0, 0, axial), glm::dvec3(0.0));
        EquilibriumRequest request = MakeConverged();
        bar.ForNodes(
          [&](const Place& place, std::int32_t node)
          {
            if (place[2] == 0)
            {
              request.Held.push_back({ node, wanted[static_cast<std::size_t>(node)] });
            }
          });
        request.Loads.Forces = PressEnd(bar, glm::dvec3(0.0, 0.0, pressure));
        FiniteElementModel model;
        model.SetBody(bar.Body);
        EXPECT_TRUE(model.Solve(request).IsConverged);
        const double error = LargestDifference(model.GetDisplacements(), wanted);
        largest = std::max(largest, error);
        EXPECT_LT(error, 1e-4) << "E" << youngModulus << " nu " << poissonRatio << " p "
                               << pressure;
      }
    }
  }
  RecordMeasured("error", largest);
}

// Under its own weight a bar becomes longer by rho g L^2 / 2E. Where it becomes thinner, too, its
// end that is held cannot, which matters the less the longer it is.
TEST(FiniteElementBeams, HangingBar)
{
  for (const double poissonRatio : { 0.0, 0.3 })
  {
    LatticeBody bar({ 3, 3, 81 }, 0.125, MakeMaterial(1e6, poissonRatio));
    bar.Fix([](const Place& place) { return place[2] == 0; });
    EquilibriumRequest request = MakeConverged();
    request.Loads.Gravity = glm::dvec3(0.0, 0.0, 9.81);
    FiniteElementModel model;
    model.SetBody(bar.Body);
    EXPECT_TRUE(model.Solve(request).IsConverged);
    const double wanted = 1000.0 * 9.81 * 100.0 / (2.0 * 1e6);
    const double longer = GetTip(bar, model).z;
    RecordMeasured(poissonRatio == 0.0 ? "longer, nu 0" : "longer, nu 0.3", longer);
    EXPECT_NEAR(longer, wanted, 0.005 * wanted);
  }
}

// A straight beam that bends under its weight does not go sideways.
TEST(FiniteElementBeams, NoDrift)
{
  struct Case
  {
    std::int32_t Cells;
    double Drift;
  };
  // With an even number of cells the lattice is its own mirror image.
  for (const Case& beamCase : { Case{ 2, 1e-10 }, Case{ 4, 1e-10 }, Case{ 3, 1e-3 } })
  {
    LatticeBody beam = MakeBeam(beamCase.Cells, 0.3);
    EquilibriumRequest request = MakeConverged();
    request.Loads.Gravity = glm::dvec3(-1.0, 0.0, 0.0);
    request.Limits.RelativeTolerance = 1e-12;
    request.Limits.LinearTolerance = 1e-10;
    FiniteElementModel model;
    model.SetBody(beam.Body);
    const EquilibriumReport report = model.Solve(request);
    const glm::dvec3 tip = GetTip(beam, model);
    RecordMeasured("drift, " + std::to_string(beamCase.Cells), std::abs(tip.y) / 10.0);
    EXPECT_LT(report.RelativeResidual, 1e-9);
    EXPECT_LT(tip.x, -0.3);
    EXPECT_LT(std::abs(tip.y), 10.0 * beamCase.Drift);
  }
}

// How much less than it should a slender beam bends, for its Poisson ratio and so many cells
// across. The converged deflection, as a part of that of Euler and Bernoulli, is that of quadratic
// hexahedra with linear pressure on finer and finer meshes (it moves by under 0.05 % in the end).
// The errors of linear tetrahedra are those of another program for the same meshes, which agrees
// with CalculiX (C3D4); they are known to half a percent of the deflection.
void ExpectCantilever(double poissonRatio, double converged, std::int32_t cells, double error)
{
  const double deflection = GetDeflection(cells, poissonRatio);
  std::ostringstream name;
  name << "nu " << poissonRatio << ", " << cells;
  RecordMeasured(name.str(), deflection / converged);
  EXPECT_NEAR(100.0 * (deflection / converged - 1.0), error, 0.55) << name.str();
}

TEST(FiniteElementBeams, Cantilever)
{
  ExpectCantilever(0.3, 1.0010, 1, -64.0);
  ExpectCantilever(0.3, 1.0010, 2, -32.0);
  ExpectCantilever(0.3, 1.0010, 4, -10.8);
  ExpectCantilever(0.49, 0.9895, 1, -69.0);
  ExpectCantilever(0.49, 0.9895, 2, -39.0);
  ExpectCantilever(0.49, 0.9895, 4, -15.0);
}

TEST(FiniteElementBeams, CantileverOfEightCells)
{
  ExpectCantilever(0.3, 1.0010, 8, -3.0);
  ExpectCantilever(0.49, 0.9895, 8, -5.0);
}

// A force that bends a beam far, P L^2 / EI = 1, 2, 5, 10: how far it goes sideways and how much
// shorter it becomes, by its length, and the errors of four cells across beside the exact solution
// of a thin beam, in percent. It is too stiff, least of all where it is nearly straight again. The
// errors are those of this element, found with it: they show that it changes, not that it is right.
TEST(FiniteElementBeams, Elastica)
{
  struct Row
  {
    double Load;
    double Exact[2];
    double Error[2];
  };
  for (const Row& row : { Row{ 1.0, { 0.30172, 0.05643 }, { -9.9, -19.9 } },
         Row{ 2.0, { 0.49346, 0.16064 }, { -6.9, -15.4 } },
         Row{ 5.0, { 0.71379, 0.38763 }, { -2.5, -8.2 } },
         Row{ 10.0, { 0.81061, 0.55500 }, { -0.2, -4.4 } } })
  {
    const LatticeBody beam = MakeBeam(4, 0.0);
    EquilibriumRequest request = MakeConverged();
    request.Loads.Forces = LoadEnd(beam, glm::dvec3(row.Load * 1e6 / 12.0 / 100.0, 0.0, 0.0));
    FiniteElementModel model;
    model.SetBody(beam.Body);
    const EquilibriumReport report = model.Solve(request);
    EXPECT_TRUE(report.IsConverged);
    const glm::dvec3 tip = GetTip(beam, model) / 10.0;
    const std::string load = std::to_string(static_cast<int>(row.Load));
    RecordMeasured("load " + load, tip.x);
    RecordMeasured("shorter, load " + load, -tip.z);
    EXPECT_NEAR(100.0 * (tip.x / row.Exact[0] - 1.0), row.Error[0], 0.15);
    EXPECT_NEAR(100.0 * (-tip.z / row.Exact[1] - 1.0), row.Error[1], 0.15);
  }
}
