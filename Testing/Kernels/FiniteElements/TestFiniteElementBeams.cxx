// SPDX-License-Identifier: BSD-3-Clause
// Finite elements, compared with closed-form solutions and with the same elements in other
// programs.
//
// "By numpy": computed by a numpy program with this element. It agrees with CalculiX in C3D10
// elements to 4e-7 in all cases with the same material law. "Converged": computed by quadratic
// hexahedra with linear pressure on successively refined meshes.
#include "EquilibriumSolver.h"
#include "FiniteElementCase.h"
#include "Measured.h"

#include <glm/mat2x2.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <utility>

using namespace deformvolume;

namespace
{

using Place = LatticeBody::Place;

constexpr MaterialModel BothModels[2] = { MaterialModel::StableNeoHookean,
  MaterialModel::Corotational };

bool IsAt(double value, double wanted)
{
  return std::abs(value - wanted) < 1e-9;
}

// The response to a small load: the first step of Newton's method, solved to rounding. Poisson
// ratios may exceed the limit of models.
struct SmallStrain
{
  explicit SmallStrain(const ElasticBody& body)
    : Solver(None, body)
  {
    this->Request = MakeConverged();
    this->Request.Limits.LinearTolerance = 1e-11;
    this->Request.Limits.LinearIterations = 100000;
    this->Request.Limits.NewtonSteps = 1;
  }

  const std::vector<glm::dvec3>& Solve()
  {
    this->Solver.Solve(this->Request);
    return this->Solver.GetDisplacements();
  }

  AbortCheck None{ nullptr };
  EquilibriumSolver Solver;
  EquilibriumRequest Request;
};

// A beam along z, ten times as long as thick, fixed at its lower end. Its thickness is 1, E = 1.
QuadraticLattice MakeBeam(std::int32_t cells, double poissonRatio)
{
  return QuadraticLattice({ cells + 1, cells + 1, 10 * cells + 1 }, 1.0 / cells,
    MakeMaterial(1.0, poissonRatio), [](const Place& place) { return place[2] == 0; });
}

std::vector<glm::dvec3> LoadEnd(const ElasticBody& beam, const glm::dvec3& traction)
{
  return LoadFaces(
    beam, [](const glm::dvec3& point) { return IsAt(point.z, 10.0); }, traction);
}

// The force on the upper face of a cube of size 1, E = 1. Both faces are bonded to plates, and the
// upper plate moves along z.
double PressCube(std::int32_t cells, double poissonRatio, double move, bool isLarge)
{
  const QuadraticLattice cube({ cells + 1, cells + 1, cells + 1 }, 1.0 / cells,
    MakeMaterial(1.0, poissonRatio), [](const Place& place) { return place[2] == 0; });
  const std::vector<std::int32_t> upper =
    FindNodes(cube.Body, [](const glm::dvec3& point) { return IsAt(point.z, 1.0); });
  SmallStrain solver(cube.Body);
  const int steps = isLarge ? 5 : 1;
  for (int step = 1; step <= steps; ++step)
  {
    solver.Request.Held.clear();
    for (const std::int32_t node : upper)
    {
      solver.Request.Held.push_back({ node, glm::dvec3(0.0, 0.0, move * step / steps) });
    }
    solver.Request.Limits.NewtonSteps = isLarge ? 0 : 1;
    solver.Request.Limits.LinearTolerance = isLarge ? 0.0 : 1e-11;
    const EquilibriumReport report = solver.Solver.Solve(solver.Request);
    EXPECT_TRUE(report.IsConverged || !isLarge);
  }
  double force = 0.0;
  for (const std::int32_t node : upper)
  {
    force += solver.Solver.GetForces()[static_cast<std::size_t>(node)].z;
  }
  return force;
}

std::string MakeName(double poissonRatio, std::int32_t cells)
{
  std::ostringstream name;
  name << "nu " << poissonRatio << ", " << cells;
  return name.str();
}

// Records and checks a value. byNumpy: the value for the same mesh. converged, percent: the
// converged value, and the allowed difference from it.
void Expect(double value, double byNumpy, double converged, double percent, const std::string& name)
{
  RecordMeasured(name, value);
  EXPECT_NEAR(value, byNumpy, 1e-4 * std::max(1.0, std::abs(byNumpy)))
    << name << ", compared with the value of NumPy";
  EXPECT_NEAR(value / converged, 1.0, 0.01 * percent) << name << ", divided by the converged value";
}

} // namespace

