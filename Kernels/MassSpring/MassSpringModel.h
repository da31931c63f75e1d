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

/// What MassSpringModel::Advance() is to do.
struct MassSpringRequest
{
  /// Time to go on by, in s; 0 or more.
  double Duration = 0.0;
  /// The longest time step, in s: as many equal steps are made as are needed. 0: three
  /// quarters of the stable one.
  double TimeStep = 0.0;
  /// How fast velocities die away, in 1/s; 0 or more.
  double Damping = 2.0;
  /// Nodes that handles move. They go in straight lines to where they are wanted, within the
  /// duration.
  std::vector<HeldNode> Held;
  /// Forces and gravity.
  BodyLoads Loads;
  /// Called now and then with how much of the duration is behind, 0 to 1; returning false aborts.
  std::function<bool(double)> Progress;
};

/// What MassSpringModel::Advance() has done.
struct MassSpringReport
{
  /// Time steps that were made.
  std::int64_t NumberOfSteps = 0;
  /// The time step that was used, in s.
  double TimeStep = 0.0;
  /// Tetrahedra that are inside out at the end. Springs may keep them so.
  std::int64_t NumberOfInvertedTetrahedra = 0;
};

/// Dynamics of an elastic body whose tetrahedra have springs for edges and an energy for their
/// volume, on an OpenCL device. Steps are explicit (Verlet), in single precision; forces are
/// exactly 0 at rest. Results depend neither on the size of work-groups nor on the number of
/// threads, to the last bit.
///
/// Order of calls: SetDevice, SetBody, SetOutput, then Advance, as often as wanted. SetBody forgets
/// everything that was set after it. Every failure is an Error; the body is then as it was, but for
/// failures of the device, after which SetBody has to be called again.
///
/// Memory on the device: 80 bytes a node and 88 a tetrahedron.
///
/// Sources: Teschner et al. 2004 for the energy of the volume; Georgii and Westermann 2005 for
/// gathering by nodes; Documents/physics.md for the stiffness of springs.
class DEFORMVOLUME_EXPORT MassSpringModel
{
public:
  /// Springs have at least this Poisson ratio; less counts as this.
  static constexpr double LeastPoissonRatio = 0.25;

  MassSpringModel();
  ~MassSpringModel();
  MassSpringModel(const MassSpringModel&) = delete;
  MassSpringModel& operator=(const MassSpringModel&) = delete;

  /// Chooses the device (see ResolveDevice) and returns its name. A change of device forgets all
  /// that was set.
  std::string SetDevice(const std::string& request);

  /// Bytes that may be used on the device; 0: what it has available.
  void SetMemoryLimit(std::uint64_t bytes);

  /// Work-items in a work-group; 0: chosen by device. To be called before SetBody.
  void SetWorkGroupSize(std::size_t size);

  /// A body at rest, all of whose tetrahedra are fifths of equal cubes (see FindCubeEdge).
  /// progress: called every few milliseconds, in the thread that called; returning false aborts,
  /// and the last body stays.
  void SetBody(const ElasticBody& body, const std::function<bool()>& progress = nullptr);

  /// The same body, in the same places, with other nodes in some tetrahedra: nodes have been
  /// appended, each a copy of one there was. origins: of each appended node. They are where their
  /// origins are, and as fast. Without origins the last nodes may be gone, as where a split is
  /// undone.
  void SplitNodes(const ElasticBody& body, const std::vector<std::int32_t>& origins);

  /// Where the displacements go, three floats a node, times a factor; written by each Advance.
  ///@{
  void SetOutput(float* output, double factor = 1.0);
  void SetOutput(const std::shared_ptr<DeviceVectors>& output, double factor = 1.0);
  ///@}

  /// A time step, in s, with which the body is stable near rest: h sqrt(rho / 6 lambda), for the
  /// least of its materials. The longest one is up to 1.6 times that.
  double GetStableTimeStep() const;

  /// Goes on in time. Where the simulation diverges, the body is put back to what it was, and an
  /// Error says so. Throws Aborted where the progress asks for an end; the body is put back, too.
  MassSpringReport Advance(const MassSpringRequest& request);

  /// Puts the body to rest.
  void Reset();

  /// Displacements, in m, or velocities, in m/s, of the nodes, three floats each.
  ///@{
  std::vector<float> GetDisplacements();
  std::vector<float> GetVelocities();
  void SetState(const std::vector<float>& displacements, const std::vector<float>& velocities);
  ///@}

  /// The forces of springs and volumes on the nodes where these are now, in N, three floats each.
  std::vector<float> GetForces();

  /// What the tetrahedra undergo now.
  std::vector<ElementResults> GetElementResults();

  /// Bytes allocated on the device, without the output.
  std::uint64_t GetDeviceMemory() const;

private:
  class DEFORMVOLUME_NO_EXPORT Internals;
  std::unique_ptr<Internals> Impl;
};

} // namespace deformvolume

#endif
