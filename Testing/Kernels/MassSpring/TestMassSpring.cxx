// SPDX-License-Identifier: BSD-3-Clause
// Mass-spring dynamics: misuse, and motions that have a closed-form solution.
#include "CaughtError.h"
#include "LatticeBody.h"
#include "MassSpringModel.h"
#include "Measured.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

using namespace deformvolume;
using namespace physicsTesting;

namespace
{

constexpr double Spacing = 2.5e-3;
constexpr double Pi = 3.14159265358979323846;
constexpr std::array<int, 3> SmallLattice{ { 5, 4, 3 } };

ElasticBody MakeSmallBody(double poissonRatio = 0.4)
{
  ElasticMaterial material;
  material.PoissonRatio = poissonRatio;
  return MakeLatticeBody(SmallLattice, glm::dvec3(Spacing), material);
}

std::vector<double> GetMasses(const ElasticBody& body)
{
  return GetNodeMasses(body, GetVolumes(body));
}

double FindLargest(const std::vector<float>& values)
{
  double largest = 0.0;
  for (const float value : values)
  {
    largest = std::max(largest, std::abs(static_cast<double>(value)));
  }
  return largest;
}

std::vector<float> MakeRandom(std::size_t size, double most)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-most, most);
  std::vector<float> values(size);
  std::generate(values.begin(), values.end(), [&] { return static_cast<float>(uniform(random)); });
  return values;
}

MassSpringRequest For(double duration, double timeStep = 0.0, double damping = 0.0)
{
  MassSpringRequest request;
  request.Duration = duration;
  request.TimeStep = timeStep;
  request.Damping = damping;
  return request;
}

// A body with three fixed nodes. Three springs hold the fourth node, one along each axis.
ElasticBody MakePendulum()
{
  ElasticBody body;
  body.Points = { { 0, 0, 0 }, { Spacing, 0, 0 }, { 0, Spacing, 0 }, { 0, 0, Spacing } };
  body.Tetrahedra = { { 0, 1, 2, 3 } };
  body.Fixed = { 0, 1, 1, 1 };
  body.Materials.front().PoissonRatio = 0.25;
  return body;
}

// Measures the period of the first node along x, from the times when it passes 0 upwards.
// Interpolates linearly between steps.
double MeasurePeriod(MassSpringModel& model, double timeStep, int periods)
{
  double first = -1.0;
  double last = 0.0;
  float before = 0.0F;
  int passed = -1;
  for (int i = 0; passed < periods; ++i)
  {
    model.Advance(For(timeStep, timeStep));
    const float now = model.GetDisplacements().front();
    if (before < 0.0F && now >= 0.0F)
    {
      last = timeStep * (i + 1 - static_cast<double>(now / (now - before)));
      first = first < 0.0 ? last : first;
      ++passed;
    }
    before = now;
  }
  return (last - first) / periods;
}

} // namespace

TEST(MassSpring, InvalidBodies)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  MassSpringModel model;
  EXPECT_THROW(model.Advance(For(1.0)), Error) << "without a body";
  EXPECT_THROW(model.GetStableTimeStep(), Error);
  EXPECT_THROW(model.Reset(), Error);
  EXPECT_THROW(model.SetBody({}), Error) << "no tetrahedra";
  const auto refuses = [&](const auto& change)
  {
    ElasticBody body = MakeSmallBody();
    change(body);
    EXPECT_THROW(model.SetBody(body), Error);
  };
  refuses([&](ElasticBody& body) { body.Points[3].y = nan; });
  refuses([](ElasticBody& body) { body.Tetrahedra[7][2] = 60; });
  refuses([](ElasticBody& body) { body.Tetrahedra[7][2] = -1; });
  refuses([](ElasticBody& body) { std::swap(body.Tetrahedra[7][2], body.Tetrahedra[7][1]); });
  refuses([](ElasticBody& body) { body.Tetrahedra[7][2] = body.Tetrahedra[7][1]; });
  refuses([](ElasticBody& body) { body.Fixed.assign(59, 0); });
  refuses([](ElasticBody& body) { body.Materials.clear(); });
  refuses([](ElasticBody& body) { body.Materials.resize(3); });
  for (const ElasticMaterial& bad : std::vector<ElasticMaterial>{ { 0.0, 0.3, 1e3 },
         { -1.0, 0.3, 1e3 }, { nan, 0.3, 1e3 }, { 1e4, -0.1, 1e3 }, { 1e4, 0.495, 1e3 },
         { 1e4, nan, 1e3 }, { 1e4, 0.3, 0.0 }, { 1e4, 0.3, nan } })
  {
    refuses([&](ElasticBody& body) { body.Materials = { bad }; });
    refuses(
      [&](ElasticBody& body)
      {
        body.Materials.resize(body.Tetrahedra.size());
        body.Materials.back() = bad;
      });
  }
  model.SetMemoryLimit(1000);
  EXPECT_NE(GetError([&] { model.SetBody(MakeSmallBody()); })
              .find("and 1000 are available. Use a coarser mesh, raise the memory limit"),
    std::string::npos);
  model.SetMemoryLimit(0);
  ElasticBody fixed = MakeSmallBody();
  FixNodes(fixed, [](const glm::dvec3&) { return true; });
  model.SetBody(fixed);
  EXPECT_THROW(model.Advance(For(1.0)), Error) << "all nodes are fixed";
}

