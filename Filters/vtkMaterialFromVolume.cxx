// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMaterialFromVolume.h"

#include "BodyReading.h"
#include "DeformationMesh.h"
#include "Error.h"
#include "FailureReport.h"
#include "MaterialArray.h"
#include "PieceRequest.h"
#include "ProgressReport.h"
#include "VTKThreads.h"
#include "VolumeMaterials.h"

#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <vector>

vtkStandardNewMacro(vtkMaterialFromVolume);

using deformvolume::ElasticMaterial;

namespace
{

constexpr int NumberOfIndices = 256;

bool IsIndex(double index)
{
  return index >= 0.0 && index < NumberOfIndices && index == std::floor(index);
}

} // namespace

class vtkMaterialFromVolume::vtkInternals
{
public:
  vtkInternals()
  {
    constexpr ElasticMaterial materials[] = { { 100.0, 0.0, 100.0 }, { 1e4, 0.3, 1000.0 },
      { 5e4, 0.4, 1060.0 }, { 1e6, 0.4, 1100.0 }, { 1e7, 0.3, 1900.0 } };
    std::copy(std::begin(materials), std::end(materials), this->Materials.begin());
    std::fill_n(this->Exists.begin(), std::size(materials), true);
  }

  std::array<ElasticMaterial, NumberOfIndices> Materials;
  std::array<bool, NumberOfIndices> Exists{};
  std::vector<deformvolume::MaterialRange> Ranges;
  bool Aborted = false;
};

vtkMaterialFromVolume::vtkMaterialFromVolume()
  : Internals(new vtkInternals)
{
  deformvolume::UseVTKThreads();
  this->SetNumberOfInputPorts(2);
}

vtkMaterialFromVolume::~vtkMaterialFromVolume() = default;

void vtkMaterialFromVolume::SetVolumeConnection(vtkAlgorithmOutput* output)
{
  this->SetInputConnection(1, output);
}

void vtkMaterialFromVolume::SetVolumeData(vtkDataObject* data)
{
  this->SetInputDataObject(1, data);
}

void vtkMaterialFromVolume::SetMaterial(
  int index, double youngModulus, double poissonRatio, double density)
{
  this->SetMaterial(static_cast<double>(index), youngModulus, poissonRatio, density);
}

void vtkMaterialFromVolume::SetMaterial(
  double index, double youngModulus, double poissonRatio, double density)
{
  if (!IsIndex(index))
  {
    vtkErrorMacro("There is no material " << index << ". Give it a whole number from 0 to 255.");
    return;
  }
  const auto place = static_cast<std::size_t>(index);
  const ElasticMaterial& before = this->Internals->Materials[place];
  if (!this->Internals->Exists[place] || before.YoungModulus != youngModulus ||
    before.PoissonRatio != poissonRatio || before.Density != density)
  {
    this->Internals->Materials[place] = { youngModulus, poissonRatio, density };
    this->Internals->Exists[place] = true;
    this->Modified();
  }
}

bool vtkMaterialFromVolume::GetMaterialValues(int index, double values[3])
{
  if (!IsIndex(index) || !this->Internals->Exists[static_cast<std::size_t>(index)])
  {
    return false;
  }
  const ElasticMaterial& material = this->Internals->Materials[static_cast<std::size_t>(index)];
  values[0] = material.YoungModulus;
  values[1] = material.PoissonRatio;
  values[2] = material.Density;
  return true;
}

void vtkMaterialFromVolume::ClearMaterials()
{
  if (this->GetNumberOfMaterials() > 0)
  {
    this->Internals->Exists.fill(false);
    this->Modified();
  }
}

int vtkMaterialFromVolume::GetNumberOfMaterials()
{
  const auto& exists = this->Internals->Exists;
  return static_cast<int>(std::count(exists.begin(), exists.end(), true));
}

void vtkMaterialFromVolume::AddMaterialRange(double minimum, double maximum, double index)
{
  if (!IsIndex(index))
  {
    vtkErrorMacro("There is no material " << index << ". Give the range an index from 0 to 255.");
    return;
  }
  this->Internals->Ranges.push_back({ minimum, maximum, static_cast<int>(index) });
  this->Modified();
}

void vtkMaterialFromVolume::ClearMaterialRanges()
{
  if (!this->Internals->Ranges.empty())
  {
    this->Internals->Ranges.clear();
    this->Modified();
  }
}

int vtkMaterialFromVolume::GetNumberOfMaterialRanges()
{
  return static_cast<int>(this->Internals->Ranges.size());
}

int vtkMaterialFromVolume::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(
    vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkUnstructuredGrid" : "vtkImageData");
  return 1;
}

