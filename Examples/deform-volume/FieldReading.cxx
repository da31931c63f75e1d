// SPDX-License-Identifier: BSD-3-Clause
#include "FieldReading.h"

#include "Failure.h"
#include "ImageAxes.h"
#include "Messages.h"
#include "NrrdFile.h"
#include "VolumeReading.h"

#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtksys/SystemTools.hxx>

#include <initializer_list>

namespace
{
constexpr int IntentDisplacement = 1006;
constexpr int IntentVector = 1007;

bool HasSuffix(const std::string& path, std::initializer_list<const char*> suffixes)
{
  const std::string name = vtksys::SystemTools::LowerCase(path);
  for (const char* suffix : suffixes)
  {
    if (vtksys::SystemTools::StringEndsWith(name, suffix))
    {
      return true;
    }
  }
  return false;
}

std::string GetShapeText(vtkNIFTIImageHeader* header)
{
  std::string text;
  for (int axis = 1; axis <= header->GetDim(0); ++axis)
  {
    text += (axis > 1 ? ", " : "") + std::to_string(header->GetDim(axis));
  }
  return "(" + text + ")";
}

/// What the shape of a NIfTI file means where it is not that of a field; "" where it is.
std::string FindWrongShape(vtkNIFTIImageHeader* header)
{
  const auto axes = static_cast<int>(header->GetDim(0));
  const auto size = [&](int axis) { return axis <= axes ? header->GetDim(axis) : 1; };
  if (axes == 5 && size(4) == 1 && size(5) == 3)
  {
    return "";
  }
  if (axes == 4 && size(4) == 3)
  {
    return "its vectors lie on the fourth axis, which is that of time. Put them on the fifth "
           "(numpy: data[:, :, :, None, :])";
  }
  if (axes >= 5 && size(4) > 1)
  {
    return "it varies in time. Extract one time step";
  }
  if (axes == 5 && size(5) == 2)
  {
    return "its vectors have two components. Add a third one, 0";
  }
  return axes >= 5 ? "the fifth axis has " + std::to_string(size(5)) + " components"
                   : "it holds one number for each voxel, and no vectors";
}

/// Whether the vectors of a NIfTI file point right, anterior and superior. Throws a Failure where
/// the file is no displacement field in millimetres.
bool IsRightAnterior(vtkNIFTIImageHeader* header, const std::string& what)
{
  const auto intent = static_cast<int>(header->GetIntentCode());
  const char* const name = header->GetIntentName();
  const std::string intentName = name ? name : "";
  if (intent >= 2006 && intent <= 2018)
  {
    throw Failure(what + ": it has an intent of FSL (" + std::to_string(intent) +
      "), whose fields are not in world coordinates. Convert it into a field of ITK first, for "
      "example with wb_command -convert-warpfield");
  }
  if (intentName == "NREG_TRANS" || intentName == "Mapping")
  {
    throw Failure(what + ": by its intent name \"" + intentName + "\" it was written by " +
      (intentName == "Mapping" ? "SPM" : "NiftyReg") +
      " and may hold positions. Subtract the positions of the voxels, and write displacements "
      "with the intent 1006 (RAS) or 1007 (LPS)");
  }
  const std::string reason = FindWrongShape(header);
  if (!reason.empty())
  {
    throw Failure(what + ": its shape is " + GetShapeText(header) +
      ", where a displacement field has (X, Y, Z, 1, 3): " + reason);
  }
  if (intent != IntentDisplacement && intent != IntentVector)
  {
    throw Failure(what + ": its intent is " + std::to_string(intent) +
      ", which does not say how its vectors point. Set intent_code to 1006 if they point right, "
      "anterior, superior, or to 1007 if left, posterior, superior (as ITK and ANTs write them)");
  }
  return intent == IntentDisplacement;
}

/// From the components of an NRRD file to its space.
void GetMeasurementFrame(const NrrdFile& file, const std::string& what, vtkMatrix3x3* matrix)
{
  const std::string text = file.Get("measurement frame");
  const std::vector<double> numbers = FindNumbers(text);
  if (numbers.size() == 9)
  {
    for (int i = 0; i < 9; ++i)
    {
      matrix->SetElement(i % 3, i / 3, numbers[i]);
    }
  }
  else if (!text.empty())
  {
    throw Failure(
      what + ": its measurement frame is " + text + ", where nine numbers are expected");
  }
}

/// Slicer says in NRRD files in which direction a field maps.
void CheckKind(const NrrdFile& file, const std::string& path, bool isInverse, Messages& messages)
{
  const std::string kind = file.Get("displacement field type");
  if ((kind == "resampling" && !isInverse) || (kind == "modeling" && isInverse))
  {
    messages.DisplayWarningText(("The displacement field type of " + path + " is \"" + kind +
      (isInverse ? "\": it is forward, and --field-is-inverse does not go with it."
                 : "\": it is a field from the deformed volume to the volume at rest, which "
                   "goes with --field-is-inverse."))
                                  .c_str());
  }
}

/// The vectors as they are in the world: slope and intercept first, then the matrix.
vtkSmartPointer<vtkDataArray> MakeVectors(
  vtkDataArray* stored, const Volume& field, vtkMatrix3x3* matrix)
{
  const bool isFloat = stored->GetDataType() == VTK_FLOAT;
  // A slope of 0 says that nothing is rescaled.
  const double slope = field.RescaleSlope != 0.0 ? field.RescaleSlope : 1.0;
  const double intercept = field.RescaleSlope != 0.0 ? field.RescaleIntercept : 0.0;
  vtkSmartPointer<vtkDataArray> vectors = stored;
  if (!matrix->IsIdentity() || slope != 1.0 || intercept != 0.0)
  {
    vectors = isFloat ? vtkSmartPointer<vtkDataArray>(vtkSmartPointer<vtkFloatArray>::New())
                      : vtkSmartPointer<vtkDataArray>(vtkSmartPointer<vtkDoubleArray>::New());
    vectors->SetNumberOfComponents(3);
    vectors->SetNumberOfTuples(stored->GetNumberOfTuples());
    for (vtkIdType i = 0; i < stored->GetNumberOfTuples(); ++i)
    {
      double components[3];
      stored->GetTuple(i, components);
      for (double& component : components)
      {
        component = slope * component + intercept;
      }
      double vector[3];
      matrix->MultiplyPoint(components, vector);
      vectors->SetTuple(i, vector);
    }
  }
  vectors->SetName(FieldArrayName);
  return vectors;
}

void FlipWorldAxes(vtkMatrix3x3* matrix)
{
  for (int row = 0; row < 2; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      matrix->SetElement(row, column, -matrix->GetElement(row, column));
    }
  }
}
}

