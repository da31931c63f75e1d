// SPDX-License-Identifier: BSD-3-Clause
#include "FiniteElementModel.h"

#include "EquilibriumSolver.h"
#include "IndexBounds.h"

#include <algorithm>
#include <string>
#include <utility>

namespace deformvolume
{

class FiniteElementModel::Internals
{
public:
  EquilibriumSolver& GetSolver()
  {
    if (!this->Solver)
    {
      throw Error("There is no body. Call SetBody first.");
    }
    return *this->Solver;
  }

  std::unique_ptr<EquilibriumSolver> Solver;
  MaterialModel Model = MaterialModel::StableNeoHookean;
};

FiniteElementModel::FiniteElementModel()
  : Impl(std::make_unique<Internals>())
{
}

FiniteElementModel::~FiniteElementModel() = default;

void FiniteElementModel::SetBody(const ElasticBody& body, const std::function<bool()>& progress)
{
  AbortCheck abortCheck(progress);
  abortCheck.Check();
  CheckBody(body, &abortCheck);
  if (body.MidSides.empty())
  {
    throw Error("The tetrahedra of the body have no mid-side nodes. Call AddMidSideNodes first.");
  }
  auto solver = std::make_unique<EquilibriumSolver>(abortCheck, body);
  solver->SetMaterialModel(this->Impl->Model);
  this->Impl->Solver = std::move(solver);
}

void FiniteElementModel::SetMaterialModel(MaterialModel model)
{
  this->Impl->Model = model;
  if (this->Impl->Solver)
  {
    this->Impl->Solver->SetMaterialModel(model);
  }
}

void FiniteElementModel::SetMaterials(const std::vector<ElasticMaterial>& materials)
{
  EquilibriumSolver& solver = this->Impl->GetSolver();
  CheckMaterials(solver.GetBody(), materials);
  solver.SetMaterials(materials);
}

EquilibriumReport FiniteElementModel::Solve(const EquilibriumRequest& request)
{
  return this->Impl->GetSolver().Solve(request);
}

void FiniteElementModel::Reset()
{
  EquilibriumSolver& solver = this->Impl->GetSolver();
  solver.SetDisplacements(std::vector<glm::dvec3>(solver.GetBody().Points.size(), glm::dvec3(0.0)));
}

const std::vector<glm::dvec3>& FiniteElementModel::GetDisplacements() const
{
  return this->Impl->GetSolver().GetDisplacements();
}

std::vector<glm::dvec3> FiniteElementModel::GetStart() const
{
  return this->Impl->GetSolver().GetStart();
}

void FiniteElementModel::SetDisplacements(const std::vector<glm::dvec3>& displacements)
{
  EquilibriumSolver& solver = this->Impl->GetSolver();
  const std::size_t nodes = solver.GetBody().Points.size();
  if (displacements.size() != nodes)
  {
    throw Error("There are " + std::to_string(displacements.size()) + " displacements, but " +
      std::to_string(nodes) + " are needed.");
  }
  const auto bad = std::find_if_not(displacements.begin(), displacements.end(), IsFinite);
  if (bad != displacements.end())
  {
    throw Error("The displacement of node " + std::to_string(bad - displacements.begin()) +
      " is not finite.");
  }
  solver.SetDisplacements(displacements);
}

std::vector<glm::dvec3> FiniteElementModel::GetForces() const
{
  return this->Impl->GetSolver().GetForces();
}

const std::vector<glm::dvec3>& FiniteElementModel::GetReactions() const
{
  return this->Impl->GetSolver().GetReactions();
}

std::vector<ElementResults> FiniteElementModel::GetElementResults() const
{
  return this->Impl->GetSolver().GetElementResults();
}

} // namespace deformvolume
