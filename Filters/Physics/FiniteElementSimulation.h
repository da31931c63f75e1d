// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeFiniteElementSimulation_h
#define DeformVolumeFiniteElementSimulation_h

#include "ElasticSimulation.h"
#include "FiniteElementModel.h"

#include "vtkFloatArray.h"
#include "vtkSmartPointer.h"

namespace deformvolume
{

/// A FiniteElementModel with its output array.
class FiniteElementSimulation : public ElasticSimulation
{
public:
  EquilibriumMode Mode = EquilibriumMode::Interactive;
  MaterialModel Material = MaterialModel::StableNeoHookean;
  /// The report of the last frame.
  EquilibriumReport Report;

  void SetBody(
    const ElasticBody& body, bool keepsState, const std::function<bool()>& progress) override;
  void SplitNodes(const ElasticBody& body, const std::vector<std::int32_t>& origins) override;
  State GetState() override { return { this->Model.GetStart(), {} }; }
  void Return(const ElasticBody& body, const State& state) override;
  void Advance(const Frame& frame) override;
  bool HasFrames() const override { return false; }
  bool IsQuadratic() const override { return true; }
  void Reset() override { this->Model.Reset(); }
  bool HasBody() const override { return !this->Model.GetDisplacements().empty(); }
  std::vector<ElementResults> GetElementResults() override
  {
    return this->Model.GetElementResults();
  }
  std::vector<glm::dvec3> GetReactions() override { return this->Model.GetReactions(); }
  vtkDataArray* WriteOutput(double factor) override;

private:
  void Warn(const EquilibriumReport& last);

  FiniteElementModel Model;
  EquilibriumReport Last; // the last report, also after an error: warnings are given once
  bool HasWarnedOfResidual = false;
  vtkSmartPointer<vtkFloatArray> Output;
};

} // namespace deformvolume

#endif
