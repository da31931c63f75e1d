// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMassSpringModel_h
#define DeformVolumeMassSpringModel_h

#include "DeformVolumeExport.h"
#include "DeviceVectors.h"
#include "ElasticBody.h"
#include "ElementResults.h"
#include "Error.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace deformvolume
{

/// The input of MassSpringModel::Advance().
struct MassSpringRequest
{
  /// The simulated time, in s; 0 or more.
  double Duration = 0.0;
  /// The longest time step, in s. The duration is divided into equal steps that are not longer. 0:
  /// three quarters of GetStableTimeStep().
  double TimeStep = 0.0;
  /// The rate at which velocities decay, in 1/s; 0 or more. Default: 2.
  double Damping = 2.0;
  /// Nodes that handles move. They move on straight lines, and reach their displacement at the end
  /// of the duration.
  std::vector<HeldNode> Held;
  /// Forces and gravity.
  BodyLoads Loads;
  /// Called repeatedly with the completed fraction of the duration, 0 to 1. Return false to abort.
  std::function<bool(double)> Progress;
};

/// The output of MassSpringModel::Advance().
struct MassSpringReport
{
  /// The number of time steps.
  std::int64_t NumberOfSteps = 0;
  /// The time step that was used, in s.
  double TimeStep = 0.0;
  /// The number of inverted tetrahedra at the end. Springs can stay inverted.
  std::int64_t NumberOfInvertedTetrahedra = 0;
};

/// Simulates the dynamics of an elastic body on an OpenCL device. The edges of its tetrahedra are
/// springs, and the change of the volume of a tetrahedron has an energy. Time steps are explicit
/// (Verlet, in leapfrog form), in single precision. Forces are exactly 0 at rest. Results are bit
/// for bit the same for any size of work-groups and any number of threads.
///
/// Call SetDevice, SetBody and SetOutput, then Advance any number of times. SetBody discards the
/// output and all displacements and velocities. Every failure throws an Error. The body is then
/// unchanged, except after failures of the device, which require a new call of SetBody.
///
/// Memory on the device: 80 bytes per node and 88 per tetrahedron.
///
/// Sources: Teschner et al. 2004 for the energy of the volume; Georgii and Westermann 2005 for
/// adding forces by nodes; Documents/physics.md for the stiffness of springs.
class DEFORMVOLUME_EXPORT MassSpringModel
{
public:
  /// The least Poisson ratio of springs. Materials with a smaller ratio are simulated with this
  /// ratio.
  static constexpr double LeastPoissonRatio = 0.25;

  MassSpringModel();
  ~MassSpringModel();
  MassSpringModel(const MassSpringModel&) = delete;
  MassSpringModel& operator=(const MassSpringModel&) = delete;

  /// Sets the device (see ResolveDevice) and returns its name. A change of device discards the body
  /// and the output.
  std::string SetDevice(const std::string& request);

  /// Set the memory that may be used on the device, in bytes. Default 0: all that is available.
  void SetMemoryLimit(std::uint64_t bytes);

  /// Set the number of work-items in a work-group. Default 0: chosen for the device.
  void SetWorkGroupSize(std::size_t size);

  /// Sets the body at rest. Its tetrahedra must be the five tetrahedra of equal cubes (see
  /// FindCubeEdge). progress: called every few milliseconds in the calling thread; return false to
  /// abort. After an abort the previous body is kept.
  void SetBody(const ElasticBody& body, const std::function<bool()>& progress = nullptr);

  /// Changes the nodes of some tetrahedra after a cut. body: the same tetrahedra and rest positions
  /// as before, and appended nodes that are copies of old nodes. origins: the old node of each
  /// appended node; the appended node gets its displacement and velocity. If origins is empty, the
  /// body may have fewer nodes than before, for example when a split is undone.
  void SplitNodes(const ElasticBody& body, const std::vector<std::int32_t>& origins);

  /// Sets where Advance writes the displacements: three floats per node, multiplied by a factor.
  ///@{
  void SetOutput(float* output, double factor = 1.0);
  void SetOutput(const std::shared_ptr<DeviceVectors>& output, double factor = 1.0);
  ///@}

  /// Returns a time step, in s, with which the body is stable near rest: h sqrt(rho / 6 lambda),
  /// the least value of all materials. The longest stable time step is at most 1.6 times this
  /// value.
  double GetStableTimeStep() const;

  /// Advances the simulation. If it diverges, the previous state is restored, and an Error is
  /// thrown. If Progress returns false, the previous state is restored, and Aborted is thrown.
  MassSpringReport Advance(const MassSpringRequest& request);

  /// Sets all displacements and velocities to 0.
  void Reset();

  /// Get the displacements, in m, or the velocities, in m/s: three floats per node. SetState sets
  /// both.
  ///@{
  std::vector<float> GetDisplacements();
  std::vector<float> GetVelocities();
  void SetState(const std::vector<float>& displacements, const std::vector<float>& velocities);
  ///@}

  /// Returns the current forces of springs and volumes on the nodes, in N: three floats per node.
  std::vector<float> GetForces();

  /// Returns the current stress and deformation of each tetrahedron.
  std::vector<ElementResults> GetElementResults();

  /// Returns the memory allocated on the device, in bytes, without the output.
  std::uint64_t GetDeviceMemory() const;

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
