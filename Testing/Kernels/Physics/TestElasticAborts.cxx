// SPDX-License-Identifier: BSD-3-Clause
// Aborts while a model takes over a body, and while it solves: they are quick, and leave the
// previous state.
#include "FiniteElementCase.h"
#include "MassSpringModel.h"
#include "ParallelFor.h"
#include "TimeAllowance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <thread>

using namespace deformvolume;

namespace
{

using Place = LatticeBody::Place;

// In seconds. With the address or the thread sanitizer all code is several times slower, and bodies
// are smaller.
#ifdef DEFORMVOLUME_TEST_SANITIZED
constexpr double LongestPause = 0.5;
constexpr int Shrinking = 2;
#else
constexpr double LongestPause = 0.05;
constexpr int Shrinking = 1;
#endif
// On slow machines: as a part of the time of the whole call.
constexpr double LongestShare = 0.1;

// A lattice with randomly moved nodes, fixed at one end.
ElasticBody MakeBody(const Place& nodes)
{
  // A multigrid hierarchy needs at least this many nodes on an axis. Axes with fewer nodes are not
  // changed.
  constexpr std::int32_t least = 7;
  Place fewer = nodes;
  for (std::int32_t& count : fewer)
  {
    count = std::min(count, std::max(least, count / Shrinking));
  }
  LatticeBody lattice(fewer, 0.01, MakeMaterial(1e4, 0.4));
  lattice.Fix([](const Place& place) { return place[2] == 0; });
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-0.001, 0.001);
  for (glm::dvec3& point : lattice.Body.Points)
  {
    point += glm::dvec3(jitter(random), jitter(random), jitter(random));
  }
  AddMidSideNodes(lattice.Body);
  return lattice.Body;
}

void RunOnOneThread(
  std::int64_t first, std::int64_t last, std::int64_t grain, const ParallelBody& body)
{
  RunOnOwnThreads(first, last, grain, body, 1);
}

// Counts calls of Progress, and measures the longest time between two calls. It measures the
// processor time of the process, so that other programs have no effect. The times of all threads
// are added: loops therefore run on one thread.
class Questions
{
public:
  Questions() { SetParallelLoop(RunOnOneThread); }
  ~Questions() { SetParallelLoop(nullptr); }

  bool Ask()
  {
    this->Look();
    return ++this->Number <= this->Allowed;
  }
  /// Returns the longest time, including the time after the last call.
  double GetLongestPause()
  {
    this->Look();
    std::cout << 1e3 * this->Longest << " ms at most between two calls of Progress\n";
    return this->Longest;
  }

  /// Returns the longest time, relative to that which is allowed.
  double GetExcess()
  {
    const double longest = this->GetLongestPause();
    const double all = static_cast<double>(this->Last - this->First) / CLOCKS_PER_SEC;
    return longest / std::max(LongestPause, LongestShare * all);
  }

  int Allowed = std::numeric_limits<int>::max();
  int Number = 0;

private:
  void Look()
  {
    const std::clock_t now = std::clock();
    this->Longest = std::max(this->Longest, static_cast<double>(now - this->Last) / CLOCKS_PER_SEC);
    this->Last = now;
  }

  std::clock_t First = std::clock();
  std::clock_t Last = this->First;
  double Longest = 0.0;
};

} // namespace

// Virtual machines may take several times as long to provide memory, so that the shortest pauses of
// up to three runs count.
TEST(ElasticAborts, FiniteElementsCallProgressOften)
{
  const ElasticBody body = MakeBody({ 16, 16, 31 });
  double ofBody = 1e9;
  double ofSolution = 1e9;
  for (int run = 0; run < 3 && std::max(ofBody, ofSolution) >= 1.0; ++run)
  {
    FiniteElementModel model;
    {
      Questions questions;
      model.SetBody(body, [&] { return questions.Ask(); });
      ofBody = std::min(ofBody, questions.GetExcess());
      EXPECT_GT(questions.Number, 5);
    }
    // The first linear system builds the multigrid hierarchy.
    EquilibriumRequest request = MakeConverged();
    request.Loads.Gravity = glm::dvec3(0.0, -1.0, 0.0);
    request.Limits.NewtonSteps = 1;
    request.Limits.LinearIterations = 1;
    Questions questions;
    request.Progress = [&] { return questions.Ask(); };
    model.Solve(request);
    ofSolution = std::min(ofSolution, questions.GetExcess());
    EXPECT_GT(questions.Number, 10);
  }
  std::cout << ofBody << " and " << ofSolution << " of the allowed pauses\n";
  EXPECT_LT(ofBody, 1.0);
  EXPECT_LT(ofSolution, 1.0);
}

