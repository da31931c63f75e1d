// SPDX-License-Identifier: BSD-3-Clause
// NrrdIO decodes NRRD files. itk::NrrdImageIO is not used: it converts some spaces wrongly to
// left-posterior-superior, and refuses time axes.
#include "NRRDReading.h"

#include "Failure.h"
#include "Files.h"
#include "ImageAxes.h"
#include "Messages.h"

#include <NrrdIO.h>

#include <vtkDataArray.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace
{
// The last message of NrrdIO, which is the most specific, without the name of the function.
std::string GetReason()
{
  char* const text = biffGetDone("nrrd");
  std::string reason = text ? text : "";
  std::free(text);
  reason.erase(reason.find_last_not_of('\n') + 1);
  reason.erase(0, reason.find_last_of('\n') + 1);
  const std::size_t begin = reason.find(": ");
  return begin == std::string::npos ? reason : reason.substr(begin + 2);
}

class NRRDFile
{
public:
  explicit NRRDFile(const std::string& path)
    : Path(path)
  {
    if (nrrdLoad(this->Data, path.c_str(), nullptr) != 0)
    {
      const std::string reason = GetReason();
      this->Fail((this->LoadHeader() ? "its data are missing, damaged, or not complete: "
                                     : "its header is wrong: ") +
        reason);
    }
    this->SortAxes();
  }
  ~NRRDFile() { nrrdNuke(this->Data); }
  NRRDFile(const NRRDFile&) = delete;
  NRRDFile& operator=(const NRRDFile&) = delete;

  int GetFrames() const
  {
    return this->FrameAxes.empty() ? 1 : static_cast<int>(this->GetSize(this->FrameAxes[0]));
  }
  vtkSmartPointer<vtkImageData> GetImage(int frame) const;
  WorldAxes GetAxes() const;
  // Whether y must be negated for left-posterior-superior.
  bool IsLeftAnterior() const
  {
    return this->Data->space == nrrdSpaceLeftAnteriorSuperior ||
      this->Data->space == nrrdSpaceLeftAnteriorSuperiorTime;
  }
  // Whether the header has directions for all space axes.
  bool HasDirections() const
  {
    return this->SpaceAxes.size() == 3 &&
      std::all_of(this->SpaceAxes.begin(), this->SpaceAxes.end(),
        [this](unsigned int axis) { return this->HasDirection(axis); });
  }
  // The unit of length on an axis of the space or, without directions, on an axis of the file; ""
  // if the header has none.
  std::string GetUnit(unsigned int axis) const;
  // Sets the spacing of the image. place: its columns become the directions, of unit length, and
  // the position of the first voxel, in the space of the file. factors: by which lengths on the
  // axes of GetUnit() are multiplied.
  void GetPlace(vtkImageData* image, vtkMatrix4x4* place, const double factors[3]) const;
  // The matrix from components of vectors to the space of the file. Unchanged if the file has none.
  void GetMeasurementFrame(vtkMatrix3x3* matrix) const;
  std::map<std::string, std::string> GetFields() const;

private:
  [[noreturn]] void Fail(const std::string& reason) const
  {
    throw Failure("cannot read " + this->Path + ": " + reason);
  }
  bool LoadHeader()
  {
    NrrdIoState* const state = nrrdIoStateNew();
    state->skipData = 1;
    const bool isLoaded = nrrdLoad(this->Data, this->Path.c_str(), state) == 0;
    nrrdIoStateNix(state);
    if (!isLoaded)
    {
      GetReason(); // clears the message of NrrdIO
    }
    return isLoaded;
  }
  void SortAxes();
  int GetType() const;
  std::size_t GetSize(unsigned int axis) const { return this->Data->axis[axis].size; }
  bool HasDirection(unsigned int axis) const
  {
    return this->Data->spaceDim >= 3 && std::isfinite(this->Data->axis[axis].spaceDirection[0]);
  }
  bool IsOfTime(unsigned int axis) const;
  double GetSpacing(unsigned int axis) const;

  const std::string Path;
  Nrrd* const Data = nrrdNew();
  std::vector<unsigned int> ComponentAxes;
  std::vector<unsigned int> SpaceAxes;
  std::vector<unsigned int> FrameAxes;
};

bool NRRDFile::IsOfTime(unsigned int axis) const
{
  const int kind = this->Data->axis[axis].kind;
  if (kind == nrrdKindTime || kind == nrrdKindList)
  {
    return true;
  }
  const double* const direction = this->Data->axis[axis].spaceDirection;
  return this->HasDirection(axis) && vtkMath::Norm(direction) == 0.0 && this->Data->spaceDim > 3;
}

void NRRDFile::SortAxes()
{
  bool hasDirections = false;
  for (unsigned int axis = 0; axis < this->Data->dim; ++axis)
  {
    hasDirections = hasDirections || this->HasDirection(axis);
    if (this->GetSize(axis) > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    {
      this->Fail("its axis " + std::to_string(axis) + " is too long");
    }
  }
  for (unsigned int axis = 0; axis < this->Data->dim; ++axis)
  {
    const int kind = this->Data->axis[axis].kind;
    const bool isDomain = kind == nrrdKindDomain || kind == nrrdKindSpace;
    const bool isOfSpace =
      hasDirections ? this->HasDirection(axis) : isDomain || kind == nrrdKindUnknown;
    if (kind == nrrdKindComplex)
    {
      this->Fail("its values are complex, which a volume of VTK cannot hold");
    }
    if (this->IsOfTime(axis) || (isDomain && !isOfSpace))
    {
      this->FrameAxes.push_back(axis);
    }
    else if (isOfSpace)
    {
      // Without kinds, an axis after three space axes is a time axis.
      (this->SpaceAxes.size() < 3 ? this->SpaceAxes : this->FrameAxes).push_back(axis);
    }
    else if (kind != nrrdKindUnknown)
    {
      this->ComponentAxes.push_back(axis);
    }
    else
    {
      this->Fail("its axis " + std::to_string(axis) +
        " has neither a direction nor a kind. Add the line kinds to its header: vector for "
        "components, list for frames");
    }
  }
  if (this->ComponentAxes.size() > 1 || this->FrameAxes.size() > 1)
  {
    this->Fail("it has " + std::to_string(this->Data->dim) +
      " axes. A volume has three axes of space, one of components and one of time");
  }
}

int NRRDFile::GetType() const
{
  switch (this->Data->type)
  {
    case nrrdTypeChar:
      return VTK_SIGNED_CHAR;
    case nrrdTypeUChar:
      return VTK_UNSIGNED_CHAR;
    case nrrdTypeShort:
      return VTK_SHORT;
    case nrrdTypeUShort:
      return VTK_UNSIGNED_SHORT;
    case nrrdTypeInt:
      return VTK_INT;
    case nrrdTypeUInt:
      return VTK_UNSIGNED_INT;
    case nrrdTypeLLong:
      return VTK_LONG_LONG;
    case nrrdTypeULLong:
      return VTK_UNSIGNED_LONG_LONG;
    case nrrdTypeFloat:
      return VTK_FLOAT;
    case nrrdTypeDouble:
      return VTK_DOUBLE;
    default:
      this->Fail("its values are of a type that a volume of VTK cannot hold");
  }
}

vtkSmartPointer<vtkImageData> NRRDFile::GetImage(int frame) const
{
  std::vector<unsigned int> order = this->ComponentAxes;
  order.insert(order.end(), this->SpaceAxes.begin(), this->SpaceAxes.end());
  order.insert(order.end(), this->FrameAxes.begin(), this->FrameAxes.end());
  Nrrd* sorted = this->Data;
  if (!std::is_sorted(order.begin(), order.end()))
  {
    sorted = nrrdNew();
    if (nrrdAxesPermute(sorted, this->Data, order.data()) != 0)
    {
      nrrdNuke(sorted);
      this->Fail(GetReason());
    }
  }
  int dimensions[3] = { 1, 1, 1 };
  for (std::size_t i = 0; i < this->SpaceAxes.size(); ++i)
  {
    dimensions[i] = static_cast<int>(this->GetSize(this->SpaceAxes[i]));
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(dimensions);
  const auto values =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(this->GetType()));
  values->SetName("ImageFile");
  values->SetNumberOfComponents(
    this->ComponentAxes.empty() ? 1 : static_cast<int>(this->GetSize(this->ComponentAxes[0])));
  values->SetNumberOfTuples(image->GetNumberOfPoints());
  const auto bytes = static_cast<std::size_t>(values->GetNumberOfValues()) *
    static_cast<std::size_t>(values->GetDataTypeSize());
  std::memcpy(
    values->GetVoidPointer(0), static_cast<const char*>(sorted->data) + frame * bytes, bytes);
  if (sorted != this->Data)
  {
    nrrdNuke(sorted);
  }
  image->GetPointData()->SetScalars(values);
  return image;
}

WorldAxes NRRDFile::GetAxes() const
{
  switch (this->Data->space)
  {
    case nrrdSpaceRightAnteriorSuperior:
    case nrrdSpaceRightAnteriorSuperiorTime:
      return WorldAxes::RightAnteriorSuperior;
    case nrrdSpaceLeftPosteriorSuperior:
    case nrrdSpaceLeftPosteriorSuperiorTime:
    case nrrdSpaceLeftAnteriorSuperior:
    case nrrdSpaceLeftAnteriorSuperiorTime:
      return WorldAxes::LeftPosteriorSuperior;
    default:
      return WorldAxes::Unknown;
  }
}

std::string NRRDFile::GetUnit(unsigned int axis) const
{
  if (!this->HasDirections() && axis >= this->SpaceAxes.size())
  {
    return "";
  }
  const char* const unit = this->HasDirections() ? this->Data->spaceUnits[axis]
                                                 : this->Data->axis[this->SpaceAxes[axis]].units;
  return unit ? unit : "";
}

// The spacing on an axis of a file without directions: that of the header, or that of its minimum
// and maximum. They are at the borders of the first and the last voxel, or at their centers.
double NRRDFile::GetSpacing(unsigned int axis) const
{
  const NrrdAxisInfo& info = this->Data->axis[axis];
  if (!std::isnan(info.spacing))
  {
    return info.spacing;
  }
  const double steps = static_cast<double>(info.size) - (info.center == nrrdCenterNode ? 1.0 : 0.0);
  const double spacing = (info.max - info.min) / steps;
  return std::isfinite(spacing) && spacing != 0.0 ? spacing : 1.0;
}

void NRRDFile::GetPlace(vtkImageData* image, vtkMatrix4x4* place, const double factors[3]) const
{
  double spacing[3] = { 1.0, 1.0, 1.0 };
  double origin[NRRD_DIM_MAX] = {};
  const auto axes = static_cast<unsigned int>(this->SpaceAxes.size());
  if (this->HasDirections())
  {
    for (int column = 0; column < 3; ++column)
    {
      double direction[3];
      for (int row = 0; row < 3; ++row)
      {
        direction[row] =
          factors[row] * this->Data->axis[this->SpaceAxes[column]].spaceDirection[row];
      }
      spacing[column] = vtkMath::Normalize(direction);
      for (int row = 0; row < 3; ++row)
      {
        place->SetElement(row, column, direction[row]);
      }
    }
    std::copy_n(this->Data->spaceOrigin, 3, origin);
  }
  else
  {
    for (unsigned int axis = 0; axis < axes; ++axis)
    {
      spacing[axis] = factors[axis] * this->GetSpacing(this->SpaceAxes[axis]);
    }
    std::vector<unsigned int> spaceAxes = this->SpaceAxes;
    nrrdOriginCalculate(this->Data, spaceAxes.data(), axes, nrrdCenterCell, origin);
  }
  for (int row = 0; row < 3; ++row)
  {
    place->SetElement(row, 3, std::isnan(origin[row]) ? 0.0 : factors[row] * origin[row]);
  }
  image->SetSpacing(spacing);
}

void NRRDFile::GetMeasurementFrame(vtkMatrix3x3* matrix) const
{
  for (int column = 0; column < 3 && std::isfinite(this->Data->measurementFrame[0][0]); ++column)
  {
    for (int row = 0; row < 3; ++row)
    {
      matrix->SetElement(row, column, this->Data->measurementFrame[column][row]);
    }
  }
}

std::map<std::string, std::string> NRRDFile::GetFields() const
{
  std::map<std::string, std::string> fields;
  for (unsigned int i = 0; i < nrrdKeyValueSize(this->Data); ++i)
  {
    char* key = nullptr;
    char* value = nullptr;
    nrrdKeyValueIndex(this->Data, &key, &value, i);
    fields[key] = value;
    std::free(key);
    std::free(value);
  }
  return fields;
}
}

namespace
{
// Returns a unit of length in mm; 0 if the unit is not known.
double GetMillimetres(const std::string& unit)
{
  const std::pair<double, std::vector<const char*>> units[] = {
    { 1.0, { "", "mm", "millimeter", "millimeters", "millimetre", "millimetres" } },
    { 1000.0, { "m", "meter", "meters", "metre", "metres" } },
    { 10.0, { "cm", "centimeter", "centimeters", "centimetre", "centimetres" } },
    // The sign is that of micro or the Greek letter.
    { 0.001,
      { "um", "\u00b5m", "\u03bcm", "micron", "microns", "micrometer", "micrometers", "micrometre",
        "micrometres" } },
    { 1e-6, { "nm", "nanometer", "nanometers", "nanometre", "nanometres" } },
  };
  const std::string text = Trim(unit);
  for (const auto& [length, names] : units)
  {
    if (std::find(names.begin(), names.end(), text) != names.end())
    {
      return length;
    }
  }
  return 0.0;
}

// Sets the factors that convert the lengths of a file to mm, and the unit of the volume. Lengths of
// an unknown unit are not converted, with a warning.
void FindFactors(const NRRDFile& file, const std::string& path, double factors[3], Volume& volume,
  Messages& messages)
{
  bool isWarned = false;
  for (unsigned int axis = 0; axis < 3; ++axis)
  {
    const std::string unit = file.GetUnit(axis);
    factors[axis] = GetMillimetres(unit);
    if (factors[axis] == 0.0)
    {
      factors[axis] = 1.0;
      if (!isWarned)
      {
        messages.Warn("The unit of length of " + path + ", \"" + unit +
          "\", is not known. Its coordinates are not converted to mm.");
      }
      isWarned = true;
    }
    else if (factors[axis] != 1.0)
    {
      volume.Unit = unit;
    }
  }
}
}

Volume ReadNRRD(const std::string& path, const ReadingOptions& options, Messages& messages)
{
  const NRRDFile file(path);
  Volume volume;
  volume.Image = file.GetImage(ChooseFrame(path, file.GetFrames(), options));
  volume.Fields = file.GetFields();
  volume.MeasurementFrame = vtkSmartPointer<vtkMatrix3x3>::New();
  file.GetMeasurementFrame(volume.MeasurementFrame);
  volume.NumberOfFrames = file.GetFrames();
  double factors[3] = { 1.0, 1.0, 1.0 };
  if (!options.FileCoordinates)
  {
    FindFactors(file, path, factors, volume, messages);
  }
  vtkNew<vtkMatrix4x4> place;
  file.GetPlace(volume.Image, place, factors);
  if (options.FileCoordinates)
  {
    for (int i = 0; i < 9; ++i)
    {
      place->SetElement(i / 3, i % 3, i / 3 == i % 3 ? 1.0 : 0.0);
    }
  }
  else if (file.HasDirections())
  {
    volume.Axes = file.GetAxes();
    for (int column = 0; column < 4 && file.IsLeftAnterior(); ++column)
    {
      place->SetElement(1, column, 0.0 - place->GetElement(1, column));
      if (column < 3)
      {
        volume.MeasurementFrame->SetElement(
          1, column, -volume.MeasurementFrame->GetElement(1, column));
      }
    }
  }
  SetAxes(volume.Image, place, path, messages);
  return volume;
}
