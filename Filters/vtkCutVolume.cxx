// SPDX-License-Identifier: BSD-3-Clause
#include "vtkCutVolume.h"

#include "vtkVolumeEditAlgorithmInternals.h"

#include "PipelineGeometry.h"
#include "SheetReading.h"

#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <glm/gtc/type_ptr.hpp>

#include <cstdint>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkCutVolume);

//------------------------------------------------------------------------------
class vtkCutVolume::vtkInternals
{
public:
  deformvolume::WorldSheet Sheet; // the sheet of the last update
  std::uint64_t SheetEdit = 0;
  bool IsSmooth = false; // SmoothCut at the last update
};

//------------------------------------------------------------------------------
vtkCutVolume::vtkCutVolume()
  : Internals(new vtkInternals)
{
}

//------------------------------------------------------------------------------
vtkCutVolume::~vtkCutVolume() = default;

//------------------------------------------------------------------------------
void vtkCutVolume::AddToolPosition(double x0, double y0, double z0, double x1, double y1, double z1)
{
  this->Edits->Tool.Add({ { glm::dvec3(x0, y0, z0), glm::dvec3(x1, y1, z1) } });
  this->Modified();
}

//------------------------------------------------------------------------------
vtkIdType vtkCutVolume::GetNumberOfDividedTetrahedra()
{
  return this->Edits->Editor.GetNumberOfDividedTetrahedra();
}

//------------------------------------------------------------------------------
void vtkCutVolume::UpdateEdits(vtkInformationVector** input)
{
  vtkInternals& last = *this->Internals;
  deformvolume::VolumeEditor& editor = this->Edits->Editor;
  if (this->Edits->SetVolume(input))
  {
    last = vtkInternals();
  }
  deformvolume::WorldSheet sheet = deformvolume::ReadSheet(
    vtkPolyData::GetData(input[1]), glm::make_vec3(this->SweepVector), "sheet");
  const bool isNew =
    !(sheet == last.Sheet) || (this->SmoothCut != last.IsSmooth && !sheet.IsEmpty());
  const std::vector<deformvolume::ToolPath::Position> positions = this->Edits->Tool.GetStroke();
  deformvolume::WorldSheet stroke;
  for (std::size_t i = 1; i < positions.size(); ++i)
  {
    stroke.AddSweep(positions[i - 1][0], positions[i - 1][1], positions[i][0], positions[i][1]);
  }
  deformvolume::EditFinder finder = this->Edits->MakeFinder(input);
  finder.IsSmooth = this->SmoothCut;
  deformvolume::VolumeEdit bySheet;
  deformvolume::VolumeEdit byTool;
  if (isNew && !sheet.IsEmpty())
  {
    bySheet = finder.Cut(sheet);
  }
  if (!stroke.IsEmpty())
  {
    byTool = finder.Cut(stroke);
  }

  if (isNew && !sheet.IsEmpty())
  {
    editor.Put(last.SheetEdit, std::move(bySheet), this->Accumulate);
  }
  else if (isNew && !this->Accumulate)
  {
    editor.Drop(last.SheetEdit);
  }
  last.Sheet = std::move(sheet);
  last.IsSmooth = this->SmoothCut;
  if (!stroke.IsEmpty())
  {
    std::uint64_t edit = 0;
    editor.Put(edit, std::move(byTool), true);
  }
}

//------------------------------------------------------------------------------
void vtkCutVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SweepVector: " << this->SweepVector[0] << " " << this->SweepVector[1] << " "
     << this->SweepVector[2] << "\n";
  os << indent << "SmoothCut: " << (this->SmoothCut ? "on" : "off") << "\n";
  os << indent << "NumberOfDividedTetrahedra: " << this->GetNumberOfDividedTetrahedra() << "\n";
}
