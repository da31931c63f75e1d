// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeReading.h"

#include "Failure.h"
#include "Files.h"
#include "ImageAxes.h"
#include "Messages.h"
#include "NIfTIReading.h"
#include "ProgressBar.h"
#ifdef DEFORMVOLUME_HAVE_ITK
#include "DICOMReading.h"
#include "MetaImageReading.h"
#include "NRRDReading.h"
#endif

#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLImageDataReader.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <new>

namespace
{
// Whether an array says which voxels are used, and holds no values of the volume.
bool IsMask(vtkDataArray* array)
{
  const std::string name = array->GetName() ? array->GetName() : "";
  return name == vtkDataSetAttributes::GhostArrayName() || name == "vtkValidPointMask" ||
    name == "BoundaryDistance" || name == "CutDistance";
}
}

vtkDataArray* FindNumbers(vtkDataSetAttributes* arrays)
{
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* const array = arrays->GetArray(i);
    if (array && !IsMask(array))
    {
      return array;
    }
  }
  return nullptr;
}

void ChooseScalars(vtkImageData* image, const std::string& path)
{
  vtkPointData* const arrays = image->GetPointData();
  vtkDataArray* const first = FindNumbers(arrays);
  if (!first)
  {
    throw Failure("cannot use " + path + ": its voxels have no numeric array");
  }
  if (!arrays->GetScalars() || IsMask(arrays->GetScalars()))
  {
    arrays->SetScalars(first);
  }
}

namespace
{
// Returns how to convert a file of another format.
std::string GetConversion(const std::string& path)
{
  if (HasSuffix(path, { ".vtr", ".vts", ".vtu" }))
  {
    return "ParaView's filter Resample To Image makes an image of a grid; save that as .vti "
           "(File > Save Data)";
  }
  return HasITK ? "Convert it to one of these, for example with 3D Slicer, or mri_convert for .mgz"
                : "This program was built without ITK, which reads other formats";
}

// Makes an image of the cells of another one: its points are the centers of the cells.
vtkSmartPointer<vtkImageData> MakeImageOfCells(vtkImageData* image)
{
  auto cells = vtkSmartPointer<vtkImageData>::New();
  int extent[6];
  image->GetExtent(extent);
  double half[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    const bool isFlat = extent[2 * axis + 1] == extent[2 * axis];
    extent[2 * axis + 1] -= isFlat ? 0 : 1;
    half[axis] = isFlat ? 0.0 : 0.5;
  }
  double origin[3];
  image->TransformContinuousIndexToPhysicalPoint(half, origin);
  cells->SetExtent(extent);
  cells->SetOrigin(origin);
  cells->SetSpacing(image->GetSpacing());
  cells->SetDirectionMatrix(image->GetDirectionMatrix());
  cells->GetPointData()->ShallowCopy(image->GetCellData());
  cells->GetFieldData()->ShallowCopy(image->GetFieldData());
  if (auto* ghosts = cells->GetPointData()->GetArray(vtkDataSetAttributes::GhostArrayName()))
  {
    vtkNew<vtkUnsignedCharArray> hidden;
    hidden->SetName(ghosts->GetName());
    for (vtkIdType i = 0; i < ghosts->GetNumberOfTuples(); ++i)
    {
      const bool isHidden =
        (static_cast<int>(ghosts->GetComponent(i, 0)) & vtkDataSetAttributes::HIDDENCELL) != 0;
      hidden->InsertNextValue(isHidden ? vtkDataSetAttributes::HIDDENPOINT : 0);
    }
    cells->GetPointData()->AddArray(hidden);
  }
  return cells;
}

Volume ReadVTI(const std::string& path, Messages& messages, bool showProgress)
{
  vtkNew<vtkXMLImageDataReader> reader;
  if (!reader->CanReadFile(path.c_str()))
  {
    throw Failure("cannot read " + path + ": it is not an image file of VTK");
  }
  reader->SetFileName(path.c_str());
  const ProgressBar bar(reader, "reading", showProgress);
  reader->Update();
  messages.Check("cannot read " + path);
  Volume volume;
  volume.Image = vtkSmartPointer<vtkImageData>::New();
  volume.Image->ShallowCopy(reader->GetOutput());
  if (!FindNumbers(volume.Image->GetPointData()) && FindNumbers(volume.Image->GetCellData()))
  {
    volume.Image = MakeImageOfCells(volume.Image);
  }
  return volume;
}
}

int ChooseFrame(const std::string& path, int frames, const ReadingOptions& options)
{
  if (options.Frame ? *options.Frame < frames : frames == 1)
  {
    return options.Frame.value_or(0);
  }
  const std::string last = std::to_string(frames - 1);
  throw Failure("cannot read " + path + ": it holds " +
    (frames == 1 ? std::string("one frame, number 0")
                 : std::to_string(frames) + " frames in time. " +
          (options.CanChooseFrame ? "Choose one of them with --frame 0 to " + last
                                  : "Write one of them to a file of its own")));
}

namespace
{
Volume ReadFile(
  const std::string& path, const ReadingOptions& options, Messages& messages, bool showProgress)
{
  CheckReadable(path, true);
  const bool isFolder = vtksys::SystemTools::FileIsDirectory(path);
  if (!isFolder && HasSuffix(path, { ".nii", ".nii.gz" }))
  {
    return ReadNIfTI(path, options, messages, showProgress);
  }
  if (!isFolder && HasSuffix(path, { ".vti" }))
  {
    ChooseFrame(path, 1, options);
    return ReadVTI(path, messages, showProgress);
  }
#ifdef DEFORMVOLUME_HAVE_ITK
  if (isFolder)
  {
    ChooseFrame(path, 1, options);
    return ReadDICOM(path, options, messages, showProgress);
  }
  if (HasSuffix(path, { ".mhd", ".mha" }))
  {
    return ReadMetaImage(path, options, messages);
  }
  if (HasSuffix(path, { ".nrrd", ".nhdr" }))
  {
    return ReadNRRD(path, options, messages);
  }
#endif
  throw Failure(
    "cannot read " + path + ": a volume is " + ReadFormats + ". " + GetConversion(path));
}
}

Volume ReadVolume(
  const std::string& path, const ReadingOptions& options, Messages& messages, bool showProgress)
{
  Volume volume;
  try
  {
    volume = ReadFile(path, options, messages, showProgress);
  }
  catch (const std::bad_alloc&)
  {
    throw Failure(
      "cannot read " + path + ": its header gives a size that needs more memory than is available");
  }
  int dimensions[3];
  volume.Image->GetDimensions(dimensions);
  if (!options.CanBeFlat && std::min({ dimensions[0], dimensions[1], dimensions[2] }) < 2)
  {
    throw Failure("cannot read " + path + ": it has " + DescribeSize(volume.Image) +
      " voxels, and a volume needs at least two on each axis");
  }
  return volume;
}
