// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeWriting.h"

#include "Failure.h"
#include "Files.h"
#include "ImageAxes.h"
#include "Messages.h"
#include "OutputFile.h"
#include "ProgressBar.h"
#include "VTKWriting.h"
#ifdef DEFORMVOLUME_HAVE_ITK
#include "ItkWriting.h"
#endif

#include <vtkDataArray.h>
#include <vtkNIFTIImageWriter.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkXMLImageDataWriter.h>
#include <vtk_zlib.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <limits>
#include <vector>

namespace
{
bool IsNIfTI(const std::string& path)
{
  return HasSuffix(path, { ".nii", ".nii.gz" });
}

bool IsOfITK([[maybe_unused]] const std::string& path)
{
#ifdef DEFORMVOLUME_HAVE_ITK
  return HasSuffix(path, { ".mhd", ".mha", ".nrrd", ".nhdr" });
#else
  return false;
#endif
}

// Returns the axes for all formats but .vti. Only .vti files have negative spacings: in the other
// formats, the directions are negated instead.
vtkSmartPointer<vtkMatrix4x4> GetAxesIn(const Volume& volume, WorldAxes axes)
{
  vtkSmartPointer<vtkMatrix4x4> matrix = GetAxes(volume.Image);
  for (int i = 0; i < 9; ++i)
  {
    if (volume.Image->GetSpacing()[i % 3] < 0.0)
    {
      matrix->SetElement(i / 3, i % 3, 0.0 - matrix->GetElement(i / 3, i % 3));
    }
  }
  if (volume.Axes != WorldAxes::Unknown && volume.Axes != axes)
  {
    FlipWorldAxes(matrix);
  }
  return matrix;
}

// Returns the same voxels with an extent that starts at 0 and positive spacings, for the axes of
// GetAxesIn.
vtkSmartPointer<vtkImageData> MoveExtentToZero(vtkImageData* image)
{
  auto moved = vtkSmartPointer<vtkImageData>::New();
  int dimensions[3];
  image->GetDimensions(dimensions);
  moved->SetDimensions(dimensions);
  const double* const spacing = image->GetSpacing();
  moved->SetSpacing(std::abs(spacing[0]), std::abs(spacing[1]), std::abs(spacing[2]));
  moved->GetPointData()->ShallowCopy(image->GetPointData());
  if (!moved->GetPointData()->GetScalars() && moved->GetPointData()->GetArray(0))
  {
    moved->GetPointData()->SetActiveScalars(moved->GetPointData()->GetArrayName(0));
  }
  return moved;
}

// Warns if the single precision of a NIfTI header shifts the voxels of an image.
void WarnOfRounding(vtkImageData* image, const std::string& path, Messages& messages)
{
  double largest = 0.0; // coordinate
  for (int i = 0; i < 6; ++i)
  {
    largest = std::max(largest, std::abs(image->GetBounds()[i]));
  }
  const double* const spacing = image->GetSpacing();
  const double smallest =
    std::min({ std::abs(spacing[0]), std::abs(spacing[1]), std::abs(spacing[2]) });
  const double rounding = largest * std::numeric_limits<float>::epsilon();
  constexpr double precisionOfResampling = 1.0 / 256.0; // in voxels
  if (rounding > precisionOfResampling * smallest)
  {
    messages.Warn(MakeText(std::setprecision(3),
      "NIfTI files hold positions in single precision, which shifts voxels of ", path, " by up to ",
      rounding, ", ", rounding / smallest, " times the smallest spacing. Write ",
      HasITK ? ".nrrd or .mhd" : ".vti", ", or subtract an offset from all coordinates."));
  }
}

template <typename Integer, typename Real>
void PutForms(std::fstream& file, const NIfTIForms& forms, int codes, int spacing)
{
  const Integer both[] = { static_cast<Integer>(forms.QFormCode),
    static_cast<Integer>(forms.SFormCode) };
  file.seekp(codes);
  file.write(reinterpret_cast<const char*>(both), sizeof(both));
  if (forms.QForm)
  {
    const Real lengths[] = { static_cast<Real>(forms.QSpacing[0]),
      static_cast<Real>(forms.QSpacing[1]), static_cast<Real>(forms.QSpacing[2]) };
    file.seekp(spacing);
    file.write(reinterpret_cast<const char*>(lengths), sizeof(lengths));
  }
}

// Corrects the header that VTK's writer has written, which has fixed codes for the two forms, and
// the spacing of the s-form for both.
bool SetForms(const std::string& path, const NIfTIForms& forms)
{
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  std::int32_t headerSize = 0;
  file.read(reinterpret_cast<char*>(&headerSize), sizeof(headerSize));
  constexpr std::int32_t headerSizeOfVersion1 = 348;
  if (headerSize == headerSizeOfVersion1)
  {
    PutForms<std::int16_t, float>(file, forms, 252, 80);
  }
  else
  {
    PutForms<std::int32_t, double>(file, forms, 344, 112);
  }
  file.close();
  return !file.fail();
}

bool Compress(const std::string& from, const std::string& to)
{
  std::ifstream in(from, std::ios::binary);
  gzFile out = gzopen(to.c_str(), "wb");
  bool written = in && out;
  std::vector<char> part(std::size_t{ 1 } << 20);
  while (written && in)
  {
    in.read(part.data(), static_cast<std::streamsize>(part.size()));
    const auto count = static_cast<unsigned int>(in.gcount());
    written = count == 0 || gzwrite(out, part.data(), count) == static_cast<int>(count);
  }
  return (!out || gzclose(out) == Z_OK) && written;
}

// Moves the q-form of the volume to the first voxel of the result.
void MoveQForm(const Volume& volume, vtkMatrix4x4* qform)
{
  vtkNew<vtkMatrix4x4> shift;
  int extent[6];
  volume.Image->GetExtent(extent);
  for (int axis = 0; axis < 3; ++axis)
  {
    shift->SetElement(axis, 3, extent[2 * axis] * volume.Forms.QSpacing[axis]);
  }
  vtkMatrix4x4::Multiply4x4(volume.Forms.QForm, shift, qform);
}

// Returns the intent code of the volume, or that of its file. ITK reads several components as a
// vector only if the intent says so; colors have types of their own.
int GetIntentCode(const Volume& volume, vtkDataArray* values)
{
  const int components = values->GetNumberOfComponents();
  const bool areColors =
    values->GetDataType() == VTK_UNSIGNED_CHAR && (components == 3 || components == 4);
  if (volume.IntentCode != 0 || components == 1 || areColors)
  {
    return volume.IntentCode;
  }
  const auto ofFile =
    volume.NIfTIHeader ? static_cast<int>(volume.NIfTIHeader->GetIntentCode()) : 0;
  return ofFile != 0 ? ofFile : NIfTIIntentVector;
}

// Replaces scalars of the type vtkIdType, which the writer of VTK does not know.
void ConvertIds(vtkImageData* image)
{
  vtkDataArray* const ids = image->GetPointData()->GetScalars();
  if (ids->GetDataType() == VTK_ID_TYPE)
  {
    const auto values =
      vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(VTK_LONG_LONG));
    values->DeepCopy(ids);
    image->GetPointData()->SetScalars(values);
  }
}

