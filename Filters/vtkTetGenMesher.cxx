// SPDX-License-Identifier: BSD-3-Clause
#include "vtkTetGenMesher.h"

#include "ClosedSurface.h"
#include "IsAborted.h"
#include "MeshRefinement.h"
#include "PieceRequest.h"
#include "PipelineExecution.h"
#include "TetGenProcess.h"
#include "VTKThreads.h"

#include "vtkCellArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMassProperties.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTetra.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include <unistd.h>

vtkStandardNewMacro(vtkTetGenMesher);

namespace
{

constexpr double MaximumNumberOfTetrahedra = 20e6;
constexpr double SurfaceShare = 0.3; // part of the progress
constexpr double TetGenShare = 0.65;

vtkDataArray* FindArray(vtkDataArray* array, vtkImageData* volume)
{
  int dimensions[3];
  volume->GetDimensions(dimensions);
  for (int axis = 0; axis < 3; ++axis)
  {
    if (dimensions[axis] < 2)
    {
      throw deformvolume::Error("The volume has " + std::to_string(dimensions[axis]) +
        " voxels on axis " + "xyz"[axis] +
        ". A body needs at least two voxels on each axis. Use the whole volume, not a slice.");
    }
    if (!(std::abs(volume->GetSpacing()[axis]) > 0.0) ||
      !std::isfinite(volume->GetSpacing()[axis]) || !std::isfinite(volume->GetOrigin()[axis]))
    {
      throw deformvolume::Error(
        std::string("The spacing or the origin of the volume is not valid on axis ") + "xyz"[axis] +
        ". Set a finite spacing other than 0, and a finite origin.");
    }
  }
  if (!array)
  {
    throw deformvolume::Error("The volume has no such point array. Set active scalars, or choose "
                              "an array with SetInputArrayToProcess().");
  }
  if (array->GetNumberOfTuples() != volume->GetNumberOfPoints())
  {
    throw deformvolume::Error("The point array of the volume has " +
      std::to_string(array->GetNumberOfTuples()) + " tuples for " +
      std::to_string(volume->GetNumberOfPoints()) + " voxels. Give it one tuple for each voxel.");
  }
  return array;
}

// Volume of a regular tetrahedron with edges of this length.
double RegularVolume(double length)
{
  return std::sqrt(2.0) / 12.0 * length * length * length;
}

std::vector<deformvolume::RefinementSphere> GetSpheres(
  const std::vector<std::array<double, 5>>& numbers)
{
  std::vector<deformvolume::RefinementSphere> spheres;
  for (const std::array<double, 5>& n : numbers)
  {
    const bool finite =
      std::all_of(n.begin(), n.end(), [](double number) { return std::isfinite(number); });
    if (!finite || !(n[3] > 0.0) || !(n[4] > 0.0))
    {
      std::ostringstream message;
      message << "Refinement sphere " << spheres.size() << " has the center " << n[0] << ", "
              << n[1] << ", " << n[2] << ", the radius " << n[3] << " and the edge length " << n[4]
              << ". All numbers must be finite, and the radius and the edge length greater than 0.";
      throw deformvolume::Error(message.str());
    }
    spheres.push_back({ glm::dvec3(n[0], n[1], n[2]), n[3], n[4] });
  }
  return spheres;
}

// Gives all tetrahedra a positive volume.
void Orient(vtkUnstructuredGrid* mesh)
{
  vtkCellArray* cells = mesh->GetCells();
  vtkNew<vtkIdList> ids;
  for (vtkIdType cell = 0; cell < cells->GetNumberOfCells(); ++cell)
  {
    cells->GetCellAtId(cell, ids);
    double corners[4][3];
    for (int k = 0; k < 4; ++k)
    {
      mesh->GetPoint(ids->GetId(k), corners[k]);
    }
    if (vtkTetra::ComputeVolume(corners[0], corners[1], corners[2], corners[3]) < 0.0)
    {
      const vtkIdType second = ids->GetId(1);
      ids->SetId(1, ids->GetId(0));
      ids->SetId(0, second);
      cells->ReplaceCellAtId(cell, ids);
    }
  }
}

} // namespace

