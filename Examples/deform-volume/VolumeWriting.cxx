// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeWriting.h"

#include "ImageAxes.h"
#include "Messages.h"
#include "ProgressBar.h"

#include <vtkMatrix3x3.h>
#include <vtkMetaImageWriter.h>
#include <vtkNIFTIImageWriter.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataWriter.h>
#include <vtksys/SystemTools.hxx>

#include <fstream>
#include <limits>
#include <sstream>

namespace
{
bool HasSuffix(const std::string& path, const char* suffix)
{
  return vtksys::SystemTools::StringEndsWith(vtksys::SystemTools::LowerCase(path), suffix);
}

bool IsNIfTI(const std::string& path)
{
  return HasSuffix(path, ".nii") || HasSuffix(path, ".nii.gz");
}

vtkSmartPointer<vtkMatrix4x4> GetAxesIn(const Volume& volume, WorldAxes axes)
{
  vtkSmartPointer<vtkMatrix4x4> matrix = GetAxes(volume.Image);
  if (volume.Axes != WorldAxes::Unknown && volume.Axes != axes)
  {
    FlipWorldAxes(matrix);
  }
  return matrix;
}

// The same voxels with an extent that starts at 0, for formats that know no other.
vtkSmartPointer<vtkImageData> MoveExtentToZero(vtkImageData* image)
{
  auto moved = vtkSmartPointer<vtkImageData>::New();
  int dimensions[3];
  image->GetDimensions(dimensions);
  moved->SetDimensions(dimensions);
  moved->SetSpacing(image->GetSpacing());
  moved->GetPointData()->ShallowCopy(image->GetPointData());
  if (!moved->GetPointData()->GetScalars() && moved->GetPointData()->GetArray(0))
  {
    moved->GetPointData()->SetActiveScalars(moved->GetPointData()->GetArrayName(0));
  }
  return moved;
}

void WriteNIfTI(const Volume& volume, const std::string& path, bool showProgress)
{
  const auto axes = GetAxesIn(volume, WorldAxes::RightAnteriorSuperior);
  vtkNew<vtkNIFTIImageWriter> writer;
  writer->SetInputData(MoveExtentToZero(volume.Image));
  writer->SetFileName(path.c_str());
  writer->SetSFormMatrix(axes);
  if (axes->Determinant() > 0.0)
  {
    // A q-form holds no reflection.
    writer->SetQFormMatrix(axes);
  }
  writer->SetRescaleSlope(volume.RescaleSlope);
  writer->SetRescaleIntercept(volume.RescaleIntercept);
  const ProgressBar bar(writer, "writing", showProgress);
  writer->Write();
}

// VTK's writer knows no direction: it puts the identity there.
void SetMetaImageDirection(const std::string& path, vtkMatrix4x4* axes)
{
  std::ifstream in(path);
  std::ostringstream header;
  header.precision(std::numeric_limits<double>::max_digits10);
  std::string line;
  while (std::getline(in, line))
  {
    if (line.rfind("TransformMatrix", 0) == 0)
    {
      header << "TransformMatrix =";
      for (int column = 0; column < 3; ++column)
      {
        for (int row = 0; row < 3; ++row)
        {
          header << ' ' << axes->GetElement(row, column);
        }
      }
      header << '\n';
    }
    else
    {
      header << line << '\n';
    }
  }
  in.close();
  std::ofstream out(path, std::ios::trunc);
  out << header.str();
}

void WriteMetaImage(
  const Volume& volume, const std::string& path, Messages& messages, bool showProgress)
{
  const auto axes = GetAxesIn(volume, WorldAxes::LeftPosteriorSuperior);
  auto image = MoveExtentToZero(volume.Image);
  image->SetOrigin(axes->GetElement(0, 3), axes->GetElement(1, 3), axes->GetElement(2, 3));
  vtkNew<vtkMetaImageWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(path.c_str());
  {
    const ProgressBar bar(writer, "writing", showProgress);
    writer->Write();
  }
  messages.Check("cannot write " + path);
  SetMetaImageDirection(path, axes);
}

void WriteVTI(const Volume& volume, const std::string& path, Messages& messages, bool showProgress)
{
  vtkNew<vtkXMLImageDataWriter> writer;
  // Not appended: with recent versions of libexpat, ParaView 5.11 cannot read appended data.
  writer->SetDataModeToBinary();
  writer->SetInputData(volume.Image);
  writer->SetFileName(path.c_str());
  // zlib's fastest level: most of the size at a fraction of the time.
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(1);
  writer->SetHeaderTypeToUInt64();
  const ProgressBar bar(writer, "writing", showProgress);
  const bool written = writer->Write() != 0;
  messages.Check("cannot write " + path, written);
}
}

bool CanWriteVolume(const std::string& path)
{
  return IsNIfTI(path) || HasSuffix(path, ".vti") || HasSuffix(path, ".mhd");
}

void WriteVolume(
  const Volume& volume, const std::string& path, Messages& messages, bool showProgress)
{
  if (IsNIfTI(path))
  {
    WriteNIfTI(volume, path, showProgress);
  }
  else if (HasSuffix(path, ".mhd"))
  {
    WriteMetaImage(volume, path, messages, showProgress);
  }
  else
  {
    WriteVTI(volume, path, messages, showProgress);
  }
  messages.Check("cannot write " + path);
}