TEST(FiniteElementBeams, RigidMotion)
{
  // E h^2 = 2800 N.
  for (const MaterialModel material : BothModels)
  {
    const QuadraticLattice lattice({ 5, 5, 5 }, 0.1, MakeMaterial(2.8e5, 0.45));
    FiniteElementModel model;
    model.SetMaterialModel(material);
    model.SetBody(lattice.Body);
    model.SetDisplacements(
      MapPoints(lattice.Body, MakeRotation(2.0, { 1.0, 2.0, -0.5 }), glm::dvec3(0.7, -0.3, 1.1)));
    const double force = LargestOf(model.GetForces());
    RecordMeasured("force", force);
    // The rounding errors of E h^2 and of positions of about ten edges.
    EXPECT_LT(force, 5e-11);
  }
}

TEST(FiniteElementBeams, Patch)
{
  LatticeBody lattice({ 5, 5, 5 }, 0.25, MakeMaterial(1e4, 0.45));
  const auto isOutside = [](const glm::dvec3& point)
  {
    bool isOnFace = false;
    for (int axis = 0; axis < 3; ++axis)
    {
      isOnFace = isOnFace || IsAt(point[axis], 0.0) || IsAt(point[axis], 1.0);
    }
    return isOnFace;
  };
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.04, 0.04);
  for (glm::dvec3& point : lattice.Body.Points)
  {
    if (!isOutside(point))
    {
      point += glm::dvec3(jitter(random), jitter(random), jitter(random));
    }
  }
  AddMidSideNodes(lattice.Body);
  const glm::dmat3 stretch(1.2, 0.05, 0.0, 0.1, 0.9, 0.03, -0.04, 0.02, 1.1);
  const std::vector<glm::dvec3> wanted = MapPoints(
    lattice.Body, MakeRotation(1.0, { 1.0, -1.0, 0.3 }) * stretch, glm::dvec3(0.2, 0.1, -0.3));
  EquilibriumRequest request = MakeConverged();
  for (const std::int32_t node : FindNodes(lattice.Body, isOutside))
  {
    request.Held.push_back({ node, wanted[static_cast<std::size_t>(node)] });
  }
  request.Limits.RelativeTolerance = 1e-12;
  request.Limits.LinearTolerance = 1e-10;
  for (const MaterialModel material : BothModels)
  {
    FiniteElementModel model;
    model.SetMaterialModel(material);
    model.SetBody(lattice.Body);
    EXPECT_TRUE(model.Solve(request).IsConverged);
    const double error = LargestDifference(model.GetDisplacements(), wanted);
    RecordMeasured("error", error);
    EXPECT_LT(error, 1e-11);
  }
}

