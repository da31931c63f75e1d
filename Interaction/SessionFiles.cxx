// SPDX-License-Identifier: BSD-3-Clause
#include "SessionEvents.h"

#include "vtkBitArray.h"
#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLDataParser.h"

#include <vtksys/FStream.hxx>
#include <vtksys/MD5.h>
#include <vtksys/SystemTools.hxx>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace
{

constexpr const char* RootName = "DeformVolumeSession";
constexpr const char* Version = "1";

class Hash
{
public:
  Hash() { vtksysMD5_Initialize(this->State); }
  ~Hash() { vtksysMD5_Delete(this->State); }
  Hash(const Hash&) = delete;
  void operator=(const Hash&) = delete;

  void Add(const void* data, std::size_t size)
  {
    const auto* bytes = static_cast<const unsigned char*>(data);
    constexpr std::size_t most = 1 << 30; // vtksysMD5_Append takes an int
    for (; size > 0;)
    {
      const std::size_t part = size < most ? size : most;
      vtksysMD5_Append(this->State, bytes, static_cast<int>(part));
      bytes += part;
      size -= part;
    }
  }
  void Add(vtkDataArray* array)
  {
    const int shape[2] = { array->GetDataType(), array->GetNumberOfComponents() };
    this->Add(shape, sizeof(shape));
    this->Add(array->GetVoidPointer(0),
      static_cast<std::size_t>(array->GetNumberOfValues()) *
        static_cast<std::size_t>(array->GetDataTypeSize()));
  }
  // The order of the arrays does not matter.
  void AddByName(vtkDataSetAttributes* arrays)
  {
    std::map<std::string, vtkDataArray*> named;
    for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* array = arrays->GetArray(i); // null for texts
      if (array && array->GetName())
      {
        named[array->GetName()] = array;
      }
    }
    for (const auto& [name, array] : named)
    {
      this->Add(name.data(), name.size());
      this->Add(array);
    }
  }
  // Add() adds no values of bit arrays.
  void AddBits(vtkDataSetAttributes* arrays)
  {
    for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
    {
      auto* bits = vtkArrayDownCast<vtkBitArray>(arrays->GetAbstractArray(i));
      for (vtkIdType value = 0; bits && value < bits->GetNumberOfValues(); ++value)
      {
        const auto bit = static_cast<char>(bits->GetValue(value));
        this->Add(&bit, 1);
      }
    }
  }
  std::string Finish()
  {
    char digits[33] = {};
    vtksysMD5_FinalizeHex(this->State, digits);
    return digits;
  }

private:
  vtksysMD5* State = vtksysMD5_New();
};

std::string HashEvents(const deformvolume::SessionEvents& events)
{
  Hash hash;
  for (const deformvolume::SessionEvent& event : events)
  {
    const std::string text = deformvolume::FormatEvent(event) + '\n';
    hash.Add(text.data(), text.size());
  }
  return hash.Finish();
}

std::string GetReason()
{
  return errno != 0 ? std::string(": ") + std::strerror(errno) : std::string();
}

// Makes an empty file and returns its name: `name`, or with a number if such a file exists.
std::string MakeFile(const std::string& name, const std::string& target)
{
  for (int number = 0;; ++number)
  {
    const std::string path = number == 0 ? name : name + std::to_string(number);
    errno = 0;
    std::FILE* const file = vtksys::SystemTools::Fopen(path, "wx"); // x: fails if the file exists
    if (file)
    {
      std::fclose(file);
      return path;
    }
    if (errno != EEXIST)
    {
      throw std::runtime_error("The file " + target + " cannot be written" + GetReason() +
        ". Choose a folder that can be written and has space.");
    }
  }
}

std::string GetAttribute(vtkXMLDataElement* element, const char* name)
{
  const char* value = element->GetAttribute(name);
  return value ? value : "";
}

} // namespace

std::string deformvolume::HashInputs(vtkImageData* volume, vtkUnstructuredGrid* mesh)
{
  Hash hash;
  hash.Add(volume->GetExtent(), 6 * sizeof(int));
  hash.Add(volume->GetOrigin(), 3 * sizeof(double));
  hash.Add(volume->GetSpacing(), 3 * sizeof(double));
  hash.Add(volume->GetDirectionMatrix()->GetData(), 9 * sizeof(double));
  for (int i = 0; i < volume->GetPointData()->GetNumberOfArrays(); ++i)
  {
    if (vtkDataArray* array = volume->GetPointData()->GetArray(i))
    {
      hash.Add(array);
    }
  }
  if (mesh && mesh->GetPoints() && mesh->GetCells())
  {
    hash.Add(mesh->GetPoints()->GetData());
    hash.Add(mesh->GetCells()->GetConnectivityArray());
  }
  std::string text = hash.Finish();
  if (mesh)
  {
    // The model finds its arrays, such as Fixed, by their names.
    Hash arrays;
    arrays.AddByName(mesh->GetPointData());
    arrays.AddByName(mesh->GetCellData());
    text += ' ' + arrays.Finish();
  }
  // What the first parts leave out. They do not change, so that files of older versions can be
  // read.
  Hash others;
  const char* name = volume->GetPointData()->GetScalars()->GetName();
  others.Add(name, name ? std::strlen(name) : 0);
  others.AddByName(volume->GetCellData());
  others.AddBits(volume->GetPointData());
  others.AddBits(volume->GetCellData());
  if (mesh)
  {
    others.AddBits(mesh->GetPointData());
    others.AddBits(mesh->GetCellData());
    for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
    {
      const int type = mesh->GetCellType(cell);
      others.Add(&type, sizeof(type));
    }
  }
  return text + ' ' + others.Finish();
}

