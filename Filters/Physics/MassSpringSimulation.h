// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeMassSpringSimulation_h
#define DeformVolumeMassSpringSimulation_h

#include "ElasticSimulation.h"
#include "MassSpringModel.h"
#include "VectorOutput.h"

#include <string>

namespace deformvolume
{

/// A MassSpringModel with its output array.
class MassSpringSimulation : public ElasticSimulation
{
public:
  void SetDevice(const std::string& device, std::uint64_t memoryLimit);
  const std::string& GetDevice() const { return this->Device; }

  /// The longest stable time step in s; 0 without a body.
  double GetStableTimeStep();

  double TimeStep = 0.0;
  double Damping = 2.0;
  /// The report of the last frame.
  MassSpringReport Report;

  void SetBody(
    const ElasticBody& body, bool keepsState, const std::function<bool()>& progress) override;
  void SplitNodes(const ElasticBody& body, const std::vector<std::int32_t>& origins) override;
  State GetState() override;
  void Return(const ElasticBody& body, const State& state) override;
  void Advance(const Frame& frame) override;
  void Reset() override
  {
    this->Model.Reset();
    this->HasInverted = false;
  }
  bool HasBody() const override { return this->Model.GetDeviceMemory() > 0; }
  std::vector<ElementResults> GetElementResults() override
  {
    return this->Model.GetElementResults();
  }
  vtkDataArray* WriteOutput(double factor) override;

private:
  MassSpringModel Model;
  bool HasInverted = false; // whether the last update ended with inverted tetrahedra
  std::string Device;
  std::size_t NumberOfNodes = 0;
  VectorOutput Output;
  double Factor = 0.0; // 0: the model has no output
};

} // namespace deformvolume

#endif
