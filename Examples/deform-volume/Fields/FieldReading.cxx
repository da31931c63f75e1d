// SPDX-License-Identifier: BSD-3-Clause
#include "FieldReading.h"

#include "Failure.h"
#include "Files.h"
#include "ImageAxes.h"
#include "MeshSpace.h"
#include "Messages.h"
#include "VolumeReading.h"
#include "WorldSpace.h"

#include <vtkDataArray.h>
#include <vtkMath.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace
{
constexpr int IntentDisplacement = 1006;

std::string GetShapeText(vtkNIFTIImageHeader* header)
{
  std::string text;
  for (int axis = 1; axis <= header->GetDim(0); ++axis)
  {
    text += (axis > 1 ? ", " : "") + std::to_string(header->GetDim(axis));
  }
  return "(" + text + ")";
}

/// Returns why the shape of a NIfTI file is not that of a field; "" if it is.
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

[[noreturn]] void RefuseUnit(const std::string& unit, const std::string& what)
{
  throw Failure(what + ": its unit of length is " + unit +
    ", so the unit of its vectors is not known. Write the file in mm");
}

/// Whether the vectors of a NIfTI file point right, anterior and superior. Throws a Failure if the
/// file is not a displacement field in mm.
bool IsRightAnterior(vtkNIFTIImageHeader* header, const std::string& what)
{
  const int unit = header->GetXYZTUnits() & vtkNIFTIImageHeader::UnitsSpace;
  if (unit == vtkNIFTIImageHeader::UnitsMeter || unit == vtkNIFTIImageHeader::UnitsMicron)
  {
    RefuseUnit(unit == vtkNIFTIImageHeader::UnitsMeter ? "the metre" : "the micrometre", what);
  }
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
      ", but a displacement field has the shape (X, Y, Z, 1, 3): " + reason);
  }
  if (intent != IntentDisplacement && intent != NIfTIIntentVector)
  {
    throw Failure(what + ": its intent is " + std::to_string(intent) +
      ", which does not say how its vectors point. Set intent_code to 1006 if they point right, "
      "anterior, superior, or to 1007 if left, posterior, superior (as ITK and ANTs write them)");
  }
  return intent == IntentDisplacement;
}

/// Warns if the direction of a field, which 3D Slicer writes into NRRD files, is not that of the
/// options.
void CheckKind(const Volume& field, const std::string& path, bool isInverse, Messages& messages)
{
  const auto found = field.Fields.find("displacement field type");
  const std::string kind = found == field.Fields.end() ? "" : found->second;
  if ((kind == "resampling" && !isInverse) || (kind == "modeling" && isInverse))
  {
    messages.Warn("The displacement field type of " + path + " is \"" + kind +
      (isInverse ? "\": it is a forward field. Give it with --field, without "
                   "--field-is-inverse."
                 : "\": it leads from the deformed volume to the volume at rest, and needs "
                   "--field-is-inverse."));
  }
}