vtkTetGenMesher::vtkTetGenMesher()
  : Execution(new deformvolume::PipelineExecution)
{
  deformvolume::UseVTKThreads();
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

vtkTetGenMesher::~vtkTetGenMesher() = default;

void vtkTetGenMesher::SetPieceMode(int mode)
{
  if (mode == 1)
  {
    // State files may have this value.
    vtkWarningMacro("PieceMode is 1, the convex hull of all pieces, which was removed: ALL_PIECES "
                    "(0) is set. LARGEST_PIECE is 2.");
    mode = ALL_PIECES;
  }
  mode = std::clamp<int>(mode, ALL_PIECES, LARGEST_PIECE);
  if (this->PieceMode != mode)
  {
    this->PieceMode = mode;
    this->Modified();
  }
}

void vtkTetGenMesher::AddLabel(vtkTypeInt64 label)
{
  this->Labels.push_back(label);
  this->Modified();
}

void vtkTetGenMesher::ClearLabels()
{
  if (!this->Labels.empty())
  {
    this->Labels.clear();
    this->Modified();
  }
}

int vtkTetGenMesher::GetNumberOfLabels()
{
  return static_cast<int>(this->Labels.size());
}

vtkTypeInt64 vtkTetGenMesher::GetLabel(int index)
{
  return index >= 0 && index < this->GetNumberOfLabels() ? this->Labels[index] : 0;
}

void vtkTetGenMesher::AddRefinementSphere(
  double x, double y, double z, double radius, double edgeLength)
{
  this->RefinementSpheres.push_back({ { x, y, z, radius, edgeLength } });
  this->Modified();
}

void vtkTetGenMesher::ClearRefinementSpheres()
{
  if (!this->RefinementSpheres.empty())
  {
    this->RefinementSpheres.clear();
    this->Modified();
  }
}

int vtkTetGenMesher::GetNumberOfRefinementSpheres()
{
  return static_cast<int>(this->RefinementSpheres.size());
}

void vtkTetGenMesher::GetRefinementSphere(int index, double sphere[5])
{
  std::fill_n(sphere, 5, 0.0);
  if (index >= 0 && index < this->GetNumberOfRefinementSpheres())
  {
    std::copy_n(this->RefinementSpheres[index].begin(), 5, sphere);
  }
}

int vtkTetGenMesher::FillInputPortInformation(int, vtkInformation* info)
{
  info->Remove(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE());
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

int vtkTetGenMesher::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  // A part of the input has no closed surface: all ranks request the whole input.
  deformvolume::AskForAll(inputVector, 0, 1);
  return 1;
}

int vtkTetGenMesher::ComputePipelineMTime(
  vtkInformation*, vtkInformationVector**, vtkInformationVector*, int, vtkMTimeType* mtime)
{
  this->Execution->Renew(this);
  *mtime = this->GetMTime();
  return 1;
}

int vtkTetGenMesher::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputVector);
  output->Initialize();
  this->UsedIsovalue = 0.0;
  this->UsedTargetEdgeLength = 0.0;
  this->NumberOfBodyVoxels = 0;
  this->NumberOfBodyVoxelsOutside = 0;
  this->NumberOfSpeckVoxels = 0;
  this->NumberOfPieces = 0;
  if (!deformvolume::IsFirstPiece(outputVector))
  {
    return 1;
  }
  vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
  const int done = this->Execution->Run(this, "Not enough memory. Use a greater edge length.",
    [&]
    {
      const Spheres spheres = GetSpheres(this->RefinementSpheres);
      vtkNew<vtkUnstructuredGrid> mesh;
      if (vtkImageData* volume = vtkImageData::SafeDownCast(input))
      {
        // The name is empty in ParaView if no array was known when the filter was made.
        const char* name = this->GetInputArrayInformation(0)->Get(vtkDataObject::FIELD_NAME());
        vtkDataArray* array = name && !*name ? volume->GetPointData()->GetScalars()
                                             : this->GetInputArrayToProcess(0, inputVector);
        this->MeshVolume(volume, FindArray(array, volume), spheres, mesh);
      }
      else if (vtkPolyData* surface = vtkPolyData::SafeDownCast(input))
      {
        this->MeshSurface(surface, spheres, mesh);
      }
      Orient(mesh);
      output->ShallowCopy(mesh);
    });
  return done ? 1 : deformvolume::GetResultOfError(outputVector);
}

void vtkTetGenMesher::CheckStep(double share)
{
  this->UpdateProgress(SurfaceShare * share);
  if (deformvolume::IsAborted(this))
  {
    throw deformvolume::Aborted();
  }
}

void vtkTetGenMesher::MeshSurface(
  vtkPolyData* input, const Spheres& spheres, vtkUnstructuredGrid* output)
{
  const auto surface = deformvolume::CleanTriangles(input);
  deformvolume::CheckClosedSurface(surface);
  this->CheckStep(0.3);
  const double length =
    this->TargetEdgeLength > 0.0 ? this->TargetEdgeLength : surface->GetLength() / 20.0;
  this->UsedTargetEdgeLength = length;
  const auto decimated = this->Decimation ? deformvolume::Decimate(surface, length) : nullptr;
  if (decimated && decimated != surface)
  {
    try
    {
      output->ShallowCopy(this->Fill(decimated, length, spheres, false));
      return;
    }
    catch (const deformvolume::SurfaceRejected&)
    {
      // Decimation can make a surface intersect itself. The surface is then meshed without
      // decimation.
    }
  }
  CheckSize(surface, length, {});
  const auto split = deformvolume::SplitLongEdges(surface, 1.5 * length);
  output->ShallowCopy(
    this->Fill(deformvolume::IsClosedManifold(split) ? split : surface, length, spheres, true));
}

