// SPDX-License-Identifier: BSD-3-Clause
#include "ItkImage.h"

#include "Failure.h"

#include <algorithm>
#include <iostream>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

namespace
{
// The description of an exception, without the class and the address that ITK puts before it.
std::string GetReason(const std::exception& error)
{
  const auto* const exception = dynamic_cast<const itk::ExceptionObject*>(&error);
  std::string text = exception ? exception->GetDescription() : error.what();
  // "ITK ERROR: MetaImageIO(0x1234): text"
  const std::size_t address = text.rfind("0x");
  const std::size_t end = address == std::string::npos ? address : text.find("): ", address);
  text = end == std::string::npos ? text : text.substr(end + 3);
  for (char& character : text)
  {
    character = character == '\n' ? ' ' : character;
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

// Redirects std::cerr to a string, for libraries that write to it.
class ErrorStream
{
public:
  ErrorStream()
    : Old(std::cerr.rdbuf(this->Taken.rdbuf()))
  {
  }
  ~ErrorStream() { std::cerr.rdbuf(this->Old); }
  ErrorStream(const ErrorStream&) = delete;
  ErrorStream& operator=(const ErrorStream&) = delete;

  std::string GetText() const { return this->Taken.str(); }

private:
  std::ostringstream Taken;
  std::streambuf* Old;
};

const std::pair<itk::IOComponentEnum, int> Types[] = {
  { itk::IOComponentEnum::UCHAR, VTK_UNSIGNED_CHAR },
  { itk::IOComponentEnum::CHAR, VTK_SIGNED_CHAR },
  { itk::IOComponentEnum::USHORT, VTK_UNSIGNED_SHORT },
  { itk::IOComponentEnum::SHORT, VTK_SHORT },
  { itk::IOComponentEnum::UINT, VTK_UNSIGNED_INT },
  { itk::IOComponentEnum::INT, VTK_INT },
  { itk::IOComponentEnum::ULONG, VTK_UNSIGNED_LONG },
  { itk::IOComponentEnum::LONG, VTK_LONG },
  { itk::IOComponentEnum::ULONGLONG, VTK_UNSIGNED_LONG_LONG },
  { itk::IOComponentEnum::LONGLONG, VTK_LONG_LONG },
  { itk::IOComponentEnum::FLOAT, VTK_FLOAT },
  { itk::IOComponentEnum::DOUBLE, VTK_DOUBLE },
};

// Returns VTK_VOID if VTK does not have the type.
int GetType(itk::ImageIOBase* io)
{
  for (const auto& [component, type] : Types)
  {
    if (component == io->GetComponentType())
    {
      return type;
    }
  }
  return VTK_VOID;
}

// Reads all values. Returns false if the last value is missing, because the file is truncated or
// damaged. To find that out, fills the last value with a mark and reads the file, twice with
// different marks. A byte that keeps both marks was not read.
bool ReadCompletely(itk::ImageIOBase* io, vtkDataArray* values)
{
  const auto size = static_cast<std::size_t>(values->GetDataTypeSize());
  auto* const bytes = static_cast<unsigned char*>(values->GetVoidPointer(0));
  unsigned char* const last =
    bytes + size * static_cast<std::size_t>(values->GetNumberOfValues() - 1);
  std::vector<bool> isKept(size, true);
  for (const unsigned char mark : { 0xA5, 0x5A })
  {
    std::fill(last, last + size, mark);
    io->Read(bytes);
    for (std::size_t i = 0; i < size; ++i)
    {
      isKept[i] = isKept[i] && last[i] == mark;
    }
    if (std::find(isKept.begin(), isKept.end(), true) == isKept.end())
    {
      return true;
    }
  }
  return false;
}
}

void ReadHeader(itk::ImageIOBase* io, const std::string& path, const std::string& reason)
{
  const std::string what = "cannot read " + path + ": ";
  const ErrorStream errors;
  try
  {
    io->SetFileName(path);
    io->ReadImageInformation();
  }
  catch (const std::exception&)
  {
    throw Failure(what + reason);
  }
  if (GetType(io) == VTK_VOID || io->GetPixelType() == itk::IOPixelEnum::COMPLEX)
  {
    throw Failure(what + "its values are of the type " +
      (GetType(io) == VTK_VOID ? itk::ImageIOBase::GetComponentTypeAsString(io->GetComponentType())
                               : itk::ImageIOBase::GetPixelTypeAsString(io->GetPixelType())) +
      ", which a volume of VTK cannot hold");
  }
  bool hasVoxels = io->GetNumberOfComponents() > 0;
  for (unsigned int axis = 0; axis < io->GetNumberOfDimensions(); ++axis)
  {
    const auto size = io->GetDimensions(axis);
    hasVoxels = hasVoxels && size > 0 && size <= std::numeric_limits<int>::max();
  }
  if (!hasVoxels)
  {
    throw Failure(what + "its header gives no voxels, or an impossible size");
  }
}

vtkSmartPointer<vtkDataArray> ReadValues(itk::ImageIOBase* io, std::string& complaints)
{
  const auto values =
    vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(GetType(io)));
  values->SetNumberOfComponents(static_cast<int>(io->GetNumberOfComponents()));
  values->SetNumberOfTuples(static_cast<vtkIdType>(io->GetImageSizeInPixels()));
  itk::ImageIORegion region(io->GetNumberOfDimensions());
  for (unsigned int axis = 0; axis < io->GetNumberOfDimensions(); ++axis)
  {
    region.SetIndex(axis, 0);
    region.SetSize(axis, io->GetDimensions(axis));
  }
  io->SetIORegion(region);
  const ErrorStream errors;
  bool isRead = false;
  try
  {
    isRead = ReadCompletely(io, values);
  }
  catch (const std::exception&)
  {
    // ITK's messages name a line of its source code, and rarely the reason.
  }
  if (!isRead)
  {
    throw Failure(std::string("cannot read ") + io->GetFileName() + ": " + DataMissing);
  }
  complaints = errors.GetText();
  return values;
}

itk::IOComponentEnum GetComponentType(vtkDataArray* values)
{
  const int type = values->GetDataType() == VTK_ID_TYPE ? VTK_LONG_LONG
    : values->GetDataType() == VTK_CHAR                 ? VTK_SIGNED_CHAR
                                                        : values->GetDataType();
  for (const auto& [component, known] : Types)
  {
    if (known == type)
    {
      return component;
    }
  }
  throw Failure(std::string("cannot write values of the type ") + values->GetDataTypeAsString());
}

std::string WriteValues(itk::ImageIOBase* io, const void* values)
{
  const ErrorStream errors;
  try
  {
    io->Write(values);
  }
  catch (const std::exception& error)
  {
    return GetReason(error);
  }
  // ITK throws no exception for an incomplete MetaImage file. It only writes to std::cerr.
  return errors.GetText().empty() ? ""
                                  : "its values are not complete. Is there enough free disk space?";
}
