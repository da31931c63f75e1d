// SPDX-License-Identifier: BSD-3-Clause
#include "CorotationalModel.h"

#include "CorotationalSolver.h"
#include "IndexBounds.h"

#include <algorithm>
#include <string>

namespace deformvolume
{

class CorotationalModel::Internals
{
public:
  CorotationalSolver& GetSolver()
  {
    if (!this->Solver)
    {
      throw Error("There is no body. Call SetBody first.");
    }
    return *this->Solver;
  }

  std::unique_ptr<CorotationalSolver> Solver;
};

CorotationalModel::CorotationalModel()
  : Impl(std::make_unique<Internals>())
{
}

CorotationalModel::~CorotationalModel() = default;

void CorotationalModel::SetBody(const ElasticBody& body, const std::function<bool()>& progress)
{
  Watch watch(progress);
  watch.Ask();
  CheckBody(body, &watch);
  this->Impl->Solver = std::make_unique<CorotationalSolver>(watch, body);
}

void CorotationalModel::SetMaterials(const std::vector<ElasticMaterial>& materials)
{
  CorotationalSolver& solver = this->Impl->GetSolver();
  CheckMaterials(solver.GetBody(), materials);
  solver.SetMaterials(materials);
}

CorotationalReport CorotationalModel::Solve(const CorotationalRequest& request)
{
  return this->Impl->GetSolver().Solve(request);
}

void CorotationalModel::Reset()
{
  CorotationalSolver& solver = this->Impl->GetSolver();
  solver.SetDisplacements(std::vector<glm::dvec3>(solver.GetBody().Points.size(), glm::dvec3(0.0)));
}

const std::vector<glm::dvec3>& CorotationalModel::GetDisplacements() const
{
  return this->Impl->GetSolver().GetDisplacements();
}

void CorotationalModel::SetDisplacements(const std::vector<glm::dvec3>& displacements)
{
  CorotationalSolver& solver = this->Impl->GetSolver();
  const std::size_t nodes = solver.GetBody().Points.size();
  if (displacements.size() != nodes)
  {
    throw Error("There are " + std::to_string(displacements.size()) + " displacements, but " +
      std::to_string(nodes) + " are needed.");
  }
  for (const glm::dvec3& vector : displacements)
  {
    if (!IsFinite(vector))
    {
      throw Error("A displacement is not finite.");
    }
  }
  solver.SetDisplacements(displacements);
}

std::vector<glm::dvec3> CorotationalModel::GetForces() const
{
  return this->Impl->GetSolver().GetForces();
}

std::vector<ElementResults> CorotationalModel::GetElementResults() const
{
  return this->Impl->GetSolver().GetElementResults();
}

} // namespace deformvolume