void vtkTetGenMesher::CheckSize(vtkPolyData* surface, double length, const Spheres& spheres)
{
  vtkNew<vtkMassProperties> properties;
  properties->SetInputData(surface);
  // On average, tetrahedra of TetGen have about half of the largest volume.
  const double expected = 2.0 * properties->GetVolume() / RegularVolume(length) +
    properties->GetSurfaceArea() / (std::sqrt(3.0) / 4.0 * length * length);
  const double refined = spheres.empty() ? 0.0 : deformvolume::EstimateTetrahedra(surface, spheres);
  if (expected + refined < MaximumNumberOfTetrahedra)
  {
    return;
  }
  std::ostringstream message;
  if (expected < MaximumNumberOfTetrahedra)
  {
    message << "The refinement spheres require about " << refined
            << " tetrahedra. The limit is 20 million. Use smaller radii or greater edge lengths.";
  }
  else
  {
    message << "An edge length of " << length << " requires about " << expected
            << " tetrahedra. The limit is 20 million. Use a greater edge length.";
  }
  throw deformvolume::Error(message.str());
}

vtkSmartPointer<vtkUnstructuredGrid> vtkTetGenMesher::Fill(
  vtkPolyData* surface, double length, const Spheres& spheres, bool diagnose)
{
  deformvolume::TetGenParameters parameters;
  parameters.Executable = this->FindExecutable();
  parameters.TimeLimit = this->TimeLimit;
  parameters.Diagnose = diagnose;
  if (length > 0.0)
  {
    CheckSize(surface, length, spheres);
    if (!spheres.empty())
    {
      deformvolume::SplitLongEdges(surface, spheres);
      parameters.Points = deformvolume::MakePoints(surface, spheres);
    }
    parameters.RadiusEdgeRatio = this->RadiusEdgeRatio;
    parameters.MaximumVolume = RegularVolume(length);
  }
  this->CheckStep(1.0);
  auto mesh = deformvolume::RunTetGen(surface, parameters,
    [this](double passed)
    {
      this->UpdateProgress(SurfaceShare + TetGenShare * std::min(1.0, std::sqrt(passed)));
      return deformvolume::IsAborted(this);
    });
  if (!spheres.empty())
  {
    deformvolume::SplitLongEdges(mesh, spheres);
  }
  return mesh;
}

std::string vtkTetGenMesher::FindExecutable()
{
  if (!this->TetGenExecutable.empty())
  {
    return this->TetGenExecutable;
  }
  const char* chosen = std::getenv("DEFORMVOLUME_TETGEN");
  if (chosen && *chosen)
  {
    return chosen;
  }
#ifdef DEFORMVOLUME_TETGEN_EXECUTABLE
  if (access(DEFORMVOLUME_TETGEN_EXECUTABLE, X_OK) == 0)
  {
    return DEFORMVOLUME_TETGEN_EXECUTABLE;
  }
#endif
  return "tetgen";
}

void vtkTetGenMesher::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "BodyMode: " << (this->BodyMode == LABELS ? "Labels" : "Isosurface") << "\n";
  os << indent << "AutomaticIsovalue: " << this->AutomaticIsovalue << "\n";
  os << indent << "Isovalue: " << this->Isovalue << "\n";
  os << indent << "Labels:";
  for (vtkTypeInt64 label : this->Labels)
  {
    os << " " << label;
  }
  os << "\n"
     << indent
     << "PieceMode: " << (this->PieceMode == LARGEST_PIECE ? "Largest Piece" : "All Pieces")
     << "\n";
  os << indent << "SpeckSize: " << this->SpeckSize << "\n";
  os << indent << "TargetEdgeLength: " << this->TargetEdgeLength << "\n";
  os << indent << "Margin: " << this->Margin << "\n";
  os << indent << "SmoothingIterations: " << this->SmoothingIterations << "\n";
  os << indent << "Decimation: " << this->Decimation << "\n";
  os << indent << "RefinementSpheres: " << this->RefinementSpheres.size() << "\n";
  for (const std::array<double, 5>& sphere : this->RefinementSpheres)
  {
    os << indent.GetNextIndent() << "Center: " << sphere[0] << " " << sphere[1] << " " << sphere[2]
       << ", Radius: " << sphere[3] << ", EdgeLength: " << sphere[4] << "\n";
  }
  os << indent << "RadiusEdgeRatio: " << this->RadiusEdgeRatio << "\n";
  os << indent << "TimeLimit: " << this->TimeLimit << "\n";
  os << indent << "TetGenExecutable: " << this->TetGenExecutable << "\n";
  os << indent << "UsedIsovalue: " << this->UsedIsovalue << "\n";
  os << indent << "UsedTargetEdgeLength: " << this->UsedTargetEdgeLength << "\n";
  os << indent << "NumberOfBodyVoxels: " << this->NumberOfBodyVoxels << "\n";
  os << indent << "NumberOfBodyVoxelsOutside: " << this->NumberOfBodyVoxelsOutside << "\n";
  os << indent << "NumberOfSpeckVoxels: " << this->NumberOfSpeckVoxels << "\n";
  os << indent << "NumberOfPieces: " << this->NumberOfPieces << "\n";
}
