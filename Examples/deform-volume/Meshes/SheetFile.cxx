// SPDX-License-Identifier: BSD-3-Clause
#include "SheetFile.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <vector>

namespace
{
/// A number of each element; or a list of numbers, if CountType is not "".
struct Property
{
  std::string CountType;
  std::string Type;
};

struct Element
{
  long long Count = 0;
  std::vector<Property> Properties;
};

enum class Encoding
{
  Unknown,
  Text,
  LittleEndian,
  BigEndian
};

int GetSize(const std::string& type)
{
  static const std::map<std::string, int> sizes{ { "char", 1 }, { "uchar", 1 }, { "int8", 1 },
    { "uint8", 1 }, { "short", 2 }, { "ushort", 2 }, { "int16", 2 }, { "uint16", 2 }, { "int", 4 },
    { "uint", 4 }, { "int32", 4 }, { "uint32", 4 }, { "float", 4 }, { "float32", 4 },
    { "double", 8 }, { "float64", 8 } };
  const auto found = sizes.find(type);
  return found != sizes.end() ? found->second : 0;
}

Encoding ReadHeader(std::istream& file, std::vector<Element>& elements)
{
  const std::map<std::string, Encoding> encodings{ { "ascii", Encoding::Text },
    { "binary_little_endian", Encoding::LittleEndian },
    { "binary_big_endian", Encoding::BigEndian } };
  Encoding encoding = Encoding::Unknown;
  std::string line;
  while (std::getline(file, line))
  {
    std::istringstream words(line);
    std::string word;
    std::string type;
    words >> word >> type;
    if (word == "end_header")
    {
      return encoding;
    }
    if (word == "format" && encodings.count(type) > 0)
    {
      encoding = encodings.at(type);
    }
    else if (word == "element")
    {
      elements.emplace_back();
      words >> elements.back().Count;
    }
    else if (word == "property" && !elements.empty())
    {
      Property property{ "", type };
      if (type == "list")
      {
        words >> property.CountType >> property.Type;
      }
      elements.back().Properties.push_back(property);
    }
  }
  return Encoding::Unknown;
}

/// Reads the length of a list.
long long ReadCount(std::istream& file, const std::string& type, Encoding encoding)
{
  if (encoding == Encoding::Text)
  {
    long long count = -1;
    file >> count;
    return count;
  }
  std::vector<char> bytes(static_cast<std::size_t>(GetSize(type)));
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (encoding == Encoding::LittleEndian)
  {
    std::reverse(bytes.begin(), bytes.end());
  }
  long long count = 0;
  for (const char byte : bytes)
  {
    count = count << 8 | static_cast<unsigned char>(byte);
  }
  return count;
}

void Skip(std::istream& file, long long count, const std::string& type, Encoding encoding)
{
  if (encoding != Encoding::Text)
  {
    file.ignore(count * GetSize(type));
    // ignore() does not fail at the end of the file.
    file.setstate(file.eof() ? std::ios::failbit : std::ios::goodbit);
  }
  std::string word;
  for (long long i = 0; encoding == Encoding::Text && i < count && file; ++i)
  {
    file >> word;
  }
}
}

bool IsStlCutOff(const std::string& path)
{
  constexpr std::size_t headerSize = 80;
  constexpr std::uint64_t triangleSize = 50;
  unsigned char start[headerSize + 4] = {};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(start), sizeof start);
  const bool isBinary = file && std::count(std::begin(start), std::end(start), 0) > 0;
  std::uint64_t triangles = 0;
  for (std::size_t i = 0; i < 4; ++i)
  {
    triangles |= std::uint64_t(start[headerSize + i]) << (8 * i);
  }
  return isBinary &&
    vtksys::SystemTools::FileLength(path) < sizeof start + triangles * triangleSize;
}

bool IsPlyCutOff(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::vector<Element> elements;
  const Encoding encoding = ReadHeader(file, elements);
  if (encoding == Encoding::Unknown)
  {
    return true;
  }
  for (const Element& element : elements)
  {
    for (long long i = 0; i < element.Count && file; ++i)
    {
      for (const Property& property : element.Properties)
      {
        const long long count =
          property.CountType.empty() ? 1 : ReadCount(file, property.CountType, encoding);
        if (count < 0 || GetSize(property.Type) == 0)
        {
          return true;
        }
        Skip(file, count, property.Type, encoding);
      }
    }
  }
  return !file;
}
