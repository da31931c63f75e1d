// SPDX-License-Identifier: BSD-3-Clause
#include "vtkCarveVolume.h"

#include "vtkCarveVolumeInternals.h"

#include "vtkImplicitFunction.h"
#include "vtkObjectFactory.h"

#include <algorithm>

vtkStandardNewMacro(vtkCarveVolume);
vtkCxxSetObjectMacro(vtkCarveVolume, ImplicitFunction, vtkImplicitFunction);

//------------------------------------------------------------------------------
vtkCarveVolume::vtkCarveVolume()
  : Internals(new vtkInternals(this))
{
}

//------------------------------------------------------------------------------
vtkCarveVolume::~vtkCarveVolume()
{
  this->SetImplicitFunction(nullptr);
}

//------------------------------------------------------------------------------
vtkMTimeType vtkCarveVolume::GetMTime()
{
  const vtkMTimeType time = this->Superclass::GetMTime();
  return this->ImplicitFunction ? std::max(time, this->ImplicitFunction->GetMTime()) : time;
}

//------------------------------------------------------------------------------
void vtkCarveVolume::AddToolPosition(double x, double y, double z)
{
  const glm::dvec3 center(x, y, z);
  this->Edits->Tool.Add({ { center, center } });
  this->Modified();
}

//------------------------------------------------------------------------------
void vtkCarveVolume::UpdateEdits(vtkInformationVector** input)
{
  this->Internals->Execute(input);
}

//------------------------------------------------------------------------------
void vtkCarveVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ImplicitFunction: " << this->ImplicitFunction << "\n";
  os << indent << "LabelArrayName: \"" << this->LabelArrayName << "\"\n";
  os << indent << "Label: " << this->Label << "\n";
  os << indent << "Rule: " << this->Rule << "\n";
  os << indent << "SmoothBoundary: " << (this->SmoothBoundary ? "on" : "off") << "\n";
  os << indent << "ToolRadius: " << this->ToolRadius << "\n";
}