int vtkMaterialFromVolume::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector*)
{
  deformvolume::AskForAll(input[1]->GetInformationObject(0));
  return 1;
}

int vtkMaterialFromVolume::ComputePipelineMTime(vtkInformation* request,
  vtkInformationVector** input, vtkInformationVector* output, int requestFromOutputPort,
  vtkMTimeType* mtime)
{
  // An aborted output is not up to date, but the executive takes it for that.
  if (this->Internals->Aborted)
  {
    this->Internals->Aborted = false;
    this->Modified();
  }
  return this->Superclass::ComputePipelineMTime(
    request, input, output, requestFromOutputPort, mtime);
}

int vtkMaterialFromVolume::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* output)
{
  vtkUnstructuredGrid::GetData(output)->Initialize();
  try
  {
    this->Execute(input, output);
    return 1;
  }
  catch (const deformvolume::Aborted&)
  {
    this->Internals->Aborted = true;
    return 1;
  }
  catch (const deformvolume::Error& error)
  {
    vtkErrorMacro(<< error.what());
  }
  catch (const std::bad_alloc&)
  {
    vtkErrorMacro("There is not enough memory for the materials of the voxels. Use a smaller "
                  "volume, or free memory.");
  }
  return deformvolume::Fail(this);
}

void vtkMaterialFromVolume::Execute(
  vtkInformationVector** input, vtkInformationVector* outputVector)
{
  vtkUnstructuredGrid* mesh = vtkUnstructuredGrid::GetData(input[0]);
  vtkImageData* image = vtkImageData::GetData(input[1]);
  const vtkInternals& internals = *this->Internals;
  const auto defaultMaterial = static_cast<std::size_t>(this->DefaultMaterial);
  if (!internals.Exists[defaultMaterial])
  {
    throw deformvolume::Error("DefaultMaterial is the material " +
      std::to_string(this->DefaultMaterial) + ", which there is not. Set it with SetMaterial().");
  }
  for (std::size_t i = 0; i < internals.Materials.size(); ++i)
  {
    if (internals.Exists[i])
    {
      deformvolume::CheckMaterial(internals.Materials[i], " of material " + std::to_string(i));
    }
  }
  deformvolume::VolumeMaterials volume;
  volume.Volume = deformvolume::GetGeometry(image);
  deformvolume::CheckVolume(volume.Volume);
  volume.Table.assign(internals.Materials.begin(), internals.Materials.end());
  volume.Default = internals.Materials[defaultMaterial];
  vtkDataArray* array =
    deformvolume::FindMaterialArray(image, this->MaterialArrayName, !internals.Ranges.empty());
  volume.Indices = array
    ? deformvolume::ReadMaterials(array, internals.Ranges, this->DefaultMaterial, internals.Exists)
    : std::vector<unsigned char>(static_cast<std::size_t>(image->GetNumberOfPoints()),
        static_cast<unsigned char>(this->DefaultMaterial));
  if (vtkUnsignedCharArray* ghosts = image->GetPointGhostArray())
  {
    volume.Ghosts = ghosts->GetPointer(0);
    volume.HiddenBits = vtkDataSetAttributes::DUPLICATEPOINT | vtkDataSetAttributes::HIDDENPOINT;
  }

  const deformvolume::GridTetrahedra read = deformvolume::ReadTetrahedra(mesh);
  const std::vector<glm::dvec3> points = mesh->GetNumberOfPoints() > 0
    ? deformvolume::ReadPoints({ mesh }, "mesh on input port 0")
    : std::vector<glm::dvec3>();
  deformvolume::ProgressReport progress(this);
  const deformvolume::MaterialMeans means = deformvolume::FindMaterialMeans(
    volume, points, read.Tetrahedra, [&](double done) { return progress.Tell(done); });
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
  os << indent << "Materials:\n";
  for (int i = 0; i < NumberOfIndices; ++i)
  {
    double values[3];
    if (this->GetMaterialValues(i, values))
    {
      os << indent.GetNextIndent() << i << ": " << values[0] << " " << values[1] << " " << values[2]
         << "\n";
    }
  }
  os << indent << "MaterialRanges:\n";
  for (const deformvolume::MaterialRange& range : this->Internals->Ranges)
  {
    os << indent.GetNextIndent() << range.Minimum << " to " << range.Maximum << ": " << range.Index
       << "\n";
  }
  os << indent << "NumberOfTetrahedraWithoutVoxels: " << this->NumberOfTetrahedraWithoutVoxels
     << "\n";
  os << indent << "NumberOfTetrahedraOutside: " << this->NumberOfTetrahedraOutside << "\n";
}