namespace
{

// A homogeneous state of the stable neo-Hookean law with E = 10 kPa: one axis or two axes are
// stretched by a nominal stress in Pa, and the other axes are free. The solution has a closed form,
// except for the stretch of the free axes, which is the root of the transverse stress.
struct HomogeneousState
{
  double PoissonRatio;
  double Stretch;
  double Stress;
  double Free;
};

// Pulls a cube of size 1 at opposite faces. One node is fixed, and the nodes of two faces slide.
// This prevents rotations, which compressive forces would cause.
void ExpectHomogeneous(const HomogeneousState& state, bool areTwo)
{
  QuadraticLattice cube({ 3, 3, 3 }, 0.5, MakeMaterial(1e4, state.PoissonRatio),
    [](const Place& place) { return place[0] + place[1] + place[2] == 0; });
  ElasticBody& body = cube.Body;
  for (std::size_t node = 0; node < body.Points.size(); ++node)
  {
    const glm::dvec3& point = body.Points[node];
    const glm::dvec3 normal(point.x == 0.0 ? 2.0 : 0.0, point.x > 0.0 && point.y == 0.0, 0.0);
    body.SlidingNormals.push_back(body.IsFixed(node) ? glm::dvec3(0.0) : normal);
  }

  EquilibriumRequest request = MakeConverged();
  request.Limits.RelativeTolerance = 1e-9;
  request.Limits.LinearTolerance = 1e-11;
  request.Loads.Forces.assign(body.Points.size(), glm::dvec3(0.0));
  for (int axis = 0; axis < (areTwo ? 2 : 1); ++axis)
  {
    for (const double side : { 0.0, 1.0 })
    {
      glm::dvec3 traction(0.0);
      traction[axis] = side == 0.0 ? -state.Stress : state.Stress;
      const std::vector<glm::dvec3> forces = LoadFaces(
        body, [&](const glm::dvec3& point) { return IsAt(point[axis], side); }, traction);
      std::transform(forces.begin(), forces.end(), request.Loads.Forces.begin(),
        request.Loads.Forces.begin(), [](const auto& a, const auto& b) { return a + b; });
    }
  }
  FiniteElementModel model;
  model.SetBody(body);
  EXPECT_TRUE(model.Solve(request).IsConverged)
    << "Poisson ratio " << state.PoissonRatio << ", stretch " << state.Stretch;

  const glm::dvec3 stretches(state.Stretch, areTwo ? state.Stretch : state.Free, state.Free);
  const std::vector<glm::dvec3> wanted = MapPoints(
    body, glm::dmat3(stretches.x, 0, 0, 0, stretches.y, 0, 0, 0, stretches.z), glm::dvec3(0.0));
  // The stretches of the free axes are given with seven digits.
  const double error = LargestDifference(model.GetDisplacements(), wanted);
  RecordMeasured("error", error);
  EXPECT_LT(error, 1e-6) << "Poisson ratio " << state.PoissonRatio << ", stretch " << state.Stretch;
  for (const ElementResults& result : model.GetElementResults())
  {
    const double nominal = result.Stress[0] * stretches.y * stretches.z;
    EXPECT_NEAR(nominal / state.Stress, 1.0, 2e-6);
    EXPECT_NEAR(result.Stress[2], 0.0, 1e-6 * std::abs(state.Stress));
  }
}

} // namespace

TEST(FiniteElementBeams, Uniaxial)
{
  for (const HomogeneousState& state : { HomogeneousState{ 0.3, 0.6, -5527.0655, 1.105542 },
         HomogeneousState{ 0.45, 0.6, -6871.0089, 1.247219 },
         HomogeneousState{ 0.49, 0.6, -7183.6938, 1.282359 },
         HomogeneousState{ 0.3, 0.8, -2331.7308, 1.060660 },
         HomogeneousState{ 0.45, 0.8, -2494.6121, 1.103970 },
         HomogeneousState{ 0.49, 0.8, -2532.5084, 1.115235 },
         HomogeneousState{ 0.3, 1.2, 1766.3818, 0.942809 },
         HomogeneousState{ 0.45, 1.2, 1703.3844, 0.920447 },
         HomogeneousState{ 0.49, 1.2, 1688.7273, 0.914391 },
         HomogeneousState{ 0.3, 1.5, 3831.9088, 0.869227 },
         HomogeneousState{ 0.45, 1.5, 3588.7612, 0.829993 },
         HomogeneousState{ 0.49, 1.5, 3532.1899, 0.819214 },
         HomogeneousState{ 0.3, 2.0, 6538.4615, 0.774597 },
         HomogeneousState{ 0.45, 2.0, 5991.3793, 0.724569 },
         HomogeneousState{ 0.49, 2.0, 5864.0940, 0.710634 } })
  {
    ExpectHomogeneous(state, false);
  }
}