// Only tetrahedra that are fifths of equal cubes are accepted.
TEST(MassSpring, TetrahedraOfOtherShapesAreAnError)
{
  MassSpringModel model;
  const auto getError = [&](const ElasticBody& body)
  {
    try
    {
      model.SetBody(body);
    }
    catch (const Error& error)
    {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto refuses = [&](const ElasticBody& body, std::size_t tetrahedron)
  {
    const std::string text = getError(body);
    const std::string wanted = "The tetrahedron with the points " +
      ListNodes(body.Tetrahedra[tetrahedron]) + " is not a fifth of a cube";
    EXPECT_EQ(text.substr(0, wanted.size()), wanted);
    EXPECT_NE(text.find("vtkFiniteElementDeformation"), std::string::npos) << text;
  };
  for (const double factor : { 0.5, 0.99, 1.01, 2.0 })
  {
    refuses(MakeLatticeBody(SmallLattice, { Spacing, Spacing, factor * Spacing }), 0);
  }
  // The last node belongs only to the last cell: to one or to all of its tetrahedra.
  ElasticBody moved = MakeSmallBody();
  moved.Points.back().x += 0.003 * Spacing;
  const auto last = static_cast<std::int32_t>(moved.Points.size() - 1);
  const auto first = std::find_if(moved.Tetrahedra.begin(), moved.Tetrahedra.end(),
    [&](const Tetrahedron& t) { return std::find(t.begin(), t.end(), last) != t.end(); });
  refuses(moved, static_cast<std::size_t>(first - moved.Tetrahedra.begin()));
  moved.Points.back().x -= 0.0025 * Spacing;
  EXPECT_EQ(getError(moved), "");
  // Smaller cubes beside the larger ones.
  ElasticBody two = MakeSmallBody();
  const auto count = static_cast<std::int32_t>(two.Points.size());
  const std::size_t before = two.Tetrahedra.size();
  for (const glm::dvec3& point : MakeSmallBody().Points)
  {
    two.Points.push_back(0.5 * point - glm::dvec3(1.0));
  }
  for (std::size_t t = 0; t < before; ++t)
  {
    Tetrahedron tetrahedron = two.Tetrahedra[t];
    for (std::int32_t& node : tetrahedron)
    {
      node += count;
    }
    two.Tetrahedra.push_back(tetrahedron);
  }
  refuses(two, before);
  // Edge lengths of a corner tetrahedron, but in another arrangement: three of them form a face.
  ElasticBody pyramid;
  const double height = Spacing * std::sqrt(2.0 - 1.0 / 3.0);
  pyramid.Points = { { 0, 0, 0 }, { Spacing, 0, 0 },
    { 0.5 * Spacing, Spacing * std::sqrt(0.75), 0 },
    { 0.5 * Spacing, Spacing * std::sqrt(1.0 / 12.0), height } };
  pyramid.Tetrahedra = { { 0, 1, 2, 3 } };
  refuses(pyramid, 0);
}

TEST(MassSpring, RotatedAndIncompleteLattices)
{
  ElasticBody body = MakeSmallBody();
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1.0, 2.0, 3.0));
  for (glm::dvec3& point : body.Points)
  {
    // Rotates by 0.7 rad about an axis (Rodrigues' formula), and translates.
    point = glm::dvec3(4.0, -2.0, 1.0) + point * std::cos(0.7) +
      glm::cross(axis, point) * std::sin(0.7) + axis * glm::dot(axis, point) * (1 - std::cos(0.7));
  }
  body.Tetrahedra.erase(body.Tetrahedra.begin() + 3, body.Tetrahedra.begin() + 22);
  MassSpringModel model;
  model.SetBody(body);
  EXPECT_GT(model.GetStableTimeStep(), 0.0);
}