TEST(ElasticAborts, AbortedSettersKeepTheLastBody)
{
  const ElasticBody body = MakeBody({ 7, 7, 7 });
  const ElasticBody other = MakeBody({ 16, 16, 16 });
  FiniteElementModel model;
  EquilibriumRequest request;
  request.Loads.Gravity = glm::dvec3(0.0, -1.0, 0.0);
  EXPECT_THROW(model.SetBody(body, [] { return false; }), Aborted);
  EXPECT_EQ(GetError([&] { model.Solve(request); }), "There is no body. Call SetBody first.");
  model.SetBody(body);
  model.Solve(request);
  const std::vector<glm::dvec3> before = model.GetDisplacements();
  EXPECT_GT(LargestOf(before), 0.0);
  for (const int allowed : { 0, 1 })
  {
    Questions questions;
    questions.Allowed = allowed;
    EXPECT_THROW(model.SetBody(other, [&] { return questions.Ask(); }), Aborted);
    EXPECT_EQ(questions.Number, allowed + 1);
    EXPECT_EQ(model.GetDisplacements(), before);
  }
  // The aborted calls have no effect on the next solution.
  FiniteElementModel fresh;
  fresh.SetBody(body);
  fresh.Solve(request);
  fresh.Solve(request);
  model.Solve(request);
  EXPECT_EQ(model.GetDisplacements(), fresh.GetDisplacements());
}

namespace
{

// Frames of a body with handles at four nodes of its free end.
class Frames
{
public:
  explicit Frames(const Place& nodes)
    : Body(MakeBody(nodes))
  {
    this->Model.SetBody(this->Body);
  }

  // first: how far the handles are from the last node.
  EquilibriumRequest MakeRequest(int frame, std::int32_t first = 0) const
  {
    EquilibriumRequest request;
    const auto nodes = static_cast<std::int32_t>(this->Body.Points.size());
    for (const std::int32_t node : { 1, 2, 5, 9 })
    {
      request.Held.push_back({ nodes - first - node, glm::dvec3(1e-3 * frame, 5e-4 * frame, 0.0) });
    }
    request.Loads.Gravity = glm::dvec3(0.0, -1.0, 0.0);
    return request;
  }
  void Solve(int first, int last)
  {
    for (int frame = first; frame <= last; ++frame)
    {
      this->Model.Solve(this->MakeRequest(frame));
    }
  }

  ElasticBody Body;
  FiniteElementModel Model;
};

// Aborts Solve() after a number of calls of Progress. Each call takes longer than the minimum time
// between two calls, so that none is skipped. Returns whether the call was aborted.
bool AbortAfter(int allowed, FiniteElementModel& model, EquilibriumRequest request)
{
  request.Progress = [&]
  {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return allowed-- > 0;
  };
  try
  {
    model.Solve(request);
  }
  catch (const Aborted&)
  {
    return true;
  }
  return false;
}

} // namespace

// An aborted call restores the previous displacements, and no other state remains. The results of
// the next calls equal, bit for bit, those of a new model that begins with these displacements. The
// small body is preconditioned by the inverse of the diagonal, the large one by the multigrid
// hierarchy.
TEST(ElasticAborts, AbortedSolvesKeepTheLastDisplacements)
{
  for (const Place& nodes : { Place{ 4, 4, 4 }, Place{ 7, 7, 7 } })
  {
    Frames fresh(nodes);
    fresh.Solve(1, 4);
    const std::vector<glm::dvec3> before = fresh.Model.GetDisplacements();
    fresh.Model.SetDisplacements(before);
    fresh.Solve(5, 7);

    std::vector<EquilibriumRequest> requests = { fresh.MakeRequest(5), fresh.MakeRequest(9),
      fresh.MakeRequest(5, 3), fresh.MakeRequest(5) };
    requests[1].Loads.Gravity *= 40.0;
    requests[3].Mode = EquilibriumMode::Converged;
    requests[3].Limits.NewtonSteps = 3;
    for (std::size_t i = 0; i < requests.size(); ++i)
    {
      SCOPED_TRACE(i);
      Frames frames(nodes);
      frames.Solve(1, 4);
      for (const int allowed : { 0, 1, 3, 10, 30, 50 })
      {
        EXPECT_TRUE(AbortAfter(allowed, frames.Model, requests[i]));
        EXPECT_EQ(frames.Model.GetDisplacements(), before);
      }
      frames.Solve(5, 7);
      EXPECT_EQ(frames.Model.GetDisplacements(), fresh.Model.GetDisplacements());
    }
    // A call that fails has no effect on the next ones either.
    Frames frames(nodes);
    frames.Solve(1, 4);
    EquilibriumRequest request = fresh.MakeRequest(1);
    request.Held.front().Displacement.x = 1e200;
    EXPECT_NE(
      GetError([&] { frames.Model.Solve(request); }).find("not a number"), std::string::npos);
    frames.Solve(5, 7);
    EXPECT_EQ(frames.Model.GetDisplacements(), fresh.Model.GetDisplacements());
  }
}

