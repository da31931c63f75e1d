// SPDX-License-Identifier: BSD-3-Clause
#include "NrrdFile.h"

#include "Failure.h"

#include <vtkByteSwap.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>
#include <vtk_zlib.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

namespace
{
std::string Trim(const std::string& text)
{
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos
    ? ""
    : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The words of a list that spaces separate.
std::vector<std::string> GetWords(const std::string& text)
{
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;)
  {
    words.push_back(vtksys::SystemTools::LowerCase(word));
  }
  return words;
}

/// The type of VTK for the name of a type; VTK_VOID for others.
int GetType(const std::string& name)
{
  const std::pair<int, std::vector<const char*>> types[] = {
    { VTK_SIGNED_CHAR, { "signed char", "int8", "int8_t" } },
    { VTK_UNSIGNED_CHAR, { "uchar", "unsigned char", "uint8", "uint8_t" } },
    { VTK_SHORT, { "short", "short int", "signed short", "signed short int", "int16", "int16_t" } },
    { VTK_UNSIGNED_SHORT,
      { "ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t" } },
    { VTK_INT, { "int", "signed int", "int32", "int32_t" } },
    { VTK_UNSIGNED_INT, { "uint", "unsigned int", "uint32", "uint32_t" } },
    { VTK_FLOAT, { "float" } },
    { VTK_DOUBLE, { "double" } },
  };
  for (const auto& [type, names] : types)
  {
    if (std::find(names.begin(), names.end(), name) != names.end())
    {
      return type;
    }
  }
  return VTK_VOID;
}

std::vector<unsigned char> ReadFile(const std::string& path, std::uint64_t first)
{
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::uint64_t size = file ? static_cast<std::uint64_t>(file.tellg()) : 0;
  if (!file || size < first)
  {
    throw Failure("cannot read " + path + ": the file is missing, or ends before its data");
  }
  std::vector<unsigned char> bytes(static_cast<std::size_t>(size - first));
  file.seekg(static_cast<std::streamoff>(first));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return bytes;
}

/// As many bytes of a gzip stream as are wanted; fewer where it ends or is damaged.
std::vector<unsigned char> Unzip(const std::vector<unsigned char>& bytes, std::uint64_t size)
{
  std::vector<unsigned char> result(static_cast<std::size_t>(size));
  z_stream stream = {};
  constexpr int anyHeader = 15 + 32;
  if (inflateInit2(&stream, anyHeader) != Z_OK)
  {
    return {};
  }
  std::size_t in = 0;
  std::size_t out = 0;
  constexpr std::size_t most = std::numeric_limits<uInt>::max() / 2;
  for (int state = Z_OK; state == Z_OK && out < result.size();)
  {
    const std::size_t input = std::min(most, bytes.size() - in);
    const std::size_t output = std::min(most, result.size() - out);
    stream.next_in = const_cast<Bytef*>(bytes.data() + in);
    stream.avail_in = static_cast<uInt>(input);
    stream.next_out = result.data() + out;
    stream.avail_out = static_cast<uInt>(output);
    state = inflate(&stream, Z_NO_FLUSH);
    in += input - stream.avail_in;
    out += output - stream.avail_out;
  }
  inflateEnd(&stream);
  result.resize(out);
  return result;
}
}

void NrrdFile::Fail(const std::string& reason) const
{
  throw Failure("cannot read " + this->Path + ": " + reason);
}

NrrdFile::NrrdFile(const std::string& path)
  : Path(path)
{
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!std::getline(file, line) || line.rfind("NRRD", 0) != 0)
  {
    this->Fail("it is no NRRD file");
  }
  while (std::getline(file, line) && !Trim(line).empty())
  {
    const std::size_t colon = line.find(':');
    if (line[0] == '#' || colon == std::string::npos)
    {
      continue;
    }
    const bool isKey = colon + 1 < line.size() && line[colon + 1] == '=';
    std::string field = Trim(line.substr(0, colon));
    field = field == "datafile" ? "data file" : field;
    this->Fields[field] = Trim(line.substr(colon + (isKey ? 2 : 1)));
  }
  this->HeaderSize = file ? static_cast<std::uint64_t>(file.tellg()) : 0;
  std::istringstream sizes(this->Get("sizes"));
  for (int size = 0; sizes >> size;)
  {
    if (size < 1)
    {
      this->Fail("its sizes are " + this->Get("sizes"));
    }
    this->Sizes.push_back(size);
  }
}

std::string NrrdFile::Get(const std::string& field) const
{
  const auto found = this->Fields.find(field);
  return found == this->Fields.end() ? "" : found->second;
}