void deformvolume::WriteEvents(
  const std::string& fileName, const std::string& inputHash, const SessionEvents& events)
{
  WriteAndRename(fileName,
    [&](const std::string& name)
    {
      errno = 0;
      vtksys::ofstream file(name.c_str(), std::ios::binary);
      file << "<?xml version=\"1.0\"?>\n<" << RootName << " version=\"" << Version << "\" inputs=\""
           << inputHash << "\" checksum=\"" << HashEvents(events) << "\">\n";
      for (const SessionEvent& event : events)
      {
        file << "  <Event do=\"" << FormatEvent(event) << "\"/>\n";
      }
      file << "</" << RootName << ">\n";
      file.close();
      if (!file)
      {
        throw std::runtime_error("The session cannot be written to " + fileName + GetReason() +
          ". Choose a folder that can be written and has space.");
      }
    });
}

deformvolume::SessionEvents deformvolume::ReadEvents(
  const std::string& fileName, const std::string& inputHash)
{
  errno = 0;
  vtksys::ifstream file(fileName.c_str(), std::ios::binary);
  std::ostringstream text;
  if (!(text << file.rdbuf()) && errno != 0) // empty files are reported below
  {
    throw std::runtime_error("The session " + fileName + " cannot be read" + GetReason() + ".");
  }
  std::istringstream content(text.str());
  vtkNew<vtkXMLDataParser> parser;
  vtkNew<vtkCallbackCommand> silence; // errors are reported below
  parser->AddObserver(vtkCommand::ErrorEvent, silence);
  parser->SetStream(&content);
  const bool isParsed = parser->Parse() != 0;
  vtkXMLDataElement* root = isParsed ? parser->GetRootElement() : nullptr;
  if (!root || !root->GetName() || std::strcmp(root->GetName(), RootName) != 0)
  {
    throw std::runtime_error(fileName + " is not a session file, or it is damaged.");
  }
  if (GetAttribute(root, "version") != Version)
  {
    throw std::runtime_error("The session " + fileName + " has version " +
      GetAttribute(root, "version") + ", and only version " + Version + " can be read.");
  }
  SessionEvents events;
  for (int i = 0; i < root->GetNumberOfNestedElements(); ++i)
  {
    try
    {
      events.push_back(ParseEvent(GetAttribute(root->GetNestedElement(i), "do")));
    }
    catch (const std::runtime_error& error)
    {
      throw std::runtime_error("The session " + fileName + " is damaged: " + error.what() + ".");
    }
  }
  if (GetAttribute(root, "checksum") != HashEvents(events))
  {
    throw std::runtime_error(
      "The session " + fileName + " is damaged: its checksum does not match its events.");
  }
  // Files of older versions have only the first parts of the hash.
  if ((inputHash + ' ').rfind(GetAttribute(root, "inputs") + ' ', 0) != 0)
  {
    throw std::runtime_error("The session " + fileName +
      " was recorded with another volume or mesh. Open the volume and mesh that it was recorded "
      "with.");
  }
  return events;
}

void deformvolume::WriteAndRename(
  const std::string& fileName, const std::function<void(const std::string& name)>& write)
{
  namespace filesystem = std::filesystem;
  std::error_code error;
  filesystem::path target = filesystem::u8path(fileName);
  constexpr int mostLinks = 40; // as in Linux
  for (int i = 0; i < mostLinks && filesystem::is_symlink(target, error); ++i)
  {
    target = target.parent_path() / filesystem::read_symlink(target, error);
  }
  const std::string part = MakeFile(target.u8string() + ".part", fileName);
  const filesystem::path partPath = filesystem::u8path(part);
  try
  {
    const filesystem::file_status former = filesystem::status(target, error);
    if (filesystem::is_regular_file(former))
    {
      filesystem::permissions(
        partPath, former.permissions() | filesystem::perms::owner_write, error);
    }
    write(part);
    if (filesystem::is_regular_file(former))
    {
      filesystem::permissions(partPath, former.permissions(), error);
    }
    filesystem::rename(partPath, target, error);
    if (error)
    {
      throw std::runtime_error(
        "The file " + fileName + " cannot be written: " + error.message() + ".");
    }
  }
  catch (...)
  {
    vtksys::SystemTools::RemoveFile(part);
    throw;
  }
}
