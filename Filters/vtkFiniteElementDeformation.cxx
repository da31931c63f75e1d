// SPDX-License-Identifier: BSD-3-Clause
#include "vtkFiniteElementDeformation.h"

#include "FiniteElementSimulation.h"

#include "vtkObjectFactory.h"

#include <sstream>

vtkStandardNewMacro(vtkFiniteElementDeformation);

class vtkFiniteElementDeformation::vtkInternals
{
public:
  deformvolume::FiniteElementSimulation Simulation;
};

vtkFiniteElementDeformation::vtkFiniteElementDeformation()
  : Internals(new vtkInternals)
{
}

vtkFiniteElementDeformation::~vtkFiniteElementDeformation() = default;

deformvolume::ElasticSimulation& vtkFiniteElementDeformation::PrepareSimulation()
{
  this->Internals->Simulation.Mode = this->Mode == CONVERGED
    ? deformvolume::EquilibriumMode::Converged
    : deformvolume::EquilibriumMode::Interactive;
  this->Internals->Simulation.Material = this->MaterialModel == COROTATIONAL
    ? deformvolume::MaterialModel::Corotational
    : deformvolume::MaterialModel::StableNeoHookean;
  return this->Internals->Simulation;
}

void vtkFiniteElementDeformation::ClearReport()
{
  this->Internals->Simulation.Report = deformvolume::EquilibriumReport();
}

bool vtkFiniteElementDeformation::GetIsConverged()
{
  return this->Internals->Simulation.Report.IsConverged;
}

int vtkFiniteElementDeformation::GetNumberOfNewtonSteps()
{
  return this->Internals->Simulation.Report.NewtonSteps;
}

int vtkFiniteElementDeformation::GetNumberOfLinearIterations()
{
  return this->Internals->Simulation.Report.LinearIterations;
}

double vtkFiniteElementDeformation::GetResidual()
{
  return this->Internals->Simulation.Report.Residual;
}

double vtkFiniteElementDeformation::GetRelativeResidual()
{
  return this->Internals->Simulation.Report.RelativeResidual;
}

double vtkFiniteElementDeformation::GetStrainEnergy()
{
  return this->Internals->Simulation.Report.StrainEnergy;
}

vtkIdType vtkFiniteElementDeformation::GetNumberOfFrozenPieces()
{
  return this->Internals->Simulation.Report.NumberOfFrozenPieces;
}

vtkIdType vtkFiniteElementDeformation::GetNumberOfInvertedTetrahedra()
{
  return static_cast<vtkIdType>(this->Internals->Simulation.Report.NumberOfInvertedTetrahedra);
}

std::string vtkFiniteElementDeformation::GetSummary()
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

void vtkFiniteElementDeformation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaterialModel: "
     << (this->MaterialModel == COROTATIONAL ? "COROTATIONAL" : "STABLE_NEO_HOOKEAN") << "\n";
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
