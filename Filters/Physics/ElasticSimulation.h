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

/// What makes a body move, behind the interface that vtkElasticDeformation has to it. Throws Error
/// and Aborted; what was simulated is then as it was.
class ElasticSimulation
{
public:
  virtual ~ElasticSimulation() = default;

  /// Whether the body is one of ten-node tetrahedra.
  virtual bool IsQuadratic() const { return false; }

  /// Where the body goes in a frame.
  struct Frame
  {
    double Duration = 0.0; // in s
    std::vector<HeldNode> Held;
    BodyLoads Loads;
    std::function<bool(double)> Progress; // from 0 to 1; false: it is to end
  };

  /// A body: at rest, or with the displacements of the last one, which had the same mesh. progress:
  /// false: it is to end. Then there is the last body, or none (HasBody).
  virtual void SetBody(
    const ElasticBody& body, bool keepsState, const std::function<bool()>& progress) = 0;
  /// Nodes of the body have been copied, see MassSpringModel::SplitNodes.
  virtual void SplitNodes(const ElasticBody& body, const std::vector<std::int32_t>& origins) = 0;
  /// Where the nodes are, in m, and how fast, in m/s, where there are velocities.
  struct State
  {
    std::vector<glm::dvec3> Displacements;
    std::vector<glm::dvec3> Velocities;
  };
  virtual State GetState() = 0;
  /// A body as it was before nodes were split.
  virtual void Return(const ElasticBody& body, const State& state) = 0;
  virtual void Advance(const Frame& frame) = 0;
  /// Whether a longer time takes several frames.
  virtual bool HasFrames() const { return true; }
  virtual void Reset() = 0;
  /// False at first, and where a device has failed.
  virtual bool HasBody() const = 0;
  virtual std::vector<ElementResults> GetElementResults() = 0;
  /// The displacements, times a factor, in the array that is always the same for a number of nodes.
  virtual vtkDataArray* WriteOutput(double factor) = 0;

  /// What is to be warned of since the last call.
  std::vector<std::string> TakeWarnings() { return std::exchange(this->Warnings, {}); }

protected:
  std::vector<std::string> Warnings;
};

} // namespace deformvolume

#endif