TEST(FiniteElementBeams, Equibiaxial)
{
  for (const HomogeneousState& state : { HomogeneousState{ 0.3, 0.8, -2811.6719, 1.106719 },
         HomogeneousState{ 0.45, 0.8, -5467.5647, 1.381476 },
         HomogeneousState{ 0.49, 0.8, -7001.0132, 1.519553 },
         HomogeneousState{ 0.3, 1.2, 2486.4245, 0.815006 },
         HomogeneousState{ 0.45, 1.2, 2611.8702, 0.728745 },
         HomogeneousState{ 0.49, 1.2, 2650.4592, 0.701567 },
         HomogeneousState{ 0.3, 1.5, 4916.5753, 0.576659 },
         HomogeneousState{ 0.45, 1.5, 4644.0403, 0.479419 },
         HomogeneousState{ 0.49, 1.5, 4577.4119, 0.451549 } })
  {
    ExpectHomogeneous(state, true);
  }
}

// Simple shear g of the same law: s12 = mu g, s11 = mu g^2, and all other stresses are exactly 0.
TEST(FiniteElementBeams, SimpleShear)
{
  for (const double poissonRatio : { 0.3, 0.45, 0.49 })
  {
    const QuadraticLattice cube({ 3, 3, 3 }, 0.5, MakeMaterial(1e4, poissonRatio));
    FiniteElementModel model;
    model.SetBody(cube.Body);
    for (const double shear : { 0.1, 0.5, 1.0 })
    {
      model.SetDisplacements(
        MapPoints(cube.Body, glm::dmat3(1, 0, 0, shear, 1, 0, 0, 0, 1), glm::dvec3(0.0)));
      const double mu = 1e4 / (2.0 * (1.0 + poissonRatio));
      for (const ElementResults& result : model.GetElementResults())
      {
        EXPECT_NEAR(result.Stress[3], mu * shear, 1e-8);
        EXPECT_NEAR(result.Stress[0], mu * shear * shear, 1e-8);
        for (const std::size_t other : { 1, 2, 4, 5 })
        {
          EXPECT_NEAR(result.Stress[other], 0.0, 1e-8);
        }
        EXPECT_NEAR(result.Determinant, 1.0, 1e-12);
      }
    }
  }
}

// Cauchy stresses of the corotational law in a simple shear of 0.5 and a stretch normal to its
// plane. The part of lambda up to 4 mu acts on tr(S - 1). The rest, which is greater than 0 for a
// Poisson ratio of 0.49, acts on J - 1.
TEST(FiniteElementBeams, CorotationalShear)
{
  for (const double poissonRatio : { 0.3, 0.49 })
  {
    const QuadraticLattice cube({ 3, 3, 3 }, 0.5, MakeMaterial(1e4, poissonRatio));
    FiniteElementModel model;
    model.SetMaterialModel(MaterialModel::Corotational);
    model.SetBody(cube.Body);
    const double mu = 1e4 / (2.0 * (1.0 + poissonRatio));
    const double all = 1e4 * poissonRatio / ((1.0 + poissonRatio) * (1.0 - 2.0 * poissonRatio));
    const double lambda = std::min(all, 4.0 * mu);
    for (const double stretch : { 1.0, 1.1 })
    {
      model.SetDisplacements(
        MapPoints(cube.Body, glm::dmat3(1, 0, 0, 0.5, 1, 0, 0, 0, stretch), glm::dvec3(0.0)));
      // F = R S in the plane: R turns by atan(g / 2), and tr S - 2 = sqrt(4 + g^2) - 2.
      const double half = std::atan(0.25);
      const double trace = std::sqrt(4.25) - 2.0 + stretch - 1.0;
      const double ofVolume = (all - lambda) * (stretch - 1.0);
      const glm::dmat2 F(1.0, 0.0, 0.5, 1.0);
      const glm::dmat2 R(std::cos(half), -std::sin(half), std::sin(half), std::cos(half));
      const glm::dmat2 stress =
        (2.0 * mu * (F - R) + lambda * trace * R) * glm::transpose(F) / stretch;
      for (const ElementResults& result : model.GetElementResults())
      {
        EXPECT_NEAR(result.Stress[0], stress[0][0] + ofVolume, 1e-7);
        EXPECT_NEAR(result.Stress[1], stress[1][1] + ofVolume, 1e-7);
        EXPECT_NEAR(result.Stress[3], stress[1][0], 1e-7);
        EXPECT_NEAR(result.Stress[2], 2.0 * mu * (stretch - 1.0) + lambda * trace + ofVolume, 1e-7);
        // The values in Documents/physics.md.
        if (stretch == 1.0 && poissonRatio == 0.49)
        {
          EXPECT_NEAR(result.Stress[3], 1930.0, 5.0);
          EXPECT_NEAR(result.Stress[2], 830.0, 5.0);
        }
      }
    }
  }
}

