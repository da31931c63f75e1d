// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeReading.h"

#include "Failure.h"
#include "ImageAxes.h"
#include "Messages.h"
#include "NrrdFile.h"
#include "ProgressBar.h"

#include <vtkDICOMImageReader.h>
#include <vtkImageReader2.h>
#include <vtkMath.h>
#include <vtkMetaImageReader.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkNrrdReader.h>
#include <vtkXMLImageDataReader.h>
#include <vtksys/SystemTools.hxx>

#include <array>

namespace
{
template <typename Reader>
vtkSmartPointer<vtkImageData> Update(
  Reader* reader, const std::string& path, Messages& messages, bool showProgress)
{
  const ProgressBar bar(reader, "reading", showProgress);
  reader->Update();
  messages.Check("cannot read " + path);
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->ShallowCopy(reader->GetOutput());
  if (image->GetNumberOfPoints() == 0)
  {
    throw Failure("cannot read " + path + ": it holds no voxels");
  }
  return image;
}

Volume ReadNIfTI(
  const std::string& path, bool fileCoordinates, Messages& messages, bool showProgress)
{
  vtkNew<vtkNIFTIImageReader> reader;
  if (!reader->CanReadFile(path.c_str()))
  {
    throw Failure("cannot read " + path + ": it is no NIfTI file");
  }
  reader->SetFileName(path.c_str());
  Volume volume;
  volume.Image = Update(reader.Get(), path, messages, showProgress);
  volume.RescaleSlope = reader->GetRescaleSlope();
  volume.RescaleIntercept = reader->GetRescaleIntercept();
  volume.NIfTIHeader = reader->GetNIFTIHeader();
  if (!fileCoordinates)
  {
    vtkMatrix4x4* sform = reader->GetSFormMatrix();
    vtkMatrix4x4* qform = reader->GetQFormMatrix();
    if ((sform && SetAxes(volume.Image, sform)) || (qform && SetAxes(volume.Image, qform)))
    {
      volume.Axes = WorldAxes::RightAnteriorSuperior;
    }
    else
    {
      volume.IsPlaced = false;
    }
    if (!volume.IsPlaced && (sform || qform))
    {
      messages.DisplayWarningText("The axes of the NIfTI file are not perpendicular, which "
                                  "vtkImageData cannot hold: origin 0 and no direction are used.");
    }
  }
  return volume;
}

// Direction cosines that a text header gives, three for each index axis.
void SetDirection(Volume& volume, const std::vector<double>& cosines, bool lengthIsSpacing,
  const std::string& path, Messages& messages)
{
  volume.IsPlaced = false;
  if (cosines.size() != 9)
  {
    return;
  }
  vtkImageData* image = volume.Image;
  vtkNew<vtkMatrix4x4> axes;
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      axes->SetElement(row, column, cosines[3 * column + row]);
    }
    axes->SetElement(row, 3, image->GetOrigin()[row]);
  }
  if (lengthIsSpacing)
  {
    image->SetSpacing(1.0, 1.0, 1.0);
  }
  volume.IsPlaced = SetAxes(image, axes);
  if (!volume.IsPlaced)
  {
    messages.DisplayWarningText(
      ("The axes of " + path + " are not perpendicular: no direction is used.").c_str());
  }
}

Volume ReadMetaImage(
  const std::string& path, bool fileCoordinates, Messages& messages, bool showProgress)
{
  vtkNew<vtkMetaImageReader> reader;
  if (!reader->CanReadFile(path.c_str()))
  {
    throw Failure("cannot read " + path + ": it is no MetaImage file");
  }
  reader->SetFileName(path.c_str());
  Volume volume;
  volume.Image = Update(reader.Get(), path, messages, showProgress);
  if (!fileCoordinates)
  {
    volume.Axes = WorldAxes::LeftPosteriorSuperior;
    for (const char* name : { "TransformMatrix", "Rotation", "Orientation" })
    {
      const std::string field = ReadHeaderField(path, name, '=');
      if (!field.empty())
      {
        SetDirection(volume, FindNumbers(field), false, path, messages);
        break;
      }
    }
  }
  return volume;
}