void WriteNIfTI(
  const Volume& volume, const std::string& path, Messages& messages, bool showProgress)
{
  const vtkSmartPointer<vtkImageData> image = MoveExtentToZero(volume.Image);
  ConvertIds(image);
  vtkDataArray* const values = image->GetPointData()->GetScalars();
  const bool isReal = values->GetDataType() == VTK_FLOAT || values->GetDataType() == VTK_DOUBLE;
  if (values->GetNumberOfComponents() == 2 && isReal)
  {
    throw Failure("cannot write " + path +
      ": its vectors of two components would be complex numbers in a NIfTI file. Write .nrrd or "
      ".mha");
  }
  const bool isCompressed = HasSuffix(path, { ".gz" });
  OutputFile file(path);
  const std::string plain = file.GetPath() + (isCompressed ? ".part.nii" : "");
  const auto axes = GetAxesIn(volume, WorldAxes::RightAnteriorSuperior);
  WarnOfRounding(volume.Image, path, messages);
  const NIfTIForms& forms = volume.Forms;
  const bool keepsForms = forms.SFormCode != 0 || forms.QFormCode != 0;
  vtkNew<vtkNIFTIImageHeader> header;
  header->SetXYZTUnits(vtkNIFTIImageHeader::UnitsMM);
  header->SetIntentCode(GetIntentCode(volume, values));
  vtkNew<vtkNIFTIImageWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(plain.c_str());
  writer->SetNIFTIHeader(header);
  vtkNew<vtkMatrix4x4> qform;
  qform->DeepCopy(axes);
  if (forms.QForm)
  {
    MoveQForm(volume, qform);
  }
  if (!keepsForms || forms.QForm)
  {
    // If the axes of the q-form are left-handed, the writer wants its data in reverse order, and
    // reverses them again.
    if (qform->Determinant() < 0.0)
    {
      // The writer moves both forms back by the spacing of the image.
      const double depth = (image->GetDimensions()[2] - 1) * image->GetSpacing()[2];
      ReverseSlices(image);
      ReverseSlices(axes, depth);
      ReverseSlices(qform, depth);
      writer->SetQFac(-1.0);
    }
    writer->SetQFormMatrix(qform);
  }
  if (!keepsForms || forms.SFormCode != 0)
  {
    writer->SetSFormMatrix(axes);
  }
  {
    const ProgressBar bar(writer, "writing", showProgress);
    writer->Write();
  }
  bool written = !keepsForms || SetForms(plain, forms);
  if (isCompressed)
  {
    written = written && Compress(plain, file.GetPath());
    if (!written)
    {
      messages.DisplayErrorText(std::strerror(errno));
    }
    vtksys::SystemTools::RemoveFile(plain);
  }
  file.Finish(messages, written);
}

void WriteVTI(const Volume& volume, const std::string& path, Messages& messages, bool showProgress)
{
  vtkNew<vtkXMLImageDataWriter> writer;
  // The fastest level of zlib achieves most of the compression.
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(1);
  writer->SetHeaderTypeToUInt64();
  const ProgressBar bar(writer, "writing", showProgress);
  OutputFile file(path);
  file.Finish(messages, WriteXML(writer.Get(), volume.Image, file.GetPath()));
}
}

bool CanWriteVolume(const std::string& path)
{
  return IsNIfTI(path) || HasSuffix(path, { ".vti" }) || IsOfITK(path);
}

void WriteVolume(
  const Volume& volume, const std::string& path, Messages& messages, bool showProgress)
{
  if (IsNIfTI(path))
  {
    WriteNIfTI(volume, path, messages, showProgress);
  }
  else if (HasSuffix(path, { ".vti" }))
  {
    WriteVTI(volume, path, messages, showProgress);
  }
#ifdef DEFORMVOLUME_HAVE_ITK
  else
  {
    const auto axes = GetAxesIn(volume, WorldAxes::LeftPosteriorSuperior);
    OutputFile file(path);
    const std::string fault = WriteByITK(MoveExtentToZero(volume.Image), axes, file.GetPath());
    if (!fault.empty())
    {
      messages.DisplayErrorText(fault.c_str());
    }
    file.Finish(messages, fault.empty());
  }
#endif
}