TEST(MassSpring, InvalidRequests)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  ElasticBody body = MakeSmallBody();
  FixNodes(body, [](const glm::dvec3& point) { return point.x == 0.0; });
  MassSpringModel model;
  model.SetBody(body);
  EXPECT_THROW(model.SetOutput(nullptr), Error);
  MassSpringRequest pulled = For(0.01);
  pulled.Held.push_back({ 4, { 1e-3, 0, 0 } });
  model.Advance(pulled);
  const std::vector<float> before = model.GetDisplacements();
  const auto refuses = [&](const auto& change)
  {
    MassSpringRequest request = For(0.01);
    change(request);
    EXPECT_THROW(model.Advance(request), Error);
  };
  for (const double bad : { -1.0, nan, std::numeric_limits<double>::infinity() })
  {
    refuses([&](MassSpringRequest& request) { request.Duration = bad; });
    refuses([&](MassSpringRequest& request) { request.TimeStep = bad; });
    refuses([&](MassSpringRequest& request) { request.Damping = bad; });
  }
  refuses([](MassSpringRequest& request) { request.Held.assign(1, HeldNode{ 60, {} }); });
  refuses([](MassSpringRequest& request) { request.Held.assign(1, HeldNode{ -1, {} }); });
  refuses([](MassSpringRequest& request) { request.Held.assign(1, HeldNode{ 0, {} }); });
  refuses([](MassSpringRequest& request) { request.Held.assign(2, HeldNode{ 4, {} }); });
  refuses(
    [&](MassSpringRequest& request) {
      request.Held.assign(1, HeldNode{ 4, { nan, 0, 0 } });
    });
  refuses([&](MassSpringRequest& request) { request.Loads.Gravity.z = nan; });
  refuses([](MassSpringRequest& request) { request.Loads.Forces.resize(59); });
  refuses(
    [&](MassSpringRequest& request)
    {
      request.Loads.Forces.resize(60);
      request.Loads.Forces[9].x = nan;
    });
  EXPECT_THROW(model.SetState({}, {}), Error);
  EXPECT_THROW(model.SplitNodes(body, { 1 }), Error);
  EXPECT_EQ(model.GetDisplacements(), before);
}

TEST(MassSpring, NothingMovesAtRest)
{
  MassSpringModel model;
  model.SetBody(MakeSmallBody());
  EXPECT_EQ(FindLargest(model.GetForces()), 0.0);
  model.Advance(For(0.1));
  EXPECT_EQ(FindLargest(model.GetDisplacements()), 0.0);
  EXPECT_EQ(FindLargest(model.GetVelocities()), 0.0);
}

TEST(MassSpring, FreeFall)
{
  const ElasticBody body = MakeSmallBody();
  MassSpringModel model;
  model.SetBody(body);
  std::vector<float> output(body.Points.size() * 3);
  model.SetOutput(output.data(), 1000.0);
  MassSpringRequest request = For(0.1);
  request.Loads.Gravity = { 0, 0, -9.81 };
  const MassSpringReport report = model.Advance(request);
  // The sum of the velocities of all steps.
  const double fallen = 0.5 * 9.81 * 0.1 * (0.1 + report.TimeStep);
  double largest = 0.0;
  for (std::size_t i = 0; i < output.size(); ++i)
  {
    const double wanted = i % 3 == 2 ? -1000.0 * fallen : 0.0;
    largest = std::max(largest, std::abs(output[i] - wanted) / (1000.0 * fallen));
  }
  EXPECT_LT(largest, 1e-4);
  RecordMeasured("fall", largest);
}