Volume ReadNrrd(
  const std::string& path, bool fileCoordinates, Messages& messages, bool showProgress)
{
  Volume volume;
  const NrrdFile file(path);
  if (file.GetNumberOfAxes() == 4)
  {
    volume.Image = file.ReadVectors();
  }
  else
  {
    vtkNew<vtkNrrdReader> reader;
    if (!reader->CanReadFile(path.c_str()))
    {
      throw Failure("cannot read " + path + ": it is no NRRD file that VTK can read");
    }
    reader->SetFileName(path.c_str());
    volume.Image = Update(reader.Get(), path, messages, showProgress);
  }
  if (!fileCoordinates)
  {
    const std::vector<double> origin = FindNumbers(file.Get("space origin"));
    if (origin.size() == 3)
    {
      volume.Image->SetOrigin(origin.data());
    }
    SetDirection(volume, FindNumbers(file.Get("space directions")), true, path, messages);
    const std::string space = vtksys::SystemTools::LowerCase(file.Get("space"));
    if (space.find("left-posterior-superior") != std::string::npos ||
      space.find("lps") != std::string::npos)
    {
      volume.Axes = WorldAxes::LeftPosteriorSuperior;
    }
    else if (space.find("right-anterior-superior") != std::string::npos ||
      space.find("ras") != std::string::npos)
    {
      volume.Axes = WorldAxes::RightAnteriorSuperior;
    }
  }
  return volume;
}

Volume ReadVTI(const std::string& path, Messages& messages, bool showProgress)
{
  vtkNew<vtkXMLImageDataReader> reader;
  if (!reader->CanReadFile(path.c_str()))
  {
    throw Failure("cannot read " + path + ": it is no image file of VTK");
  }
  reader->SetFileName(path.c_str());
  Volume volume;
  volume.Image = Update(reader.Get(), path, messages, showProgress);
  return volume;
}

// VTK's reader puts the last row first, and the slice with the highest position along the normal of
// the slices; it tells the position of the slice that it has read last.
void SetDICOMAxes(vtkDICOMImageReader* reader, Volume& volume)
{
  const float* row = reader->GetImageOrientationPatient();
  const float* column = row + 3;
  const float* position = reader->GetImagePositionPatient();
  float normal[3];
  vtkMath::Cross(row, column, normal);
  if (!(vtkMath::Norm(normal) > 0.0F))
  {
    return;
  }
  int dimensions[3];
  volume.Image->GetDimensions(dimensions);
  const double* spacing = volume.Image->GetSpacing();
  vtkNew<vtkMatrix4x4> axes;
  for (int i = 0; i < 3; ++i)
  {
    axes->SetElement(i, 0, row[i]);
    axes->SetElement(i, 1, -column[i]);
    axes->SetElement(i, 2, -normal[i]);
    axes->SetElement(i, 3,
      position[i] + (dimensions[1] - 1) * spacing[1] * column[i] +
        (dimensions[2] - 1) * spacing[2] * normal[i]);
  }
  if (SetAxes(volume.Image, axes))
  {
    volume.Axes = WorldAxes::LeftPosteriorSuperior;
  }
}

Volume ReadDICOM(
  const std::string& path, bool fileCoordinates, Messages& messages, bool showProgress)
{
  vtkNew<vtkDICOMImageReader> reader;
  reader->SetDirectoryName(path.c_str());
  Volume volume;
  reader->UpdateInformation();
  if (reader->GetWidth() < 1 || reader->GetHeight() < 1)
  {
    throw Failure("cannot read " + path +
      ": the folder holds no DICOM slices that VTK can read "
      "(one uncompressed series)");
  }
  volume.Image = Update(reader.Get(), path, messages, showProgress);
  if (!fileCoordinates)
  {
    SetDICOMAxes(reader, volume);
  }
  return volume;
}
}

Volume ReadVolume(
  const std::string& path, bool fileCoordinates, Messages& messages, bool showProgress)
{
  if (!vtksys::SystemTools::FileExists(path))
  {
    throw Failure("cannot read " + path + ": there is no such file or folder");
  }
  Volume volume;
  const std::string name = vtksys::SystemTools::LowerCase(path);
  const auto endsWith = [&name](const char* suffix)
  { return vtksys::SystemTools::StringEndsWith(name, suffix); };
  if (vtksys::SystemTools::FileIsDirectory(path))
  {
    volume = ReadDICOM(path, fileCoordinates, messages, showProgress);
  }
  else if (endsWith(".nii") || endsWith(".nii.gz"))
  {
    volume = ReadNIfTI(path, fileCoordinates, messages, showProgress);
  }
  else if (endsWith(".mhd") || endsWith(".mha"))
  {
    volume = ReadMetaImage(path, fileCoordinates, messages, showProgress);
  }
  else if (endsWith(".nrrd") || endsWith(".nhdr"))
  {
    volume = ReadNrrd(path, fileCoordinates, messages, showProgress);
  }
  else if (endsWith(".vti"))
  {
    volume = ReadVTI(path, messages, showProgress);
  }
  else
  {
    throw Failure("cannot read " + path +
      ": a volume is a .nii, .nii.gz, .mhd, .mha, .nrrd, .nhdr or .vti file, or a folder with the "
      "slices of one DICOM series");
  }
  return volume;
}
