// SPDX-License-Identifier: BSD-3-Clause
// VTK's reader decodes NIfTI files: it reads version 2, and returns both forms as they are in the
// file, even if they are sheared. ITK 5.2 refuses version 2, and replaces a sheared s-form by the
// q-form without a warning.
#include "NIfTIReading.h"

#include "Failure.h"
#include "ImageAxes.h"
#include "Messages.h"
#include "ProgressBar.h"

#include <vtkCallbackCommand.h>
#include <vtkDataArray.h>
#include <vtkDataArrayRange.h>
#include <vtkMath.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtk_zlib.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace
{
// Whether the values must be rescaled. A slope of 0 means that they are not; colors never are.
bool IsScaled(vtkNIFTIImageHeader* header)
{
  const double slope = header->GetSclSlope();
  const int type = header->GetDataType();
  return slope != 0.0 && !std::isnan(slope) && type != vtkNIFTIImageHeader::TypeRGB24 &&
    type != vtkNIFTIImageHeader::TypeRGBA32;
}

// The unit of length of a header, in mm; 0 if the unit is not known.
double GetMillimetres(vtkNIFTIImageHeader* header)
{
  switch (header->GetXYZTUnits() & vtkNIFTIImageHeader::UnitsSpace)
  {
    case vtkNIFTIImageHeader::UnitsUnknown: // nearly all such files are in mm
    case vtkNIFTIImageHeader::UnitsMM:
      return 1.0;
    case vtkNIFTIImageHeader::UnitsMeter:
      return 1000.0;
    case vtkNIFTIImageHeader::UnitsMicron:
      return 0.001;
    default:
      return 0.0;
  }
}

[[noreturn]] void Fail(const std::string& path, const std::string& reason)
{
  throw Failure("cannot read " + path + ": " + reason);
}

// Refuses types of values that VTK's reader does not know: it may crash when it reads the header.
// So this function reads the type itself, from version 1 or 2, in either byte order.
void CheckType(const std::string& path)
{
  constexpr std::size_t size = 72;
  unsigned char bytes[size] = {};
  if (const gzFile file = gzopen(path.c_str(), "rb"))
  {
    gzread(file, bytes, size);
    gzclose(file);
  }
  // The header begins with its size: 348 or 540, in four bytes.
  const bool isBigEndian = bytes[0] == 0;
  const bool isVersion2 = bytes[isBigEndian ? 3 : 0] == 540 % 256;
  const unsigned char* const place = bytes + (isVersion2 ? 12 : 70); // offset of the field datatype
  using Header = vtkNIFTIImageHeader;
  const int types[] = { Header::TypeUInt8, Header::TypeInt8, Header::TypeUInt16, Header::TypeInt16,
    Header::TypeUInt32, Header::TypeInt32, Header::TypeUInt64, Header::TypeInt64,
    Header::TypeFloat32, Header::TypeFloat64, Header::TypeRGB24, Header::TypeRGBA32 };
  const int type = isBigEndian ? place[0] << 8 | place[1] : place[1] << 8 | place[0];
  if (std::find(std::begin(types), std::end(types), type) == std::end(types))
  {
    const bool isComplex = type == Header::TypeComplex64 || type == Header::TypeComplex128;
    Fail(path,
      "its values are " + (isComplex ? "complex" : "of NIfTI's type " + std::to_string(type)) +
        ", which a volume of VTK cannot hold");
  }
}

// Refuses files that VTK's reader misreads without an error.
void CheckHeader(vtkNIFTIImageHeader* header, const std::string& path)
{
  const std::string magic = header->GetMagic();
  if (magic != "n+1" && magic != "n+2")
  {
    Fail(path, "it is not a NIfTI file with voxels (its magic is not n+1 or n+2)");
  }
  const auto axes = header->GetDim(0);
  for (int axis = 1; axis <= std::min<vtkTypeInt64>(axes, 7); ++axis)
  {
    const auto size = header->GetDim(axis);
    if (size < 1)
    {
      Fail(path, "its axis " + std::to_string(axis) + " has the length " + std::to_string(size));
    }
    if ((axis > 5 && size > 1) || axes > 7)
    {
      Fail(path,
        "it has " + std::to_string(axes) +
          " axes. A volume has three axes of space, one of time and one of components");
    }
  }
  const vtkTypeInt64 headerSize = magic == "n+1" ? 352 : 544;
  if (header->GetVoxOffset() < headerSize)
  {
    Fail(path,
      "its header gives the byte " + std::to_string(header->GetVoxOffset()) +
        ", within the header, as the begin of the voxels");
  }
  // A slope of NaN is allowed: nibabel and SPM do not rescale then.
  if (std::isinf(header->GetSclSlope()) ||
    (IsScaled(header) && !std::isfinite(header->GetSclInter())))
  {
    Fail(path, "its slope or intercept is not finite");
  }
  const double quaternion[] = { header->GetQuaternB(), header->GetQuaternC(),
    header->GetQuaternD() };
  constexpr double rounding = 1e-5;
  if (header->GetQFormCode() > 0 && vtkMath::Dot(quaternion, quaternion) > 1.0 + rounding)
  {
    Fail(path, "the quaternion of its q-form is longer than 1");
  }
  for (int axis = 1; axis <= 3 && header->GetSFormCode() <= 0; ++axis)
  {
    if (!(header->GetPixDim(axis) > 0.0))
    {
      Fail(path,
        "its header gives the voxel spacing " + std::to_string(header->GetPixDim(axis)) +
          " on axis " + std::to_string(axis - 1));
    }
  }
}

bool IsInteger(vtkDataArray* array)
{
  return array->GetDataType() != VTK_FLOAT && array->GetDataType() != VTK_DOUBLE;
}

// The type for stored * slope + intercept: an integer type if all three are integers and VTK_INT or
// the stored type can hold the range, otherwise a floating-point type.
int ChooseType(vtkDataArray* stored, double slope, double intercept)
{
  const int type = stored->GetDataType();
  const bool isWide = stored->GetDataTypeSize() > 4 || type == VTK_INT || type == VTK_UNSIGNED_INT;
  if (!IsInteger(stored) || slope != std::floor(slope) || intercept != std::floor(intercept))
  {
    return isWide ? VTK_DOUBLE : VTK_FLOAT;
  }
  double minimum = 0.0;
  double maximum = 0.0;
  for (int component = 0; component < stored->GetNumberOfComponents(); ++component)
  {
    for (const double end : { stored->GetRange(component)[0], stored->GetRange(component)[1] })
    {
      minimum = std::min(minimum, end * slope + intercept);
      maximum = std::max(maximum, end * slope + intercept);
    }
  }
  for (const int candidate : { type, VTK_SHORT, VTK_INT })
  {
    if (minimum >= vtkDataArray::GetDataTypeMin(candidate) &&
      maximum <= vtkDataArray::GetDataTypeMax(candidate))
    {
      return candidate;
    }
  }
  return VTK_DOUBLE;
}

void Rescale(vtkImageData* image, double slope, double intercept)
{
  vtkDataArray* stored = image->GetPointData()->GetScalars();
  const auto values = vtkSmartPointer<vtkDataArray>::Take(
    vtkDataArray::CreateDataArray(ChooseType(stored, slope, intercept)));
  values->SetName(stored->GetName());
  values->SetNumberOfComponents(stored->GetNumberOfComponents());
  values->SetNumberOfTuples(stored->GetNumberOfTuples());
  const auto from = vtk::DataArrayValueRange(stored);
  auto to = vtk::DataArrayValueRange(values.Get());
  for (vtkIdType i = 0; i < from.size(); ++i)
  {
    to[i] = static_cast<double>(from[i]) * slope + intercept;
  }
  image->GetPointData()->SetScalars(values);
}

// Keeps one of several frames. The reader has stored the frames as components.
void KeepFrame(vtkImageData* image, int frame, int frames)
{
  vtkDataArray* all = image->GetPointData()->GetScalars();
  const auto one = vtkSmartPointer<vtkDataArray>::Take(all->NewInstance());
  one->SetName(all->GetName());
  const int components = all->GetNumberOfComponents() / frames;
  one->SetNumberOfComponents(components);
  one->SetNumberOfTuples(all->GetNumberOfTuples());
  for (int component = 0; component < components; ++component)
  {
    one->CopyComponent(component, all, frame * components + component);
  }
  image->GetPointData()->SetScalars(one);
}

void ScalePlace(vtkMatrix4x4* form, double factor)
{
  for (int row = 0; row < 3; ++row)
  {
    form->SetElement(row, 3, form->GetElement(row, 3) * factor);
  }
}

// Sets spacing, axes, forms and world axes of the volume.
void Place(Volume& volume, vtkNIFTIImageReader* reader, const std::string& path, double millimetres,
  Messages& messages)
{
  double spacing[3];
  volume.Image->GetSpacing(spacing);
  for (double& length : spacing)
  {
    length *= millimetres;
  }
  volume.Image->SetSpacing(std::abs(spacing[0]), std::abs(spacing[1]), std::abs(spacing[2]));
  // The matrices of the reader refer to the slices in its order, which is reversed if QFac is
  // negative.
  const bool isReversed = reader->GetQFac() < 0.0;
  const int steps = volume.Image->GetDimensions()[2] - 1;
  vtkMatrix4x4* const sform = reader->GetSFormMatrix();
  vtkMatrix4x4* const qform = reader->GetQFormMatrix();
  if (qform)
  {
    volume.Forms.QFormCode = static_cast<int>(reader->GetNIFTIHeader()->GetQFormCode());
    volume.Forms.QForm = vtkSmartPointer<vtkMatrix4x4>::New();
    volume.Forms.QForm->DeepCopy(qform);
    ScalePlace(volume.Forms.QForm, millimetres);
    std::copy_n(spacing, 3, volume.Forms.QSpacing);
    if (isReversed)
    {
      ReverseSlices(volume.Forms.QForm, steps * spacing[2]);
    }
  }
  if (sform)
  {
    volume.Forms.SFormCode = static_cast<int>(reader->GetNIFTIHeader()->GetSFormCode());
    vtkNew<vtkMatrix4x4> axes;
    axes->DeepCopy(sform);
    ScalePlace(axes, millimetres);
    for (int i = 0; i < 9; ++i)
    {
      // The reader has divided by the signed spacing, but the spacing of the image is positive.
      axes->SetElement(
        i / 3, i % 3, axes->GetElement(i / 3, i % 3) * (spacing[i % 3] < 0.0 ? -1.0 : 1.0));
    }
    if (isReversed)
    {
      ReverseSlices(axes, steps * std::abs(spacing[2]));
    }
    SetAxes(volume.Image, axes, path, messages,
      qform ? ". These are the axes of its s-form. It also has a q-form: to use that, set "
              "sform_code to 0"
            : "");
  }
  else if (qform)
  {
    SetAxes(volume.Image, volume.Forms.QForm, path, messages);
  }
  volume.Axes = sform || qform ? WorldAxes::RightAnteriorSuperior : WorldAxes::Unknown;
}
}

