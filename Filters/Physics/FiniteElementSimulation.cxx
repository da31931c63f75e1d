// SPDX-License-Identifier: BSD-3-Clause
#include "FiniteElementSimulation.h"

#include "VectorOutput.h"

#include <sstream>
#include <utility>

namespace deformvolume
{

void FiniteElementSimulation::SetBody(
  const ElasticBody& body, bool keepsState, const std::function<bool()>& progress)
{
  if (keepsState)
  {
    const std::vector<glm::dvec3> displacements = this->Model.GetStart();
    this->Model.SetBody(body, progress);
    this->Model.SetDisplacements(displacements);
    return;
  }
  this->Model.SetBody(body, progress);
  this->Report = this->Last = EquilibriumReport();
  this->HasWarnedOfResidual = false;
}

void FiniteElementSimulation::SplitNodes(
  const ElasticBody& body, const std::vector<std::int32_t>& origins)
{
  std::vector<glm::dvec3> displacements = this->Model.GetStart();
  for (const std::int32_t origin : origins)
  {
    displacements.push_back(displacements[static_cast<std::size_t>(origin)]);
  }
  this->Model.SetBody(body);
  this->Model.SetDisplacements(displacements);
}

void FiniteElementSimulation::Return(const ElasticBody& body, const State& state)
{
  this->Model.SetBody(body);
  this->Model.SetDisplacements(state.Displacements);
}

void FiniteElementSimulation::Advance(const Frame& frame)
{
  constexpr double someProgress = 0.5; // the number of steps is not known
  EquilibriumRequest request;
  request.Held = frame.Held;
  request.Loads = frame.Loads;
  request.Mode = this->Mode;
  request.Progress = [&] { return frame.Progress(someProgress); };
  this->Model.SetMaterialModel(this->Material);
  this->Report = this->Model.Solve(request);
  this->Warn(std::exchange(this->Last, this->Report));
}

void FiniteElementSimulation::Warn(const EquilibriumReport& last)
{
  const EquilibriumReport& now = this->Report;
  std::ostringstream text;
  if (now.NumberOfFrozenPieces != last.NumberOfFrozenPieces && now.NumberOfFrozenPieces > 0)
  {
    text << now.NumberOfFrozenPieces
         << " pieces of the mesh are not held. The tetrahedron with the points "
         << ListNodes(now.FrozenNodes)
         << " is in one of these pieces. A piece consists of tetrahedra that are connected by "
            "their faces. It is held by three nodes that do not lie on one line and are fixed, "
            "held by handles, or shared with a piece that is held, or by nodes that slide in "
            "planes of three directions. Pieces that are not held bear no load: "
         << now.NumberOfFollowingPieces
         << " of them follow nodes that they share or that are held, the others do not move. Fix "
            "nodes of these pieces, or connect the pieces by faces.";
    this->Warnings.push_back(text.str());
    text.str("");
  }
  // In interactive mode the residual decreases from update to update, so one warning is enough.
  const bool isInteractive = this->Mode == EquilibriumMode::Interactive;
  if (!now.IsConverged && !(isInteractive && this->HasWarnedOfResidual))
  {
    text << "The body is not in equilibrium after " << now.NewtonSteps
         << " steps: the largest residual force on a node is " << 100.0 * now.RelativeResidual
         << " % of the largest force that is applied to a node or holds it. "
         << (isInteractive
                ? "Further updates continue from there (Mode INTERACTIVE)."
                : "Check the units of loads and materials (N, Pa, and the unit "
                  "of length of the coordinates). Move handles and loads in smaller steps, or "
                  "make a better mesh.");
    this->Warnings.push_back(text.str());
    text.str("");
    this->HasWarnedOfResidual = true;
  }
  if (now.NumberOfInvertedTetrahedra > 0 &&
    (!isInteractive || last.NumberOfInvertedTetrahedra == 0))
  {
    text << now.NumberOfInvertedTetrahedra
         << " tetrahedra are inverted (inside out). Move handles and loads in smaller steps, or "
            "make a better mesh. If a body stays dented without loads, reset it.";
    this->Warnings.push_back(text.str());
  }
}

vtkDataArray* FiniteElementSimulation::WriteOutput(double factor)
{
  const std::vector<glm::dvec3>& displacements = this->Model.GetDisplacements();
  const auto nodes = static_cast<vtkIdType>(displacements.size());
  if (!this->Output || this->Output->GetNumberOfTuples() != nodes)
  {
    this->Output = MakeDisplacements(nodes);
  }
  float* value = this->Output->GetPointer(0);
  for (const glm::dvec3& displacement : displacements)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      *value++ = static_cast<float>(displacement[axis] * factor);
    }
  }
  return this->Output;
}

} // namespace deformvolume
