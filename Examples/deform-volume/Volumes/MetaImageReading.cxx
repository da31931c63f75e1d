// SPDX-License-Identifier: BSD-3-Clause
#include "MetaImageReading.h"

#include "Failure.h"
#include "ImageAxes.h"
#include "ItkImage.h"

#include <itkMetaImageIO.h>

#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <vector>

namespace
{
vtkSmartPointer<vtkDataArray> GetFrame(vtkDataArray* all, int frame, vtkIdType voxels)
{
  const auto one = vtkSmartPointer<vtkDataArray>::Take(all->NewInstance());
  one->SetNumberOfComponents(all->GetNumberOfComponents());
  one->SetNumberOfTuples(voxels);
  one->InsertTuples(0, voxels, frame * voxels, all);
  return one;
}

double GetMillimetres(MET_DistanceUnitsEnumType unit)
{
  return unit == MET_DISTANCE_UNITS_UM ? 0.001 : unit == MET_DISTANCE_UNITS_CM ? 10.0 : 1.0;
}
}

Volume ReadMetaImage(const std::string& path, const ReadingOptions& options, Messages& messages)
{
  const auto io = itk::MetaImageIO::New();
  ReadHeader(
    io, path, "it is not a MetaImage file, its header is wrong, or it names a missing file");
  const unsigned int axes = io->GetNumberOfDimensions();
  const auto getSize = [&](unsigned int axis)
  { return axis < axes ? static_cast<int>(io->GetDimensions(axis)) : 1; };
  for (unsigned int axis = 4; axis < axes; ++axis)
  {
    if (getSize(axis) > 1)
    {
      throw Failure("cannot read " + path + ": it has " + std::to_string(axes) +
        " axes. A volume has three axes of space, and one of time");
    }
  }
  const int frames = getSize(3);
  const int frame = ChooseFrame(path, frames, options);
  std::string complaints;
  vtkSmartPointer<vtkDataArray> values = ReadValues(io, complaints);
  // MetaIO writes to std::cerr, but reports no error, if a file is missing, damaged or truncated.
  if (!complaints.empty())
  {
    throw Failure("cannot read " + path + ": " + DataMissing);
  }
  Volume volume;
  volume.NumberOfFrames = frames;
  const double factor =
    options.FileCoordinates ? 1.0 : GetMillimetres(io->GetMetaImagePointer()->DistanceUnits());
  if (factor != 1.0)
  {
    volume.Unit = io->GetMetaImagePointer()->DistanceUnitsName();
  }
  volume.Image = vtkSmartPointer<vtkImageData>::New();
  volume.Image->SetDimensions(getSize(0), getSize(1), getSize(2));
  if (frames > 1)
  {
    values = GetFrame(values, frame, volume.Image->GetNumberOfPoints());
  }
  values->SetName("MetaImage");
  volume.Image->GetPointData()->SetScalars(values);
  double spacing[3] = { 1.0, 1.0, 1.0 };
  vtkNew<vtkMatrix4x4> place;
  for (unsigned int column = 0; column < std::min(axes, 3U); ++column)
  {
    spacing[column] = factor * io->GetSpacing(column);
    const std::vector<double> direction = io->GetDirection(column);
    for (unsigned int row = 0; row < std::min(axes, 3U) && !options.FileCoordinates; ++row)
    {
      place->SetElement(row, column, direction[row]);
    }
    place->SetElement(column, 3, factor * io->GetOrigin(column));
  }
  volume.Image->SetSpacing(spacing);
  SetAxes(volume.Image, place, path, messages);
  volume.Axes = options.FileCoordinates ? WorldAxes::Unknown : WorldAxes::LeftPosteriorSuperior;
  return volume;
}
