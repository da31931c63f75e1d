// SPDX-License-Identifier: BSD-3-Clause
#include "ItkReading.h"

#include "Failure.h"
#include "ImageAxes.h"
#include "ItkImage.h"
#include "Messages.h"

#include <NrrdIO.h>
#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace
{
// Reads values and spacing of a file of up to three axes of space and one of time.
Volume Read(itk::ImageIOBase* io, const std::string& path, const ReadingOptions& options)
{
  ReadHeader(io, path);
  const unsigned int axes = io->GetNumberOfDimensions();
  const auto getSize = [&](unsigned int axis)
  { return axis < axes ? static_cast<int>(io->GetDimensions(axis)) : 1; };
  for (unsigned int axis = 4; axis < axes; ++axis)
  {
    if (getSize(axis) > 1)
    {
      throw Failure("cannot read " + path + ": it has " + std::to_string(axes) +
        " axes, where a volume has three, and one of time");
    }
  }
  const int frames = getSize(3);
  const int frame = ChooseFrame(path, frames, options);
  vtkSmartPointer<vtkDataArray> values = ReadValues(io);
  Volume volume;
  volume.Image = vtkSmartPointer<vtkImageData>::New();
  volume.Image->SetDimensions(getSize(0), getSize(1), getSize(2));
  if (frames > 1)
  {
    const auto one = vtkSmartPointer<vtkDataArray>::Take(values->NewInstance());
    const vtkIdType count = volume.Image->GetNumberOfPoints();
    one->SetNumberOfComponents(values->GetNumberOfComponents());
    one->SetNumberOfTuples(count);
    one->InsertTuples(0, count, frame * count, values);
    values = one;
  }
  volume.Image->GetPointData()->SetScalars(values);
  double spacing[3] = { 1.0, 1.0, 1.0 };
  for (unsigned int axis = 0; axis < std::min(axes, 3U); ++axis)
  {
    spacing[axis] = io->GetSpacing(axis);
  }
  volume.Image->SetSpacing(spacing);
  volume.Fields = GetTexts(io);
  return volume;
}

// The place that ITK gives: directions of unit length and the position of the first voxel.
void GetPlace(itk::ImageIOBase* io, vtkMatrix4x4* place)
{
  const unsigned int axes = std::min(io->GetNumberOfDimensions(), 3U);
  for (unsigned int column = 0; column < axes; ++column)
  {
    const std::vector<double> direction = io->GetDirection(column);
    for (unsigned int row = 0; row < axes; ++row)
    {
      place->SetElement(row, column, direction[row]);
    }
    place->SetElement(column, 3, io->GetOrigin(column));
  }
}

void Place(Volume& volume, vtkMatrix4x4* place, const std::string& path,
  const ReadingOptions& options, Messages& messages)
{
  vtkNew<vtkMatrix4x4> used;
  used->DeepCopy(place);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3 && options.FileCoordinates; ++column)
    {
      used->SetElement(row, column, row == column ? 1.0 : 0.0);
    }
  }
  SetAxes(volume.Image, used, path, messages);
}

// The header of an NRRD file as it is. ITK 5.2 turns spaces into left-posterior-superior, not all
// of them rightly.
class NRRDHeader
{
public:
  explicit NRRDHeader(const std::string& path)
  {
    NrrdIoState* const state = nrrdIoStateNew();
    state->skipData = 1;
    const bool failed = nrrdLoad(this->Header, path.c_str(), state) != 0;
    nrrdIoStateNix(state);
    if (failed)
    {
      std::free(biffGetDone("nrrd")); // why, which ITK has not minded
      throw Failure("cannot read " + path + ": its header cannot be read");
    }
  }
  ~NRRDHeader() { nrrdNuke(this->Header); }
  NRRDHeader(const NRRDHeader&) = delete;
  NRRDHeader& operator=(const NRRDHeader&) = delete;