// The deflection of a slender beam by a small force, divided by that of Euler-Bernoulli theory.
TEST(FiniteElementBeams, Cantilever)
{
  struct Row
  {
    double PoissonRatio;
    double Converged;
    double ByNumpy[2];
  };
  for (const Row& row : { Row{ 0.3, 1.0010, { 0.98493, 0.99653 } },
         Row{ 0.45, 0.9927, { 0.97455, 0.98518 } }, Row{ 0.49, 0.9895, { 0.98365, 0.98280 } } })
  {
    for (const std::int32_t cells : { 1, 2 })
    {
      const QuadraticLattice beam = MakeBeam(cells, row.PoissonRatio);
      constexpr double traction = 1e-9;
      SmallStrain solver(beam.Body);
      solver.Request.Loads.Forces = LoadEnd(beam.Body, glm::dvec3(traction, 0.0, 0.0));
      const double deflection =
        GetLoadedMean(solver.Request.Loads.Forces, solver.Solve()).x / (4000.0 * traction);
      Expect(deflection, row.ByNumpy[cells - 1], row.Converged, cells == 1 ? 3.0 : 1.0,
        MakeName(row.PoissonRatio, cells));
    }
  }
}

// A slender rod of bone, bent by a small force, as a sequence of frames: beam theory to 1 %.
TEST(FiniteElementBeams, StiffRod)
{
  constexpr std::int32_t cells = 50;
  constexpr double width = 4e-3;
  const QuadraticLattice rod({ 2, 2, cells + 1 }, width, MakeMaterial(18.6e9, 0.3),
    [](const Place& place) { return place[2] == 0; });
  EquilibriumRequest request;
  constexpr double force = 0.05;
  request.Loads.Forces = LoadFaces(
    rod.Body, [](const glm::dvec3& point) { return IsAt(point.z, cells * width); },
    glm::dvec3(force / (width * width), 0.0, 0.0));
  FiniteElementModel model;
  model.SetBody(rod.Body);
  EquilibriumReport report;
  for (int frame = 0; frame < 10 && !report.IsConverged; ++frame)
  {
    report = model.Solve(request);
  }
  EXPECT_TRUE(report.IsConverged);
  EXPECT_LE(report.RelativeResidual, 1e-3);
  const double byTheory = 4.0 * force * std::pow(cells * width, 3) / (18.6e9 * std::pow(width, 4));
  EXPECT_NEAR(
    GetLoadedMean(request.Loads.Forces, model.GetDisplacements()).x / byTheory, 1.0, 0.01);
}

// A rod that is 200 times as long as thick needs multigrid in double precision.
TEST(FiniteElementBeams, SlenderRod)
{
  constexpr std::int32_t cells = 200;
  const QuadraticLattice rod({ 2, 2, cells + 1 }, 1.0, MakeMaterial(1.0, 0.3),
    [](const Place& place) { return place[2] == 0; });
  EquilibriumRequest request = MakeConverged();
  constexpr double traction = 1e-9;
  request.Loads.Forces = LoadFaces(
    rod.Body, [](const glm::dvec3& point) { return IsAt(point.z, cells); },
    glm::dvec3(traction, 0.0, 0.0));
  FiniteElementModel model;
  model.SetBody(rod.Body);
  const EquilibriumReport report = model.Solve(request);
  EXPECT_TRUE(report.IsConverged);
  RecordMeasured("iterations", report.LinearIterations);
  EXPECT_LT(report.LinearIterations, 1500);
  const double byTheory = 4.0 * traction * std::pow(cells, 3);
  EXPECT_NEAR(
    GetLoadedMean(request.Loads.Forces, model.GetDisplacements()).x / byTheory, 1.0, 0.01);
}

