// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeElasticSimulation_h
#define DeformVolumeElasticSimulation_h

#include "ElasticBody.h"
#include "ElementResults.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

class vtkDataArray;

namespace deformvolume
{

/// Interface of the simulations that vtkElasticDeformation uses. Functions throw Error and Aborted.
/// The simulated state does not change then.
class ElasticSimulation
{
public:
  virtual ~ElasticSimulation() = default;

  /// Whether the body has ten-node tetrahedra.
  virtual bool IsQuadratic() const { return false; }

  /// Duration, constraints and loads of a frame.
  struct Frame
  {
    double Duration = 0.0; // in s
    bool IsLast = true;    // of the frames of an update: it gives the warnings about its result
    std::vector<HeldNode> Held;
    BodyLoads Loads;
    std::function<bool(double)> Progress; // gets 0 to 1; returns false to abort
  };

  /// Sets a body. keepsState: whether the body has the state of the last one, which had the same
  /// mesh; otherwise it is at rest. progress: returns false to abort. After an abort, the
  /// simulation has the last body, or none (HasBody()).
  virtual void SetBody(
    const ElasticBody& body, bool keepsState, const std::function<bool()>& progress) = 0;
  /// Sets the body after nodes have been copied, see MassSpringModel::SplitNodes().
  virtual void SplitNodes(const ElasticBody& body, const std::vector<std::int32_t>& origins) = 0;
  /// Displacements of the nodes in m, and velocities in m/s if the simulation has them.
  struct State
  {
    std::vector<glm::dvec3> Displacements;
    std::vector<glm::dvec3> Velocities;
  };
  /// Returns the state from which the next frame starts.
  virtual State GetState() = 0;
  /// Restores a body and its state from before nodes were split.
  virtual void Return(const ElasticBody& body, const State& state) = 0;
  virtual void Advance(const Frame& frame) = 0;
  /// Whether longer times are divided into frames.
  virtual bool HasFrames() const { return true; }
  virtual void Reset() = 0;
  /// False at first, and after a device has failed.
  virtual bool HasBody() const = 0;
  virtual std::vector<ElementResults> GetElementResults() = 0;
  /// Returns the force of the support on each node in the last frame, in N; empty: unknown.
  virtual std::vector<glm::dvec3> GetReactions() { return {}; }
  /// Writes the displacements times a factor. The array is the same object until the number of
  /// nodes changes.
  virtual vtkDataArray* WriteOutput(double factor) = 0;

  /// Returns the warnings since the last call.
  std::vector<std::string> TakeWarnings() { return std::exchange(this->Warnings, {}); }

protected:
  std::vector<std::string> Warnings;
};

} // namespace deformvolume

#endif
