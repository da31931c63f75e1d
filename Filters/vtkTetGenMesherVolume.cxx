// SPDX-License-Identifier: BSD-3-Clause
// How vtkTetGenMesher meshes the body in a volume.
#include "vtkTetGenMesher.h"

#include "BodyCoverage.h"
#include "BodyIsovalue.h"
#include "EnclosingSurfaces.h"
#include "TetGenProcess.h"
#include "VolumeFrame.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace
{

// From that part of the body's voxels on, those outside the mesh are worth a warning.
constexpr double WarningShare = 0.001;
// That part of them may be outside before another surface is tried.
constexpr double AllowedShare = 1e-5;

double DiagonalOf(vtkImageData* volume)
{
  int dimensions[3];
  volume->GetDimensions(dimensions);
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = (dimensions[axis] - 1) * volume->GetSpacing()[axis];
    square += length * length;
  }
  return std::sqrt(square);
}

deformvolume::Error NoBody(
  vtkImageData* volume, vtkDataArray* array, const deformvolume::BodyCriterion& criterion)
{
  std::ostringstream text;
  const std::array<double, 2> range = deformvolume::FindRange(volume, array);
  if (range[0] > range[1])
  {
    text << "No body: the volume has no finite value that is not hidden.";
  }
  else if (criterion.ByLabels)
  {
    text << "No body: the volume has no voxel with "
         << (criterion.Labels.empty() ? "a label other than 0."
                                      : "one of the labels. Check AddLabel().");
  }
  else
  {
    text << "No body: the volume has no value of at least " << criterion.Isovalue
         << ", the isovalue; its values go from " << range[0] << " to " << range[1]
         << ". Set another Isovalue.";
  }
  return deformvolume::Error(text.str());
}

std::string WithCommas(vtkIdType number)
{
  std::string text = std::to_string(number);
  for (auto at = static_cast<int>(text.size()) - 3; at > 0; at -= 3)
  {
    text.insert(static_cast<std::size_t>(at), ",");
  }
  return text;
}

} // namespace

void vtkTetGenMesher::MeshVolume(
  vtkImageData* volume, vtkDataArray* array, vtkUnstructuredGrid* output)
{
  const double length =
    this->TargetEdgeLength > 0.0 ? this->TargetEdgeLength : DiagonalOf(volume) / 20.0;
  this->UsedTargetEdgeLength = length;
  deformvolume::BodyCriterion criterion;
  criterion.ByLabels = this->BodyMode == LABELS;
  criterion.Labels = this->Labels;
  if (!criterion.ByLabels)
  {
    criterion.Isovalue = this->AutomaticIsovalue
      ? deformvolume::FindIsovalue(volume, array, length / 1.5)
      : this->Isovalue;
  }
  this->UsedIsovalue = criterion.ByLabels ? 0.5 : criterion.Isovalue;
  this->CheckStep(0.1);
  deformvolume::BodyVoxels body = deformvolume::FindBodyVoxels(volume, array, criterion);
  if (body.Runs.empty())
  {
    throw NoBody(volume, array, criterion);
  }
  deformvolume::FindPieces(body, this->SpeckSize, this->PieceMode == LARGEST_PIECE);
  this->CheckStep(0.2);

  deformvolume::SurfaceParameters parameters;
  parameters.EdgeLength = length;
  parameters.Margin = length * this->Margin;
  parameters.SmoothingIterations = this->SmoothingIterations;
  parameters.Decimation = this->Decimation;
  parameters.Hull = this->PieceMode == CONVEX_HULL;
  const deformvolume::VolumeFrame frame(volume);
  double step = 0.2;
  deformvolume::EnclosingSurfaces surfaces(
    body, frame.GetSpacing(), parameters, [&]() { this->CheckStep(std::min(0.9, step += 0.1)); });
  using deformvolume::PieceKind;
  const double allowed = AllowedShare * body.CountVoxels(PieceKind::Meshed);
  deformvolume::UncoveredVoxels uncovered;
  bool meshed = false;
  while (const auto surface = surfaces.Next())
  {
    try
    {
      this->Fill(surface, length, &frame, surfaces.IsLast() && !meshed, output);
    }
    catch (const deformvolume::SurfaceRejected&)
    {
      if (surfaces.IsLast() && !meshed)
      {
        throw;
      }
      continue;
    }
    // Voxels that the surface has just inside can be outside once positions are rounded.
    meshed = true;
    uncovered = deformvolume::FindUncovered(output, volume, body);
    if (static_cast<double>(uncovered.OfMeshed) <= allowed)
    {
      break;
    }
  }
  if (!meshed)
  {
    throw deformvolume::Error("No surface around the body can be made. Set another "
                              "TargetEdgeLength.");
  }
  this->NumberOfSpeckVoxels = body.CountVoxels(PieceKind::Speck);
  this->NumberOfBodyVoxels =
    body.CountVoxels(PieceKind::Meshed) + body.CountVoxels(PieceKind::LeftOut);
  this->NumberOfBodyVoxelsOutside = uncovered.OfBody;
  this->NumberOfPieces = body.CountPieces(PieceKind::Meshed) + body.CountPieces(PieceKind::LeftOut);
  this->WarnOfVoxelsOutside();
}

void vtkTetGenMesher::WarnOfVoxelsOutside()
{
  const double share = static_cast<double>(this->NumberOfBodyVoxelsOutside) /
    static_cast<double>(this->NumberOfBodyVoxels);
  if (!(share >= WarningShare))
  {
    return;
  }
  std::ostringstream text;
  text.precision(2);
  text << WithCommas(this->NumberOfBodyVoxelsOutside) << " of the "
       << WithCommas(this->NumberOfBodyVoxels) << " voxels of the body (" << 100.0 * share
       << " %) lie outside the mesh.";
  if (this->PieceMode == LARGEST_PIECE && this->NumberOfPieces > 1)
  {
    text << " The body has " << WithCommas(this->NumberOfPieces)
         << " pieces, of which PieceMode chooses the largest. All pieces, or their convex hull, "
            "can be meshed instead.";
  }
  else
  {
    text << " Set a smaller TargetEdgeLength or a greater Margin.";
  }
  vtkWarningMacro(<< text.str());
}

std::string vtkTetGenMesher::GetSummary()
{
  if (this->NumberOfBodyVoxels == 0)
  {
    return "";
  }
  std::ostringstream text;
  text << "Body voxels: " << WithCommas(this->NumberOfBodyVoxels) << "\n"
       << "Body voxels outside the mesh: " << WithCommas(this->NumberOfBodyVoxelsOutside) << "\n"
       << "Pieces: " << WithCommas(this->NumberOfPieces) << "\n"
       << "Voxels of specks: " << WithCommas(this->NumberOfSpeckVoxels);
  return text.str();
}