/// Applies a matrix to vectors. Returns a new float or double array, or `stored` if the matrix is
/// the identity.
vtkSmartPointer<vtkDataArray> Turn(vtkDataArray* stored, vtkMatrix3x3* matrix)
{
  if (matrix->IsIdentity())
  {
    return stored;
  }
  const auto vectors = vtkSmartPointer<vtkDataArray>::Take(
    vtkDataArray::CreateDataArray(stored->GetDataType() == VTK_FLOAT ? VTK_FLOAT : VTK_DOUBLE));
  vectors->SetName(stored->GetName());
  vectors->SetNumberOfComponents(3);
  vectors->SetNumberOfTuples(stored->GetNumberOfTuples());
  for (vtkIdType i = 0; i < stored->GetNumberOfTuples(); ++i)
  {
    double components[3];
    stored->GetTuple(i, components);
    double vector[3];
    matrix->MultiplyPoint(components, vector);
    vectors->SetTuple(i, vector);
  }
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

/// Converts a field of a .vti file, which states no world coordinates, from LPS to RAS or back.
void FlipWorld(vtkImageData* image)
{
  std::vector<std::string> vectors;
  for (int i = 0; i < image->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* const array = image->GetPointData()->GetArray(i);
    if (array && array->GetName() && array->GetNumberOfComponents() == 3)
    {
      vectors.emplace_back(array->GetName());
    }
  }
  FlipWorldAxes(image, vectors);
}

/// Whether the vectors, with x and y multiplied by sign, are about the positions of their points:
/// such vectors increase with the position by about the same amount.
bool ArePositions(vtkImageData* image, double sign)
{
  vtkDataArray* const vectors = image->GetPointData()->GetVectors();
  const vtkIdType points = image->GetNumberOfPoints();
  constexpr vtkIdType most = 10000;
  const vtkIdType step = std::max<vtkIdType>(1, points / most);
  double middle[3];
  image->GetCenter(middle);
  double both = 0.0;
  double squares = 0.0;
  double mean[3] = { 0.0, 0.0, 0.0 };
  vtkIdType count = 0;
  for (vtkIdType i = 0; i < points; i += step, ++count)
  {
    double point[3];
    double vector[3];
    image->GetPoint(i, point);
    vectors->GetTuple(i, vector);
    vector[0] *= sign;
    vector[1] *= sign;
    vtkMath::Subtract(point, middle, point);
    vtkMath::Subtract(vector, middle, vector);
    both += vtkMath::Dot(vector, point);
    squares += vtkMath::Dot(point, point);
    vtkMath::Add(mean, vector, mean);
  }
  const double size = std::sqrt(squares / static_cast<double>(count));
  constexpr double tolerance = 0.2;
  return size > 0.0 && std::abs(both / squares - 1.0) < tolerance &&
    vtkMath::Norm(mean) / static_cast<double>(count) < tolerance * size;
}

/// Warns if the vectors seem to be deformed positions, which NiftyReg and voxelmorph call a
/// deformation field, in the world coordinates of the file or in the other ones.
void CheckPositions(vtkImageData* image, const std::string& path, Messages& messages)
{
  const bool areInWorld = ArePositions(image, 1.0);
  if (areInWorld || ArePositions(image, -1.0))
  {
    messages.Warn("The vectors of " + path +
      " look like the positions of its voxels, which some programs call a deformation field. A "
      "displacement field holds how far each point moves: subtract the position of each voxel." +
      (areInWorld ? ""
                  : " The file also states the wrong world coordinates, in which x and y have the "
                    "opposite sign. In NIfTI files, intent 1006 states ras and 1007 states lps."));
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
  const FieldOptions& options, Messages& messages, bool showProgress)
{
  const std::string what = "cannot use the displacement field " + path;
  const std::string fault = FindReadingFault(path);
  if (!fault.empty())
  {
    throw Failure(what + ": " + fault);
  }
  if (!IsFieldFile(path))
  {
    throw Failure(what +
      ": a field is a .nii, .nii.gz, .mha, .mhd, .nrrd, .nhdr or .vti file. Give meshes with "
      "--mesh, and convert other transformations into a displacement field first");
  }
  ReadingOptions reading;
  reading.Frame = 0; // the shape is checked below
  Volume field = ReadVolume(path, reading, messages, showProgress);
  vtkImageData* image = field.Image;
  const WorldAxes space =
    ChooseSpace("--field-space", options.Space, path, field.Axes, volume.Axes, messages);
  const bool isFlipped =
    space != WorldAxes::Unknown && volume.Axes != WorldAxes::Unknown && space != volume.Axes;
  if (IsVTKFile(path))
  {
    if (isFlipped)
    {
      FlipWorld(image);
    }
    return image;
  }
  vtkNew<vtkMatrix3x3> matrix;
  if (field.NIfTIHeader)
  {
    // The image is right-anterior-superior, independently of its vectors.
    if (!IsRightAnterior(field.NIfTIHeader, what))
    {
      FlipWorldAxes(matrix);
      if (options.Space == "ras")
      {
        messages.Warn("The vectors of " + path +
          " are lps, as its intent 1007 says; --field-space does not change this. If they are ras, "
          "set the intent to 1006.");
      }
    }
  }
  else if (field.MeasurementFrame)
  {
    matrix->DeepCopy(field.MeasurementFrame);
  }
  if (!field.Unit.empty())
  {
    RefuseUnit(field.Unit, what);
  }
  CheckKind(field, path, options.IsInverse, messages);
  vtkDataArray* stored = image->GetPointData()->GetScalars();
  const int components = stored ? stored->GetNumberOfComponents() : 0;
  if (components != 3)
  {
    throw Failure(what + ": it has " + std::to_string(components) +
      " components for each voxel, but displacements have three");
  }
  if (field.NumberOfFrames > 1)
  {
    throw Failure(what + ": it varies in time, with " + std::to_string(field.NumberOfFrames) +
      " time steps. Extract one time step");
  }
  if (field.Axes == WorldAxes::Unknown && options.Space.empty())
  {
    throw Failure(what +
      ": its header does not state its world coordinates. A NIfTI file needs a q-form or s-form, "
      "an NRRD file a space such as left-posterior-superior or right-anterior-superior. Or give "
      "it with --field and --field-space");
  }
  if (isFlipped)
  {
    FlipWorldAxes(image);
    FlipWorldAxes(matrix);
  }
  const vtkSmartPointer<vtkDataArray> vectors = Turn(stored, matrix);
  vectors->SetName(FieldArrayName);
  image->GetPointData()->Initialize();
  image->GetPointData()->SetVectors(vectors);
  CheckPositions(image, path, messages);
  return image;
}