TEST(MassSpring, Damping)
{
  const ElasticBody body = MakeSmallBody();
  MassSpringModel model;
  model.SetBody(body);
  std::vector<float> velocities(body.Points.size() * 3, 0.0F);
  for (std::size_t i = 0; i < velocities.size(); i += 3)
  {
    velocities[i] = 0.1F;
  }
  model.SetState(std::vector<float>(velocities.size(), 0.0F), velocities);
  constexpr double duration = 0.5;
  constexpr double damping = 2.0;
  model.Advance(For(duration, 0.0, damping));
  EXPECT_NEAR(model.GetVelocities().front(), 0.1 * std::exp(-damping * duration), 1e-5);
}

// A free body tends to the speed gravity / damping, also if the damping is strong for a time step.
TEST(MassSpring, TerminalSpeed)
{
  const ElasticBody body = MakeSmallBody();
  MassSpringModel model;
  model.SetBody(body);
  for (const double damping : { 100.0, 1000.0, 1e5 })
  {
    MassSpringRequest request = For(20.0 / damping, 0.0, damping);
    request.Loads.Gravity = glm::dvec3(0.0, 0.0, -9.81);
    model.Advance(request);
    EXPECT_NEAR(model.GetVelocities()[2], -9.81 / damping, 1e-4 * 9.81 / damping);
  }
}

TEST(MassSpring, MomentumOfAFreeBody)
{
  const ElasticBody body = MakeSmallBody();
  const std::vector<double> masses = GetMasses(body);
  MassSpringModel model;
  model.SetBody(body);
  const std::size_t size = body.Points.size() * 3;
  model.SetState(MakeRandom(size, 0.1 * Spacing), MakeRandom(size, 0.01));
  const auto getMomentum = [&]
  {
    const std::vector<float> velocities = model.GetVelocities();
    glm::dvec3 momentum(0.0);
    double scale = 0.0;
    for (std::size_t i = 0; i < velocities.size(); ++i)
    {
      momentum[static_cast<int>(i % 3)] += static_cast<double>(velocities[i]) * masses[i / 3];
      scale += std::abs(static_cast<double>(velocities[i])) * masses[i / 3];
    }
    return std::make_pair(momentum, scale);
  };
  const std::vector<float> forces = model.GetForces();
  const double largest = FindLargest(forces);
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < forces.size(); ++i)
  {
    sum[static_cast<int>(i % 3)] += static_cast<double>(forces[i]);
  }
  EXPECT_GT(largest, 0.0);
  EXPECT_LT(glm::length(sum), 1e-5 * largest * std::sqrt(static_cast<double>(size) / 3.0));
  const auto [before, scale] = getMomentum();
  model.Advance(For(1000 * 0.4 * model.GetStableTimeStep(), 0.4 * model.GetStableTimeStep()));
  EXPECT_LT(glm::length(getMomentum().first - before), 1e-4 * scale);
}

TEST(MassSpring, PeriodOfASpring)
{
  const ElasticBody body = MakePendulum();
  MassSpringModel model;
  model.SetBody(body);
  // A quarter of the mass of the tetrahedron; springs with a quarter of the stiffness in a lattice.
  const double mass = GetMasses(body).front();
  const double stiffness = body.Materials.front().GetShearModulus() * Spacing / 4.0;
  const double period = 2.0 * Pi * std::sqrt(mass / stiffness);
  std::vector<float> moved(12, 0.0F);
  moved[0] = static_cast<float>(1e-3 * Spacing);
  model.SetState(moved, std::vector<float>(12, 0.0F));
  const double measured = MeasurePeriod(model, period / 200.0, 10);
  EXPECT_NEAR(measured, period, 1e-3 * period);
  RecordMeasured("period", std::abs(measured / period - 1.0));
}