// Large displacements make the multigrid hierarchy differ from the matrix. An aborted call must
// rebuild the hierarchy.
TEST(ElasticAborts, AfterALargeDisplacement)
{
  for (const EquilibriumMode mode : { EquilibriumMode::Interactive, EquilibriumMode::Converged })
  {
    Frames frames({ 7, 7, 7 });
    frames.Solve(1, 1);
    for (int frame = 120; frame <= 300 / Shrinking; frame += 180)
    {
      EquilibriumRequest request = frames.MakeRequest(frame);
      request.Mode = mode;
      for (const int steps : { 6, 1, 2 })
      {
        request.Limits.NewtonSteps = steps;
        frames.Model.Solve(request);
        request.Held.front().Displacement *= 1.1;
        EXPECT_TRUE(AbortAfter(40, frames.Model, frames.MakeRequest(1)));
      }
    }
    Frames fresh({ 7, 7, 7 });
    fresh.Model.SetDisplacements(frames.Model.GetDisplacements());
    EXPECT_TRUE(AbortAfter(3, frames.Model, frames.MakeRequest(1)));
    frames.Solve(100, 101);
    fresh.Solve(100, 101);
    EXPECT_EQ(frames.Model.GetDisplacements(), fresh.Model.GetDisplacements());
  }
}

// An aborted construction of the multigrid hierarchy is repeated.
TEST(ElasticAborts, AbortedHierarchiesAreRebuilt)
{
  const ElasticBody body = MakeBody({ 7, 7, 8 });
  EquilibriumRequest request = MakeConverged();
  request.Loads.Gravity = glm::dvec3(0.0, -1.0, 0.0);
  // The first linear system builds the hierarchy.
  request.Limits.NewtonSteps = 1;
  request.Limits.LinearIterations = 1;
  FiniteElementModel fresh;
  fresh.SetBody(body);
  fresh.Solve(request);
  FiniteElementModel model;
  model.SetBody(body);
  int aborts = 0;
  for (int allowed = 0; AbortAfter(allowed, model, request); allowed += 1 + allowed / 3)
  {
    ++aborts;
    EXPECT_EQ(LargestOf(model.GetDisplacements()), 0.0);
  }
  EXPECT_GT(aborts, 10);
  EXPECT_EQ(model.GetDisplacements(), fresh.GetDisplacements());
}

TEST(ElasticAborts, AbortedSpringBodiesKeepTheLastBody)
{
  const Place nodes{ { 40 / Shrinking, 40 / Shrinking, 80 / Shrinking } };
  const ElasticBody body = LatticeBody(nodes, 0.01, MakeMaterial(1e4, 0.4)).Body;
  const ElasticBody softer = LatticeBody(nodes, 0.01, MakeMaterial(1e3, 0.4)).Body;
  MassSpringModel model;
  model.SetBody(body);
  const double step = model.GetStableTimeStep();
  const std::vector<float> displacements(body.Points.size() * 3, 1e-4F);
  model.SetState(displacements, displacements);
  // Aborted calls keep the last body.
  int aborts = 0;
  bool isAborted = true;
  for (int allowed = 0; isAborted; allowed += 1 + allowed / 3)
  {
    Questions questions;
    questions.Allowed = allowed;
    try
    {
      model.SetBody(softer, [&] { return questions.Ask(); });
      isAborted = false;
    }
    catch (const Aborted&)
    {
      ++aborts;
      EXPECT_EQ(model.GetDisplacements(), displacements);
      EXPECT_EQ(model.GetStableTimeStep(), step);
    }
    EXPECT_LT(questions.GetLongestPause(), LongestPause);
  }
  EXPECT_GT(aborts, 3);
  EXPECT_GT(model.GetStableTimeStep(), 2.0 * step);
}
