// SPDX-License-Identifier: BSD-3-Clause
#include "Subject.h"

#include "../Reported.h"

#include <vtkExecutive.h>
#include <vtkObjectFactory.h>

namespace fuzz
{

void Messages::Execute(vtkObject*, unsigned long event, void* data)
{
  if (event == vtkCommand::ErrorEvent)
  {
    const std::string text = static_cast<const char*>(data);
    if (text.find("returned failure for request") != std::string::npos)
    {
      return; // an error of the executive, which follows an error of the filter
    }
    // Remove the file, the line and the address of the object from the text.
    const std::size_t start = text.find("): ");
    this->Errors.push_back(start == std::string::npos ? text : text.substr(start + 3));
  }
}

vtkStandardNewMacro(StrayMessages);

void StrayMessages::DisplayText(const char* text)
{
  this->Texts += text;
}

std::string StrayMessages::Take()
{
  std::string taken;
  taken.swap(this->Texts);
  return taken;
}

Subject::Subject()
{
  for (const unsigned long event : { vtkCommand::ErrorEvent, vtkCommand::WarningEvent })
  {
    this->Filter->AddObserver(event, this->Said);
    this->Filter->GetExecutive()->AddObserver(event, this->Said);
  }
}

Outcome Subject::Update(const int* part, const double* time)
{
  this->Said->Errors.clear();
  if (time)
  {
    this->Filter->UpdateTimeStep(*time, -1, 1, 0, part);
  }
  else if (part)
  {
    this->Filter->UpdateExtent(part);
  }
  else
  {
    this->Filter->UpdateWholeExtent();
  }
  Outcome outcome;
  outcome.Errors = this->Said->Errors;
  outcome.Output = vtkSmartPointer<vtkImageData>::New();
  outcome.Output->ShallowCopy(this->Filter->GetOutput());
  outcome.Covered = this->Filter->GetNumberOfCoveredVoxels();
  outcome.Inverted = this->Filter->GetNumberOfInvertedTetrahedra();
  outcome.Flat = this->Filter->GetNumberOfFlatTetrahedra();
  outcome.IsPart = GetReported(this->Filter, "Bricks resampled") <
    GetReported(this->Filter, "Bricks of the volume");
  outcome.Resampler = this->Filter->GetResamplerInUse();
  return outcome;
}

} // namespace fuzz