bool IsFieldFile(const std::string& path)
{
  return HasSuffix(path, { ".nii", ".nii.gz", ".mha", ".mhd", ".nrrd", ".nhdr", ".vti" });
}

bool IsVTKFile(const std::string& path)
{
  return HasSuffix(path, { ".vti" });
}

vtkSmartPointer<vtkImageData> ReadField(const std::string& path, const Volume& volume,
  bool isInverse, Messages& messages, bool showProgress)
{
  const std::string what = "cannot use the displacement field " + path;
  if (!vtksys::SystemTools::FileExists(path, true))
  {
    throw Failure(what + ": there is no such file");
  }
  if (!IsFieldFile(path))
  {
    throw Failure(what +
      ": a field is a .nii, .nii.gz, .mha, .mhd, .nrrd, .nhdr or .vti file; convert other "
      "transformations into a displacement field first");
  }
  Volume field = ReadVolume(path, false, messages, showProgress);
  vtkImageData* image = field.Image;
  if (IsVTKFile(path))
  {
    return image;
  }
  vtkNew<vtkMatrix3x3> matrix;
  if (field.NIfTIHeader)
  {
    // The image is right-anterior-superior whatever its vectors are.
    if (!IsRightAnterior(field.NIfTIHeader, what))
    {
      FlipWorldAxes(matrix);
    }
  }
  else if (HasSuffix(path, { ".nrrd", ".nhdr" }))
  {
    const NrrdFile file(path);
    GetMeasurementFrame(file, what, matrix);
    CheckKind(file, path, isInverse, messages);
  }
  vtkDataArray* stored = image->GetPointData()->GetScalars();
  const int components = stored ? stored->GetNumberOfComponents() : 0;
  if (components != 3)
  {
    throw Failure(what + ": it has " + std::to_string(components) +
      " components for each voxel, where a displacement has three");
  }
  if (!field.IsPlaced || field.Axes == WorldAxes::Unknown)
  {
    throw Failure(what +
      ": its header does not say where it lies in the world, in a way that vtkImageData can hold. "
      "It needs perpendicular axes and, as NIfTI, a q-form or s-form, as NRRD the space "
      "left-posterior-superior or right-anterior-superior");
  }
  if (volume.Axes != WorldAxes::Unknown && volume.Axes != field.Axes)
  {
    const vtkSmartPointer<vtkMatrix4x4> axes = GetAxes(image);
    FlipWorldAxes(axes);
    SetAxes(image, axes);
    FlipWorldAxes(matrix);
  }
  const vtkSmartPointer<vtkDataArray> vectors = MakeVectors(stored, field, matrix);
  image->GetPointData()->Initialize();
  image->GetPointData()->SetVectors(vectors);
  return image;
}