TEST(MassSpring, HandlesArriveAndAreReleased)
{
  ElasticBody body = MakeSmallBody();
  FixNodes(body, [](const glm::dvec3& point) { return point.x == 0.0; });
  MassSpringModel model;
  model.SetBody(body);
  const std::size_t held = GetNode(SmallLattice, 4, 1, 1);
  MassSpringRequest request = For(0.02, 0.0, 20.0);
  const glm::dvec3 wanted(0.1 * Spacing, 0.5 * Spacing, 0.0);
  request.Held.push_back({ static_cast<std::int32_t>(held), wanted });
  model.Advance(request);
  for (int i = 0; i < 50; ++i)
  {
    model.Advance(request);
  }
  std::vector<float> now = model.GetDisplacements();
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    EXPECT_EQ(now[3 * held + axis], static_cast<float>(wanted[static_cast<int>(axis)]));
    EXPECT_EQ(now[axis], 0.0F) << "displacement of the fixed node 0 on axis " << axis;
  }
  const std::size_t beside = GetNode(SmallLattice, 3, 1, 1);
  EXPECT_GT(now[3 * beside + 1], 0.1F * static_cast<float>(Spacing));
  request.Held.clear();
  for (int i = 0; i < 50; ++i)
  {
    model.Advance(request);
  }
  EXPECT_LT(FindLargest(model.GetDisplacements()), 1e-3 * Spacing);
  model.Reset();
  EXPECT_EQ(FindLargest(model.GetDisplacements()), 0.0);
  EXPECT_EQ(FindLargest(model.GetVelocities()), 0.0);
}

TEST(MassSpring, StableTimeStep)
{
  const ElasticBody body = MakeSmallBody();
  const ElasticMaterial& material = body.Materials.front();
  MassSpringModel model;
  model.SetBody(body);
  const double stable = model.GetStableTimeStep();
  const double expected = Spacing * std::sqrt(material.Density / (6.0 * material.GetLambda()));
  EXPECT_NEAR(stable, expected, 1e-6 * expected);
  ElasticBody two = body;
  two.Materials.assign(body.Tetrahedra.size(), material);
  two.Materials.front().YoungModulus *= 4.0;
  MassSpringModel modelOfTwo;
  modelOfTwo.SetBody(two);
  EXPECT_NEAR(modelOfTwo.GetStableTimeStep(), 0.5 * stable, 1e-6 * stable);
  const std::size_t size = body.Points.size() * 3;
  const std::vector<float> at(size, 0.0F);
  const std::vector<float> velocities = MakeRandom(size, 1e-4);
  model.SetState(at, velocities);
  constexpr int steps = 10000;
  model.Advance(For(steps * stable, stable));
  EXPECT_LT(FindLargest(model.GetVelocities()), 1e-3);
  model.SetState(at, velocities);
  std::string words;
  try
  {
    model.Advance(For(steps * 1.7 * stable, 1.7 * stable));
  }
  catch (const Error& error)
  {
    words = error.what();
  }
  EXPECT_NE(words.find("diverged"), std::string::npos) << words;
  EXPECT_EQ(model.GetDisplacements(), at) << "the failed call must not change the state";
  EXPECT_EQ(model.GetVelocities(), velocities);
}

TEST(MassSpring, ResultsDoNotDependOnWorkGroups)
{
  std::vector<float> expected;
  for (const std::size_t size : { 0, 1, 7, 64 })
  {
    MassSpringModel model;
    model.SetWorkGroupSize(size);
    ElasticBody body = MakeSmallBody();
    FixNodes(body, [](const glm::dvec3& point) { return point.z == 0.0; });
    model.SetBody(body);
    MassSpringRequest request = For(0.02, 2e-4, 2.0);
    request.Held.assign(1, HeldNode{ 55, { 1e-3, 0, 1e-3 } });
    request.Loads.Gravity = { 0, -9.81, 0 };
    request.Loads.Forces.assign(body.Points.size(), { 1e-6, 0, 0 });
    model.Advance(request);
    const std::vector<float> found = model.GetDisplacements();
    expected = expected.empty() ? found : expected;
    EXPECT_EQ(found, expected) << "work-groups of " << size << " items";
  }
}

TEST(MassSpring, AbortLeavesTheBodyAsItWas)
{
  MassSpringModel model;
  model.SetBody(MakeSmallBody());
  MassSpringRequest request = For(0.01);
  request.Loads.Gravity = { 0, 0, -9.81 };
  model.Advance(request);
  const std::vector<float> before = model.GetDisplacements();
  const std::vector<float> velocities = model.GetVelocities();
  int calls = 0;
  request.Duration = 10.0;
  request.Progress = [&](double fraction)
  {
    EXPECT_GT(fraction, 0.0);
    EXPECT_LT(fraction, 1.0);
    return ++calls < 3;
  };
  EXPECT_THROW(model.Advance(request), Aborted);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(model.GetDisplacements(), before);
  EXPECT_EQ(model.GetVelocities(), velocities);
}

