// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMassSpringState_h
#define DeformVolumeMassSpringState_h

#include "DeviceVectors.h"
#include "ElasticBody.h"
#include "MassSpringNetwork.h"
#include "MassSpringParameters.h"
#include "OutputVectors.h"
#include "WorkDevice.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace deformvolume
{

/// The nodes and tetrahedra of a MassSpringModel on the device, and the launches of its kernels.
class MassSpringState
{
public:
  /// device: must outlive this object.
  MassSpringState(WorkDevice& device, const MassSpringNetwork& network);

  /// The number of tetrahedra that a work-item of a device handles.
  static int GetLanes(WorkDevice& device);
  /// The memory that a body needs on the device, in bytes, without an output.
  static std::uint64_t GetNeededMemory(std::size_t nodes, std::size_t tetrahedra);
  std::uint64_t GetMemory() const;

  std::size_t GetNumberOfNodes() const { return this->NumberOfNodes; }

  void SetMobilities(const std::vector<float>& mobilities);
  void SetLoads(const std::vector<glm::dvec3>& forces);
  void SetHandles(const std::vector<MassSpringHandle>& handles);

  ///@{
  /// Three floats per node.
  std::vector<float> GetDisplacements() { return this->Read(this->Displacements); }
  std::vector<float> GetVelocities() { return this->Read(this->Velocities); }
  void SetDisplacements(const std::vector<float>& values);
  void SetVelocities(const std::vector<float>& values);
  ///@}

  /// Returns the forces of the tetrahedra on the nodes.
  std::vector<float> ComputeForces();

  /// Enqueues a step. fraction: the fraction of the way that handles have completed after it. rate:
  /// 1 / the duration of the whole way.
  void EnqueueStep(const MassSpringStep& step, float fraction, float rate);
  void Finish() { this->Device.GetQueue().finish(); }
  /// Returns whether a step since the last call of this function diverged.
  bool TakeDivergence();
  /// Returns the current number of inverted tetrahedra.
  std::int64_t CountInverted();

  ///@{
  /// Saves the displacements and velocities, and restores them.
  void Save();
  void Restore();
  ///@}

  ///@{
  /// Sets where the output goes, and the factor of the displacements.
  void SetOutput(float* output, float factor);
  void SetOutput(const std::shared_ptr<DeviceVectors>& output, float factor);
  ///@}
  bool HasOutput() const { return this->Output.IsSet(); }
  void WriteOutput();

private:
  std::vector<float> Read(const cl::Buffer& buffer);

  WorkDevice& Device;
  std::size_t NumberOfNodes;
  std::size_t NumberOfPackets;
  cl::Program Program;
  cl::Kernel ComputeForcesKernel, AddForcesKernel, MoveNodesKernel, MoveHandlesKernel,
    WriteOutputKernel, CountInvertedKernel;
  cl::Buffer Tetrahedra, Materials, RestPoints, Begins, ForceIndices, Mobilities;
  cl::Buffer Forces, Displacements, Velocities, Loads, Handles, HasDiverged, Inverted;
  cl::Buffer Sums, SavedDisplacements, SavedVelocities;
  std::size_t NumberOfHandles = 0;
  bool HasLoads = false;
  OutputVectors Output;
  float Factor = 1.0F;
};

} // namespace deformvolume

#endif