// A cube between bonded plates that are pulled apart slightly: force / (E A strain).
TEST(FiniteElementBeams, BondedCube)
{
  struct Row
  {
    double PoissonRatio;
    double ByNumpy;
    double Converged;
  };
  for (const Row& row :
    { Row{ 0.3, 1.07196, 1.0639 }, Row{ 0.45, 1.20136, 1.1727 }, Row{ 0.49, 1.25792, 1.2196 } })
  {
    constexpr double strain = 1e-9;
    Expect(PressCube(4, row.PoissonRatio, strain, false) / strain, row.ByNumpy, row.Converged, 4.0,
      MakeName(row.PoissonRatio, 4));
  }
}

// Cook's membrane: a tapered panel, fixed at its left side and sheared at its right side.
TEST(FiniteElementBeams, Cook)
{
  for (const auto& [poissonRatio, byNumpy, converged] :
    { std::array<double, 3>{ 0.3, 1.46173, 1.4890 }, { 0.499, 1.42696, 1.4838 } })
  {
    LatticeBody panel({ 5, 5, 3 }, 0.25, MakeMaterial(1.0, poissonRatio));
    panel.Fix([](const Place& place) { return place[0] == 0; });
    for (glm::dvec3& point : panel.Body.Points)
    {
      const double lower = 44.0 * point.x;
      const double upper = 44.0 + 16.0 * point.x;
      point = glm::dvec3(48.0 * point.x, lower + (upper - lower) * point.y, 32.0 * point.z);
    }
    AddMidSideNodes(panel.Body);
    constexpr double force = 1e-6;
    SmallStrain solver(panel.Body);
    solver.Request.Loads.Forces = LoadFaces(
      panel.Body, [](const glm::dvec3& point) { return IsAt(point.x, 48.0); },
      glm::dvec3(0.0, force / 256.0, 0.0));
    const double moved = GetLoadedMean(solver.Request.Loads.Forces, solver.Solve()).y / force;
    Expect(moved, byNumpy, converged, 4.0, MakeName(poissonRatio, 4));
  }
}

// A beam with two layers. The upper layer is a hundred times as stiff as the lower one.
TEST(FiniteElementBeams, Bilayer)
{
  for (const auto& [cells, byNumpy] :
    { std::pair<std::int32_t, double>{ 2, 282.25 }, { 4, 279.30 } })
  {
    QuadraticLattice beam = MakeBeam(cells, 0.49);
    beam.Body.Materials.resize(beam.Body.Tetrahedra.size(), MakeMaterial(1.0, 0.49));
    for (std::size_t t = 0; t < beam.Body.Tetrahedra.size(); ++t)
    {
      double middle = 0.0;
      for (const std::int32_t node : beam.Body.Tetrahedra[t])
      {
        middle += 0.25 * beam.Body.Points[static_cast<std::size_t>(node)].x;
      }
      beam.Body.Materials[t].YoungModulus = middle < 0.5 ? 1.0 : 100.0;
    }
    constexpr double force = 1e-8;
    SmallStrain solver(beam.Body);
    solver.Request.Loads.Forces = LoadEnd(beam.Body, glm::dvec3(force, 0.0, 0.0));
    const double moved = GetLoadedMean(solver.Request.Loads.Forces, solver.Solve()).x / force;
    Expect(moved, byNumpy, 279.2, 1.5, MakeName(0.49, cells));
  }
}

