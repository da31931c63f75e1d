// SPDX-License-Identifier: BSD-3-Clause
#include "ItkImage.h"

#include "Failure.h"

#include <itkMetaDataObject.h>

#include <iostream>
#include <sstream>
#include <utility>

namespace
{
// ITK's messages tell places in its sources.
std::string GetReason(const std::exception& error)
{
  const auto* const exception = dynamic_cast<const itk::ExceptionObject*>(&error);
  std::string text = exception ? exception->GetDescription() : error.what();
  // "ITK ERROR: MetaImageIO(0x1234): text"
  const std::size_t place = text.rfind("0x");
  const std::size_t end = place == std::string::npos ? place : text.find("): ", place);
  text = end == std::string::npos ? text : text.substr(end + 3);
  for (char& character : text)
  {
    character = character == '\n' ? ' ' : character;
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

// Takes what a library writes to std::cerr: MetaIO does not say otherwise that data are missing.
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

// VTK_VOID for a type that VTK does not have.
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

// Whether the file ends before its last byte: that keeps what it had before, whatever that was.
bool LacksLastByte(itk::ImageIOBase* io, vtkDataArray* values)
{
  const auto size = static_cast<std::size_t>(values->GetDataSize()) *
    static_cast<std::size_t>(values->GetDataTypeSize());
  auto* const bytes = static_cast<unsigned char*>(values->GetVoidPointer(0));
  for (const unsigned char mark : { 0xA5, 0x5A })
  {
    bytes[size - 1] = mark;
    io->Read(bytes);
    if (bytes[size - 1] != mark)
    {
      return false;
    }
  }
  return true;
}
}

void ReadHeader(itk::ImageIOBase* io, const std::string& path)
{
  const ErrorStream errors;
  try
  {
    io->SetFileName(path);
    io->ReadImageInformation();
  }
  catch (const std::exception& error)
  {
    throw Failure("cannot read " + path + ": " + GetReason(error));
  }
  if (GetType(io) == VTK_VOID || io->GetPixelType() == itk::IOPixelEnum::COMPLEX)
  {
    throw Failure("cannot read " + path + ": its values are of the type " +
      (GetType(io) == VTK_VOID ? itk::ImageIOBase::GetComponentTypeAsString(io->GetComponentType())
                               : itk::ImageIOBase::GetPixelTypeAsString(io->GetPixelType())) +
      ", which a volume of VTK cannot hold");
  }
  if (io->GetImageSizeInComponents() < 1)
  {
    throw Failure("cannot read " + path + ": it holds no voxels");
  }
}

vtkSmartPointer<vtkDataArray> ReadValues(itk::ImageIOBase* io)
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
  const std::string what = std::string("cannot read ") + io->GetFileName() + ": ";
  const ErrorStream errors;
  try
  {
    if (LacksLastByte(io, values) ||
      errors.GetText().find("not read completely") != std::string::npos)
    {
      throw Failure(what + "it ends before its data do");
    }
  }
  catch (const itk::ExceptionObject& error)
  {
    throw Failure(what + GetReason(error));
  }
  return values;
}

std::map<std::string, std::string> GetTexts(itk::ImageIOBase* io)
{
  std::map<std::string, std::string> texts;
  const itk::MetaDataDictionary& dictionary = io->GetMetaDataDictionary();
  for (const std::string& name : dictionary.GetKeys())
  {
    std::string text;
    if (itk::ExposeMetaData(dictionary, name, text))
    {
      texts[name] = text;
    }
  }
  return texts;
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

void WriteValues(itk::ImageIOBase* io, const void* values)
{
  try
  {
    io->Write(values);
  }
  catch (const std::exception& error)
  {
    throw Failure(std::string("cannot write ") + io->GetFileName() + ": " + GetReason(error));
  }
}