int NrrdFile::FindVectorAxis() const
{
  // That without a direction in space, or else the one whose kind is none of space or time.
  const std::vector<std::string> directions = GetWords(this->Get("space directions"));
  const auto none = std::find(directions.begin(), directions.end(), "none");
  if (directions.size() == this->Sizes.size() && none != directions.end())
  {
    return static_cast<int>(none - directions.begin());
  }
  const std::vector<std::string> kinds = GetWords(this->Get("kinds"));
  for (std::size_t axis = 0; axis < kinds.size(); ++axis)
  {
    if (kinds[axis].find("vector") != std::string::npos || kinds[axis] == "list")
    {
      return static_cast<int>(axis);
    }
  }
  this->Fail("its four axes need one of the kind vector: the header's \"kinds\" are \"" +
    this->Get("kinds") + "\"");
}

std::vector<unsigned char> NrrdFile::ReadBytes(std::uint64_t size) const
{
  std::string path = this->Path;
  std::uint64_t first = this->HeaderSize;
  const std::string other = this->Get("data file");
  if (!other.empty())
  {
    if (other.rfind("LIST", 0) == 0 || other.find('%') != std::string::npos)
    {
      this->Fail("its data are in several files, which this program does not read");
    }
    path = vtksys::SystemTools::CollapseFullPath(other,
      vtksys::SystemTools::GetParentDirectory(vtksys::SystemTools::CollapseFullPath(this->Path)));
    first = 0;
  }
  for (const char* skip : { "line skip", "lineskip", "byte skip", "byteskip" })
  {
    const std::string number = this->Get(skip);
    if (!number.empty() && number != "0")
    {
      this->Fail(
        std::string("its data begin after a \"") + skip + "\", which this program does not read");
    }
  }
  std::vector<unsigned char> bytes = ReadFile(path, first);
  const std::string encoding = vtksys::SystemTools::LowerCase(this->Get("encoding"));
  if (encoding == "gzip" || encoding == "gz")
  {
    bytes = Unzip(bytes, size);
  }
  else if (encoding != "raw")
  {
    this->Fail("its encoding is " + encoding + ", where this program reads raw and gzip");
  }
  if (bytes.size() < size)
  {
    this->Fail("its data have " + std::to_string(bytes.size()) + " bytes where the header says " +
      std::to_string(size));
  }
  return bytes;
}

vtkSmartPointer<vtkImageData> NrrdFile::ReadVectors() const
{
  if (this->Sizes.size() != 4)
  {
    this->Fail("it has " + std::to_string(this->Sizes.size()) + " axes where four are expected");
  }
  const int type = GetType(vtksys::SystemTools::LowerCase(this->Get("type")));
  if (type == VTK_VOID)
  {
    this->Fail("its type is " + this->Get("type") + ", where float or double is expected");
  }
  const int vectorAxis = this->FindVectorAxis();
  // Elements from one to the next on each axis of the file: components, then x, y and z.
  std::array<std::uint64_t, 4> steps{};
  std::array<int, 4> sizes{};
  std::uint64_t step = 1;
  int next = 1;
  for (int axis = 0; axis < 4; ++axis)
  {
    const int place = axis == vectorAxis ? 0 : next++;
    steps[place] = step;
    sizes[place] = this->Sizes[axis];
    step *= static_cast<std::uint64_t>(this->Sizes[axis]);
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(sizes[1], sizes[2], sizes[3]);
  const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  array->SetName("Vectors");
  const auto width = static_cast<std::uint64_t>(array->GetDataTypeSize());
  const std::vector<unsigned char> bytes = this->ReadBytes(step * width);
  array->SetNumberOfComponents(sizes[0]);
  array->SetNumberOfTuples(image->GetNumberOfPoints());
  auto* values = static_cast<unsigned char*>(array->GetVoidPointer(0));
  if (vectorAxis == 0)
  {
    std::memcpy(values, bytes.data(), static_cast<std::size_t>(step * width));
  }
  for (int z = 0; vectorAxis != 0 && z < sizes[3]; ++z)
  {
    for (int y = 0; y < sizes[2]; ++y)
    {
      for (int x = 0; x < sizes[1]; ++x)
      {
        const unsigned char* source =
          bytes.data() + (z * steps[3] + y * steps[2] + x * steps[1]) * width;
        for (int component = 0; component < sizes[0]; ++component, values += width)
        {
          std::memcpy(values, source + component * steps[0] * width, width);
        }
      }
    }
  }
  const std::string endian = vtksys::SystemTools::LowerCase(this->Get("endian"));
  if (width > 1 && endian != "little" && endian != "big")
  {
    this->Fail("its header says no endian, little or big");
  }
  const auto count = static_cast<std::size_t>(step);
#ifdef VTK_WORDS_BIGENDIAN
  const bool swap = endian == "little";
#else
  const bool swap = endian == "big";
#endif
  if (swap && width > 1)
  {
    vtkByteSwap::SwapVoidRange(array->GetVoidPointer(0), count, static_cast<std::size_t>(width));
  }
  image->GetPointData()->SetScalars(array);
  return image;
}
