// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMaterialFromVolume.h"

#include "BodyReading.h"
#include "DeformationMesh.h"
#include "Error.h"
#include "InputUpdate.h"
#include "MaskArray.h"
#include "MaterialPresets.h"
#include "MaterialTable.h"
#include "PieceRequest.h"
#include "PipelineExecution.h"
#include "PipelineGeometry.h"
#include "ProgressReport.h"
#include "VTKThreads.h"
#include "VolumeMaterials.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkElasticDeformation.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <vector>

vtkStandardNewMacro(vtkMaterialFromVolume);

using deformvolume::ElasticMaterial;

class vtkMaterialFromVolume::vtkInternals
{
public:
  // Returns Table, in which materials of presets replace those of SetMaterial().
  deformvolume::MaterialTable<ElasticMaterial> GetTable() const
  {
    deformvolume::MaterialTable<ElasticMaterial> table = this->Table;
    for (std::size_t i = 0; i < this->Presets.size(); ++i)
    {
      if (const auto* preset = deformvolume::FindMaterialPreset(this->Presets[i]))
      {
        table.Materials[i] = preset->Material;
        table.Exists[i] = true;
      }
    }
    return table;
  }

  deformvolume::MaterialTable<ElasticMaterial> Table; // without the presets
  std::array<int, 256> Presets{};                     // for all indices; CUSTOM: no preset
  deformvolume::PipelineExecution Execution;
};

vtkMaterialFromVolume::vtkMaterialFromVolume()
  : Internals(new vtkInternals)
{
  deformvolume::UseVTKThreads();
  this->SetNumberOfInputPorts(2);
  constexpr double defaults[5][3] = { { 100.0, 0.0, 100.0 }, { 1e4, 0.3, 1000.0 },
    { 5e4, 0.4, 1060.0 }, { 1e6, 0.4, 1100.0 }, { 1e7, 0.3, 1900.0 } };
  for (int i = 0; i < 5; ++i)
  {
    this->SetMaterial(i, defaults[i][0], defaults[i][1], defaults[i][2]);
  }
}

vtkMaterialFromVolume::~vtkMaterialFromVolume() = default;

void vtkMaterialFromVolume::SetMaterial(
  double index, double youngModulus, double poissonRatio, double density)
{
  this->Internals->Table.Set(this, index, { youngModulus, poissonRatio, density });
}

bool vtkMaterialFromVolume::GetMaterialValues(int index, double values[3])
{
  return this->Internals->Table.GetNumbers(index, values);
}

void vtkMaterialFromVolume::ClearMaterials()
{
  this->Internals->Table.Clear(this);
}

int vtkMaterialFromVolume::GetNumberOfMaterials()
{
  return this->Internals->Table.GetNumber();
}

void vtkMaterialFromVolume::SetMaterialPreset(int index, int preset)
{
  if (!deformvolume::IsMaterialIndex(index))
  {
    vtkErrorMacro("The material index " << index << " is not valid. Use an integer from 0 to 255.");
    return;
  }
  if (!vtkElasticDeformation::GetMaterialPresetName(preset))
  {
    vtkErrorMacro("The preset "
      << preset << " of material " << index
      << " is not defined. Use one of vtkElasticDeformation::MaterialPresetType, from "
      << vtkElasticDeformation::CUSTOM << " to " << vtkElasticDeformation::BONE << ".");
    return;
  }
  int& last = this->Internals->Presets[static_cast<std::size_t>(index)];
  if (last != preset)
  {
    last = preset;
    this->Modified();
  }
}

int vtkMaterialFromVolume::GetMaterialPreset(int index)
{
  return deformvolume::IsMaterialIndex(index)
    ? this->Internals->Presets[static_cast<std::size_t>(index)]
    : vtkElasticDeformation::CUSTOM;
}

void vtkMaterialFromVolume::ClearMaterialPresets()
{
  if (this->GetNumberOfMaterialPresets() > 0)
  {
    this->Internals->Presets.fill(vtkElasticDeformation::CUSTOM);
    this->Modified();
  }
}

int vtkMaterialFromVolume::GetNumberOfMaterialPresets()
{
  const auto& presets = this->Internals->Presets;
  return static_cast<int>(std::count_if(presets.begin(), presets.end(),
    [](int preset) { return preset != vtkElasticDeformation::CUSTOM; }));
}

void vtkMaterialFromVolume::AddMaterialRange(double minimum, double maximum, double index)
{
  this->Internals->Table.AddRange(this, minimum, maximum, index);
}

void vtkMaterialFromVolume::ClearMaterialRanges()
{
  this->Internals->Table.ClearRanges(this);
}

int vtkMaterialFromVolume::GetNumberOfMaterialRanges()
{
  return static_cast<int>(this->Internals->Table.Ranges.size());
}

int vtkMaterialFromVolume::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(
    vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkUnstructuredGrid" : "vtkImageData");
  return 1;
}

