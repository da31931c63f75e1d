// SPDX-License-Identifier: BSD-3-Clause
#include "vtkCorotationalDeformation.h"

#include "CorotationalSimulation.h"

#include "vtkObjectFactory.h"

#include <sstream>

vtkStandardNewMacro(vtkCorotationalDeformation);

class vtkCorotationalDeformation::vtkInternals
{
public:
  deformvolume::CorotationalSimulation Simulation;
};

vtkCorotationalDeformation::vtkCorotationalDeformation()
  : Internals(new vtkInternals)
{
}

vtkCorotationalDeformation::~vtkCorotationalDeformation() = default;

deformvolume::ElasticSimulation& vtkCorotationalDeformation::PrepareSimulation()
{
  this->Internals->Simulation.Mode = this->Mode == CONVERGED
    ? deformvolume::CorotationalMode::Converged
    : deformvolume::CorotationalMode::Interactive;
  return this->Internals->Simulation;
}

bool vtkCorotationalDeformation::GetIsConverged()
{
  return this->Internals->Simulation.Report.IsConverged;
}

int vtkCorotationalDeformation::GetNumberOfNewtonSteps()
{
  return this->Internals->Simulation.Report.NewtonSteps;
}

int vtkCorotationalDeformation::GetNumberOfLinearIterations()
{
  return this->Internals->Simulation.Report.LinearIterations;
}

double vtkCorotationalDeformation::GetResidual()
{
  return this->Internals->Simulation.Report.Residual;
}

double vtkCorotationalDeformation::GetRelativeResidual()
{
  return this->Internals->Simulation.Report.RelativeResidual;
}

double vtkCorotationalDeformation::GetStrainEnergy()
{
  return this->Internals->Simulation.Report.StrainEnergy;
}

vtkIdType vtkCorotationalDeformation::GetNumberOfFrozenPieces()
{
  return this->Internals->Simulation.Report.NumberOfFrozenPieces;
}

vtkIdType vtkCorotationalDeformation::GetNumberOfInvertedTetrahedra()
{
  return static_cast<vtkIdType>(this->Internals->Simulation.Report.NumberOfInvertedTetrahedra);
}

std::string vtkCorotationalDeformation::GetSummary()
{
  std::string text = this->Superclass::GetSummary();
  if (!text.empty())
  {
    std::ostringstream more;
    more << "\nSteps of Newton's method: " << this->GetNumberOfNewtonSteps() << "\n"
         << "Iterations of conjugate gradients: " << this->GetNumberOfLinearIterations() << "\n"
         << "Relative residual: " << this->GetRelativeResidual()
         << (this->GetIsConverged() ? ", in equilibrium" : ", not yet in equilibrium") << "\n"
         << "Strain energy: " << this->GetStrainEnergy() << " J";
    if (this->GetNumberOfFrozenPieces() > 0)
    {
      more << "\nPieces that nothing holds: " << this->GetNumberOfFrozenPieces();
    }
    if (this->GetNumberOfInvertedTetrahedra() > 0)
    {
      more << "\nTetrahedra inside out: " << this->GetNumberOfInvertedTetrahedra();
    }
    text += more.str();
  }
  return text;
}

void vtkCorotationalDeformation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Mode: " << (this->Mode == CONVERGED ? "CONVERGED" : "INTERACTIVE") << "\n";
  os << indent << "IsConverged: " << (this->GetIsConverged() ? "yes" : "no") << "\n";
  os << indent << "NumberOfNewtonSteps: " << this->GetNumberOfNewtonSteps() << "\n";
  os << indent << "NumberOfLinearIterations: " << this->GetNumberOfLinearIterations() << "\n";
  os << indent << "Residual: " << this->GetResidual() << "\n";
  os << indent << "RelativeResidual: " << this->GetRelativeResidual() << "\n";
  os << indent << "StrainEnergy: " << this->GetStrainEnergy() << "\n";
  os << indent << "NumberOfFrozenPieces: " << this->GetNumberOfFrozenPieces() << "\n";
  os << indent << "NumberOfInvertedTetrahedra: " << this->GetNumberOfInvertedTetrahedra() << "\n";
}