TEST(MassSpring, MirroredTetrahedra)
{
  const ElasticBody body = MakeSmallBody();
  ElasticBody turned = body;
  for (Tetrahedron& tetrahedron : turned.Tetrahedra)
  {
    std::swap(tetrahedron[1], tetrahedron[2]);
  }
  const std::vector<float> displacements = MakeRandom(body.Points.size() * 3, 0.2 * Spacing);
  const std::vector<float> velocities(displacements.size(), 0.0F);
  MassSpringModel model;
  model.SetBody(body);
  model.SetState(displacements, velocities);
  const std::vector<float> wanted = model.GetForces();
  const std::vector<ElementResults> results = model.GetElementResults();
  model.SetBody(turned);
  model.SetState(displacements, velocities);
  const std::vector<float> found = model.GetForces();
  for (std::size_t i = 0; i < found.size(); ++i)
  {
    // Sums of some tens of terms in single precision, in another order.
    EXPECT_NEAR(found[i], wanted[i], 1e-5 * FindLargest(wanted));
  }
  const std::vector<ElementResults> resultsOfTurned = model.GetElementResults();
  for (std::size_t t = 0; t < results.size(); ++t)
  {
    EXPECT_NEAR(resultsOfTurned[t].Determinant, results[t].Determinant, 1e-12);
    for (std::size_t i = 0; i < 6; ++i)
    {
      EXPECT_NEAR(resultsOfTurned[t].Stress[i], results[t].Stress[i],
        1e-6 * std::abs(results[t].Stress[i]) + 1e-6 * body.Materials.front().YoungModulus);
    }
  }
}

TEST(MassSpring, SplitNodesKeepTheirState)
{
  // Two tetrahedra that share a face, and share no node after the split.
  ElasticBody body;
  body.Points = { { 0, 0, 0 }, { Spacing, 0, 0 }, { 0, Spacing, 0 }, { 0, 0, Spacing },
    { Spacing, Spacing, Spacing } };
  body.Tetrahedra = { { 0, 1, 2, 3 }, { 1, 4, 2, 3 } };
  ElasticBody apart = body;
  apart.Tetrahedra[1] = { 5, 4, 6, 7 };
  for (const std::size_t origin : { 1, 2, 3 })
  {
    apart.Points.push_back(body.Points[origin]);
  }
  MassSpringModel model;
  model.SetBody(body);
  std::vector<float> displacements = MakeRandom(15, 0.05 * Spacing);
  std::vector<float> velocities = MakeRandom(15, 0.01);
  model.SetState(displacements, velocities);
  model.SplitNodes(apart, { 1, 2, 3 });
  for (std::vector<float>* values : { &displacements, &velocities })
  {
    values->insert(values->end(), values->begin() + 3, values->begin() + 12);
  }
  EXPECT_EQ(model.GetDisplacements(), displacements);
  EXPECT_EQ(model.GetVelocities(), velocities);
  // Each tetrahedron moves independently, as if the other one did not exist.
  const double step = 0.5 * model.GetStableTimeStep();
  model.Advance(For(100 * step, step));
  ElasticBody alone = body;
  alone.Tetrahedra.pop_back();
  MassSpringModel other;
  other.SetBody(alone);
  other.SetState({ displacements.begin(), displacements.begin() + 15 },
    { velocities.begin(), velocities.begin() + 15 });
  other.Advance(For(100 * step, step));
  const std::vector<float> parted = model.GetDisplacements();
  const std::vector<float> expected = other.GetDisplacements();
  EXPECT_TRUE(std::equal(expected.begin(), expected.begin() + 12, parted.begin()));
  // Remove the copies again, as when a split is undone.
  const std::vector<float> together = model.GetDisplacements();
  EXPECT_THROW(model.SplitNodes(body, { 1 }), Error) << "fewer nodes than before";
  EXPECT_EQ(model.GetDisplacements(), together);
  model.SplitNodes(body, {});
  EXPECT_EQ(model.GetDisplacements(), std::vector<float>(together.begin(), together.begin() + 15));
}