  WorldAxes GetAxes() const
  {
    switch (this->Header->space)
    {
      case nrrdSpaceRightAnteriorSuperior:
      case nrrdSpaceRightAnteriorSuperiorTime:
        return WorldAxes::RightAnteriorSuperior;
      case nrrdSpaceLeftPosteriorSuperior:
      case nrrdSpaceLeftPosteriorSuperiorTime:
        return WorldAxes::LeftPosteriorSuperior;
      default:
        return this->IsLeftAnterior() ? WorldAxes::LeftPosteriorSuperior : WorldAxes::Unknown;
    }
  }

  // Whether y has to be turned for left-posterior-superior.
  bool IsLeftAnterior() const
  {
    return this->Header->space == nrrdSpaceLeftAnteriorSuperior ||
      this->Header->space == nrrdSpaceLeftAnteriorSuperiorTime;
  }

  // Directions of unit length, in the space of the file, and the position of the first voxel. False
  // where the file has none for three axes.
  bool GetPlace(vtkMatrix4x4* place) const
  {
    int column = 0;
    for (unsigned int axis = 0; axis < this->Header->dim && this->Header->spaceDim >= 3; ++axis)
    {
      double direction[3];
      std::copy_n(this->Header->axis[axis].spaceDirection, 3, direction);
      if (!std::isfinite(direction[0]) || column == 3)
      {
        continue; // of vectors, or of time
      }
      vtkMath::Normalize(direction);
      for (int row = 0; row < 3; ++row)
      {
        place->SetElement(row, column, direction[row]);
      }
      ++column;
    }
    for (int row = 0; row < 3; ++row)
    {
      const double origin = this->Header->spaceOrigin[row];
      place->SetElement(row, 3, std::isfinite(origin) ? origin : 0.0);
    }
    return column == 3;
  }

  // From components of vectors to the space of the file: the identity where it is not given.
  void GetMeasurementFrame(vtkMatrix3x3* matrix) const
  {
    for (int column = 0; column < 3 && std::isfinite(this->Header->measurementFrame[0][0]);
         ++column)
    {
      for (int row = 0; row < 3; ++row)
      {
        matrix->SetElement(row, column, this->Header->measurementFrame[column][row]);
      }
    }
  }

private:
  Nrrd* Header = nrrdNew();
};
}

Volume ReadMetaImage(const std::string& path, const ReadingOptions& options, Messages& messages)
{
  const auto io = itk::MetaImageIO::New();
  Volume volume = Read(io, path, options);
  volume.Image->GetPointData()->GetScalars()->SetName("MetaImage");
  vtkNew<vtkMatrix4x4> place;
  GetPlace(io, place);
  Place(volume, place, path, options, messages);
  if (!options.FileCoordinates)
  {
    volume.Axes = WorldAxes::LeftPosteriorSuperior;
  }
  return volume;
}

Volume ReadNRRD(const std::string& path, const ReadingOptions& options, Messages& messages)
{
  const auto io = itk::NrrdImageIO::New();
  Volume volume = Read(io, path, options);
  volume.Image->GetPointData()->GetScalars()->SetName("ImageFile");
  const NRRDHeader header(path);
  vtkNew<vtkMatrix4x4> place;
  const bool isPlaced = header.GetPlace(place);
  if (!isPlaced)
  {
    GetPlace(io, place);
  }
  volume.MeasurementFrame = vtkSmartPointer<vtkMatrix3x3>::New();
  header.GetMeasurementFrame(volume.MeasurementFrame);
  if (isPlaced && !options.FileCoordinates)
  {
    volume.Axes = header.GetAxes();
    for (int column = 0; column < 4 && header.IsLeftAnterior(); ++column)
    {
      place->SetElement(1, column, 0.0 - place->GetElement(1, column));
      if (column < 3)
      {
        volume.MeasurementFrame->SetElement(
          1, column, -volume.MeasurementFrame->GetElement(1, column));
      }
    }
  }
  Place(volume, place, path, options, messages);
  return volume;
}