// A force that bends a beam far, P L^2 / EI = 5: lateral displacement and shortening of its end,
// divided by its length.
TEST(FiniteElementBeams, BentCantilever)
{
  struct Row
  {
    double PoissonRatio;
    double ByNumpy[2];
    double Converged[2];
  };
  for (const Row& row : { Row{ 0.3, { 0.72023, 0.38820 }, { 0.7219, 0.3896 } },
         Row{ 0.49, { 0.7150, 0.0 }, { 0.718, 0.386 } } })
  {
    const QuadraticLattice beam = MakeBeam(2, row.PoissonRatio);
    EquilibriumRequest request = MakeConverged();
    request.Loads.Forces = LoadEnd(beam.Body, glm::dvec3(5.0 / 12.0 / 100.0, 0.0, 0.0));
    FiniteElementModel model;
    model.SetBody(beam.Body);
    const EquilibriumReport report = model.Solve(request);
    EXPECT_TRUE(report.IsConverged);
    EXPECT_EQ(report.NumberOfInvertedTetrahedra, 0);
    RecordMeasured("steps, " + MakeName(row.PoissonRatio, 2), report.NewtonSteps);
    const glm::dvec3 end = GetLoadedMean(request.Loads.Forces, model.GetDisplacements()) / 10.0;
    Expect(end.x, row.ByNumpy[0], row.Converged[0], 0.5, MakeName(row.PoissonRatio, 2));
    if (row.ByNumpy[1] > 0.0)
    {
      Expect(
        -end.z, row.ByNumpy[1], row.Converged[1], 0.5, "shorter, " + MakeName(row.PoissonRatio, 2));
    }
  }
}

// The bonded cube, compressed by a fifth of its height.
TEST(FiniteElementBeams, PressedCube)
{
  Expect(PressCube(4, 0.49, -0.2, true), -0.32087, -0.300, 8.0, MakeName(0.49, 4));
  Expect(PressCube(8, 0.49, -0.2, true), -0.31015, -0.300, 4.0, MakeName(0.49, 8));
}

// Under its own weight a bar gets longer by rho g L^2 / 2E, if strains are small. Its fixed end
// cannot get thinner. This matters less for longer bars.
TEST(FiniteElementBeams, HangingBar)
{
  for (const double poissonRatio : { 0.0, 0.3 })
  {
    QuadraticLattice bar({ 2, 2, 41 }, 0.25, MakeMaterial(1e9, poissonRatio),
      [](const Place& place) { return place[2] == 0; });
    EquilibriumRequest request = MakeConverged();
    request.Loads.Gravity = glm::dvec3(0.0, 0.0, 9.81);
    FiniteElementModel model;
    model.SetBody(bar.Body);
    EXPECT_TRUE(model.Solve(request).IsConverged);
    const double wanted = 1000.0 * 9.81 * 100.0 / (2.0 * 1e9);
    const std::vector<std::int32_t> end =
      FindNodes(bar.Body, [](const glm::dvec3& point) { return IsAt(point.z, 10.0); });
    double longer = 0.0;
    for (const std::int32_t node : end)
    {
      longer += model.GetDisplacements()[static_cast<std::size_t>(node)].z /
        static_cast<double>(end.size());
    }
    RecordMeasured(poissonRatio == 0.0 ? "longer, nu 0" : "longer, nu 0.3", longer);
    EXPECT_NEAR(longer, wanted, poissonRatio == 0.0 ? 1e-5 * wanted : 0.005 * wanted);
  }
}

// A straight beam that bends under its weight must not move sideways.
TEST(FiniteElementBeams, NoDrift)
{
  // With an even number of cells the lattice is symmetric.
  QuadraticLattice beam = MakeBeam(2, 0.3);
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(-1e-6, 0.0, 0.0);
  request.Limits.RelativeTolerance = 1e-12;
  request.Limits.LinearTolerance = 1e-10;
  FiniteElementModel model;
  model.SetBody(beam.Body);
  const EquilibriumReport report = model.Solve(request);
  const glm::dvec3 end =
    GetLoadedMean(LoadEnd(beam.Body, glm::dvec3(1.0, 0.0, 0.0)), model.GetDisplacements());
  RecordMeasured("drift", std::abs(end.y) / 10.0);
  EXPECT_LT(report.RelativeResidual, 1e-9);
  EXPECT_LT(end.x, -3.0);
  EXPECT_LT(std::abs(end.y), 1e-9);
}