Volume ReadNIfTI(
  const std::string& path, const ReadingOptions& options, Messages& messages, bool showProgress)
{
  vtkNew<vtkNIFTIImageReader> reader;
  // Ignore warnings: the reader warns if only one of the two forms is a reflection, but reads such
  // files correctly.
  const vtkNew<vtkCallbackCommand> ignore;
  reader->AddObserver(vtkCommand::WarningEvent, ignore);
  if (!reader->CanReadFile(path.c_str()))
  {
    Fail(path, "it is not a NIfTI file");
  }
  CheckType(path);
  reader->SetFileName(path.c_str());
  reader->UpdateInformation();
  Volume volume;
  volume.NIfTIHeader = reader->GetNIFTIHeader();
  CheckHeader(volume.NIfTIHeader, path);
  messages.Check("cannot read " + path);
  const double millimetres = GetMillimetres(volume.NIfTIHeader);
  if (millimetres == 0.0)
  {
    Fail(path,
      "its unit of length, " + std::to_string(volume.NIfTIHeader->GetXYZTUnits()) +
        " of xyzt_units, is not known");
  }
  const auto axes = static_cast<int>(volume.NIfTIHeader->GetDim(0));
  const int frames = axes >= 4 ? static_cast<int>(volume.NIfTIHeader->GetDim(4)) : 1;
  const int frame = ChooseFrame(path, frames, options);
  // The reader reads either the first frame or all frames.
  reader->SetTimeAsVector(frame > 0);
  {
    const ProgressBar bar(reader, "reading", showProgress);
    reader->Update();
  }
  messages.Check("cannot read " + path);
  volume.Image = vtkSmartPointer<vtkImageData>::New();
  volume.Image->ShallowCopy(reader->GetOutput());
  if (frame > 0)
  {
    KeepFrame(volume.Image, frame, frames);
  }
  const double slope = volume.NIfTIHeader->GetSclSlope();
  const double intercept = volume.NIfTIHeader->GetSclInter();
  if (IsScaled(volume.NIfTIHeader) && (slope != 1.0 || intercept != 0.0))
  {
    Rescale(volume.Image, slope, intercept);
  }
  if (options.FileCoordinates)
  {
    return volume;
  }
  // If the axes of the q-form are left-handed, or without a q-form those of the s-form, the reader
  // reverses the order of the slices. The result shall have the grid of the file.
  if (reader->GetQFac() < 0.0)
  {
    ReverseSlices(volume.Image);
  }
  Place(volume, reader, path, millimetres, messages);
  return volume;
}