int vtkMaterialFromVolume::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* output)
{
  deformvolume::MergeTimes(this, 2, output->GetInformationObject(0));
  return 1;
}

int vtkMaterialFromVolume::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  deformvolume::AskForAll(input, 1, 2);
  return 1;
}

int vtkMaterialFromVolume::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  this->Internals->Execution.Renew(this);
  *mtime = this->GetMTime();
  return 1;
}

int vtkMaterialFromVolume::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkUnstructuredGrid::GetData(output)->Initialize();
  this->NumberOfTetrahedraWithoutVoxels = 0;
  this->NumberOfTetrahedraOutside = 0;
  if (this->Internals->Execution.Run(this,
        "There is not enough memory for the materials of the voxels. Use a smaller "
        "volume, or free memory.",
        [&] { this->Execute(input, output); }))
  {
    return 1;
  }
  vtkUnstructuredGrid::GetData(output)->Initialize();
  // A rank without cells may have no error, but all ranks must have the same result.
  return deformvolume::GetResultOfError(output);
}

void vtkMaterialFromVolume::Execute(
  vtkInformationVector** input, vtkInformationVector* outputVector)
{
  vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::GetData(input[0]);
  vtkImageData* image = vtkImageData::GetData(input[1]);
  const deformvolume::MaterialTable<ElasticMaterial> table = this->Internals->GetTable();
  for (int i = 0; i < static_cast<int>(table.Materials.size()); ++i)
  {
    if (const ElasticMaterial* material = table.Find(i))
    {
      deformvolume::CheckMaterial(*material, " of material " + std::to_string(i));
    }
  }
  deformvolume::VolumeMaterials volume;
  volume.Volume = deformvolume::GetGeometry(image);
  deformvolume::CheckVolume(volume.Volume);
  volume.Table.assign(table.Materials.begin(), table.Materials.end());
  volume.Default = table.Get(this->DefaultMaterial, "DefaultMaterial");
  vtkDataArray* array =
    deformvolume::FindMaterialArray(image, this->MaterialArrayName, !table.Ranges.empty());
  const deformvolume::PointGhosts ghosts = deformvolume::FindPointGhosts(image, "volume");
  volume.Ghosts = ghosts.Values;
  volume.Indices = deformvolume::ReadMaterials(array, image->GetNumberOfPoints(), table.Ranges,
    this->DefaultMaterial, table.Exists, ghosts.Values);

  const deformvolume::GridTetrahedra read = deformvolume::ReadTetrahedra(mesh, true);
  const std::vector<glm::dvec3> points = mesh->GetNumberOfPoints() > 0
    ? deformvolume::ReadPoints({ mesh }, "mesh on input port 0", read.Tetrahedra)
    : std::vector<glm::dvec3>();
  deformvolume::ProgressReport progress(this);
  const deformvolume::MaterialMeans means = deformvolume::FindMaterialMeans(
    volume, points, read.Tetrahedra, [&](double done) { return progress.Report(done); });
  this->NumberOfTetrahedraWithoutVoxels = means.NumberWithNearest;
  this->NumberOfTetrahedraOutside = means.NumberWithDefault;

  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputVector);
  output->ShallowCopy(mesh);
  const auto add = [&](const char* name, double ElasticMaterial::*value)
  {
    vtkNew<vtkDoubleArray> values;
    values->SetName(name);
    values->SetNumberOfTuples(mesh->GetNumberOfCells());
    values->Fill(volume.Default.*value);
    for (std::size_t t = 0; t < read.Cells.size(); ++t)
    {
      values->SetValue(read.Cells[t], means.Materials[t].*value);
    }
    output->GetCellData()->AddArray(values);
  };
  add(deformvolume::YoungModulusName, &ElasticMaterial::YoungModulus);
  add(deformvolume::PoissonRatioName, &ElasticMaterial::PoissonRatio);
  add(deformvolume::DensityName, &ElasticMaterial::Density);
}

void vtkMaterialFromVolume::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaterialArrayName: " << this->MaterialArrayName << "\n";
  os << indent << "DefaultMaterial: " << this->DefaultMaterial << "\n";
  this->Internals->Table.Print(os, indent);
  os << indent << "MaterialPresets:\n";
  for (int i = 0; i < static_cast<int>(this->Internals->Presets.size()); ++i)
  {
    if (const int preset = this->GetMaterialPreset(i))
    {
      os << indent.GetNextIndent() << i << ": "
         << vtkElasticDeformation::GetMaterialPresetName(preset) << "\n";
    }
  }
  os << indent << "NumberOfTetrahedraWithoutVoxels: " << this->NumberOfTetrahedraWithoutVoxels
     << "\n";
  os << indent << "NumberOfTetrahedraOutside: " << this->NumberOfTetrahedraOutside << "\n";
}
