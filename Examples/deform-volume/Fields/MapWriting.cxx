// SPDX-License-Identifier: BSD-3-Clause
#include "MapWriting.h"

#include "Coverage.h"
#include "Files.h"
#include "Messages.h"
#include "Options.h"
#include "VolumeWriting.h"

#include <vtkDeformVolumeFilter.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <string>

namespace
{
// Returns an image on the grid of another one, with one array.
vtkSmartPointer<vtkImageData> MakeImage(vtkImageData* grid, vtkDataArray* values)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->CopyStructure(grid);
  image->GetPointData()->SetScalars(values);
  return image;
}

// Writes an array of the result, and removes it from `remaining`.
void WriteMap(const char* name, const std::vector<std::string>& paths, const Options& options,
  const Volume& deformed, vtkImageData* remaining, Messages& messages)
{
  if (paths.empty())
  {
    return; // an array of this name is one of the volume
  }
  Volume written = deformed;
  written.Image = MakeImage(deformed.Image, CopyCovered(deformed.Image, name));
  for (const std::string& path : paths)
  {
    WriteVolume(written, path, messages, !options.Quiet);
  }
  remaining->GetPointData()->RemoveArray(name);
}

// Returns the vectors from the voxels to their rest positions; 0 for voxels that are not covered.
// sign: a factor on x and y.
vtkSmartPointer<vtkFloatArray> MakeVectors(vtkImageData* image, double sign)
{
  vtkDataArray* restPositions = image->GetPointData()->GetArray("RestPosition");
  auto vectors = vtkSmartPointer<vtkFloatArray>::New();
  vectors->SetName("Displacement");
  vectors->SetNumberOfComponents(3);
  vectors->SetNumberOfTuples(restPositions->GetNumberOfTuples());
  vectors->Fill(0.0);
  const char* covered = GetCoverage(image);
  for (vtkIdType voxel = 0; voxel < restPositions->GetNumberOfTuples(); ++voxel)
  {
    if (covered[voxel] != 0)
    {
      double here[3];
      double rest[3];
      image->GetPoint(voxel, here);
      restPositions->GetTuple(voxel, rest);
      vectors->SetTuple3(
        voxel, sign * (rest[0] - here[0]), sign * (rest[1] - here[1]), rest[2] - here[2]);
    }
  }
  return vectors;
}

void WriteInverseField(const Options& options, const Volume& deformed, Messages& messages)
{
  const char* covered = GetCoverage(deformed.Image);
  const auto uncovered =
    std::count(covered, covered + deformed.Image->GetNumberOfPoints(), static_cast<char>(0));
  if (uncovered > 0)
  {
    messages.Warn("The inverse field is 0 at " + std::to_string(uncovered) + " of " +
      std::to_string(deformed.Image->GetNumberOfPoints()) + " voxels outside the deformed volume.");
  }
  for (const std::string& path : options.InverseFields)
  {
    // ITK expects vectors left-posterior-superior, although NIfTI files are
    // right-anterior-superior.
    const bool pointsLeft = deformed.Axes == WorldAxes::LeftPosteriorSuperior ||
      (deformed.Axes == WorldAxes::Unknown && !HasSuffix(path, { ".nii", ".nii.gz" }));
    const double sign = pointsLeft || HasSuffix(path, { ".vti" }) ? 1.0 : -1.0;
    Volume written = deformed;
    written.Image = MakeImage(deformed.Image, MakeVectors(deformed.Image, sign));
    written.IntentCode = NIfTIIntentVector;
    WriteVolume(written, path, messages, !options.Quiet);
  }
}
}

void AskForMaps(const Options& options, vtkDeformVolumeFilter* filter)
{
  filter->SetGenerateJacobian(!options.Jacobians.empty());
  filter->SetGenerateFoldCount(!options.FoldCounts.empty());
  filter->SetGenerateRestPositions(!options.InverseFields.empty());
}

void WriteMaps(const Options& options, Volume& deformed, Messages& messages)
{
  vtkNew<vtkImageData> remaining;
  remaining->ShallowCopy(deformed.Image);
  WriteMap("Jacobian", options.Jacobians, options, deformed, remaining, messages);
  WriteMap("FoldCount", options.FoldCounts, options, deformed, remaining, messages);
  if (!options.InverseFields.empty())
  {
    WriteInverseField(options, deformed, messages);
    remaining->GetPointData()->RemoveArray("RestPosition");
  }
  deformed.Image = remaining;
}
