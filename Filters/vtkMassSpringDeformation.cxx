// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMassSpringDeformation.h"

#include "MassSpringSimulation.h"

#include "vtkObjectFactory.h"

#include <sstream>

vtkStandardNewMacro(vtkMassSpringDeformation);

class vtkMassSpringDeformation::vtkInternals
{
public:
  // Replaced if the device changes, which loses the simulated state.
  std::unique_ptr<deformvolume::MassSpringSimulation> Simulation =
    std::make_unique<deformvolume::MassSpringSimulation>();
};

vtkMassSpringDeformation::vtkMassSpringDeformation()
  : Internals(new vtkInternals)
{
}

vtkMassSpringDeformation::~vtkMassSpringDeformation() = default;

deformvolume::ElasticSimulation& vtkMassSpringDeformation::PrepareSimulation()
{
  auto& simulation = this->Internals->Simulation;
  const std::string before = simulation->GetDevice();
  simulation->SetDevice(this->Device, static_cast<std::uint64_t>(this->MemoryLimit));
  if (!before.empty() && simulation->GetDevice() != before)
  {
    auto other = std::make_unique<deformvolume::MassSpringSimulation>();
    other->SetDevice(this->Device, static_cast<std::uint64_t>(this->MemoryLimit));
    simulation.swap(other);
  }
  simulation->TimeStep = this->TimeStep;
  simulation->Damping = this->Damping;
  return *simulation;
}

void vtkMassSpringDeformation::ClearReport()
{
  this->Internals->Simulation->Report = deformvolume::MassSpringReport();
}

double vtkMassSpringDeformation::GetStableTimeStep()
{
  return this->Internals->Simulation->GetStableTimeStep();
}

vtkIdType vtkMassSpringDeformation::GetNumberOfSteps()
{
  return this->Internals->Simulation->Report.NumberOfSteps;
}

double vtkMassSpringDeformation::GetTimeStepInUse()
{
  return this->Internals->Simulation->Report.TimeStep;
}

vtkIdType vtkMassSpringDeformation::GetNumberOfInvertedTetrahedra()
{
  return static_cast<vtkIdType>(this->Internals->Simulation->Report.NumberOfInvertedTetrahedra);
}

std::string vtkMassSpringDeformation::GetDeviceInUse()
{
  return this->Internals->Simulation->GetDevice();
}

std::string vtkMassSpringDeformation::GetSummary()
{
  std::string text = this->Superclass::GetSummary();
  if (!text.empty())
  {
    std::ostringstream more;
    more << "\nDevice: " << this->GetDeviceInUse() << "\n"
         << "Steps of a frame: " << this->GetNumberOfSteps() << "\n"
         << "Time step: " << this->GetTimeStepInUse() * 1e3 << " ms\n"
         << "Stable time step: " << this->GetStableTimeStep() * 1e3 << " ms";
    if (this->GetNumberOfInvertedTetrahedra() > 0)
    {
      more << "\nTetrahedra inside out: " << this->GetNumberOfInvertedTetrahedra();
    }
    text += more.str();
  }
  return text;
}

void vtkMassSpringDeformation::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "TimeStep: " << this->TimeStep << "\n";
  os << indent << "Damping: " << this->Damping << "\n";
  os << indent << "Device: " << this->Device << "\n";
  os << indent << "MemoryLimit: " << this->MemoryLimit << "\n";
  os << indent << "DeviceInUse: " << this->GetDeviceInUse() << "\n";
  os << indent << "NumberOfSteps: " << this->GetNumberOfSteps() << "\n";
  os << indent << "TimeStepInUse: " << this->GetTimeStepInUse() << "\n";
  os << indent << "NumberOfInvertedTetrahedra: " << this->GetNumberOfInvertedTetrahedra() << "\n";
  os << indent << "StableTimeStep: " << this->GetStableTimeStep() << "\n";
}
