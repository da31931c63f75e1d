// SPDX-License-Identifier: BSD-3-Clause
#include "NetcdfFile.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <vector>

namespace
{
/// Reads the numbers of a header, the most significant byte first.
class Header
{
public:
  explicit Header(const std::string& path)
    : File(path, std::ios::binary)
  {
    this->File.seekg(3);
    this->Version = static_cast<int>(this->Read(1));
  }

  int GetVersion() const { return this->Version; }
  bool Failed() const { return !this->File; }

  std::uint64_t Read(int bytes)
  {
    std::uint64_t number = 0;
    for (int i = 0; i < bytes; ++i)
    {
      number = number << 8 | static_cast<std::uint64_t>(this->File.get() & 0xff);
    }
    return number;
  }
  std::uint64_t ReadType() { return this->Read(4); }
  /// A number of elements, a length, a size, or the number of a dimension.
  std::uint64_t ReadCount() { return this->Read(this->Version == 5 ? 8 : 4); }
  std::uint64_t ReadOffset() { return this->Read(this->Version == 1 ? 4 : 8); }

  static std::uint64_t Pad(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }
  void Skip(std::uint64_t bytes)
  {
    this->File.seekg(static_cast<std::streamoff>(Pad(bytes)), std::ios::cur);
  }
  void SkipName() { this->Skip(this->ReadCount()); }

  static std::uint64_t GetSize(std::uint64_t type)
  {
    // byte, char, short, int, float, double; in CDF-5 also ubyte, ushort, uint, int64 and uint64
    static const int sizes[] = { 0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8 };
    return type < 12 ? static_cast<std::uint64_t>(sizes[type]) : 0;
  }

  /// Skips the type of a list, and returns the number of its elements. Both are 0 for an empty
  /// list.
  std::uint64_t ReadListSize()
  {
    this->ReadType();
    return this->Failed() ? 0 : this->ReadCount();
  }

  void SkipAttributes()
  {
    for (std::uint64_t left = this->ReadListSize(); left > 0 && !this->Failed(); --left)
    {
      this->SkipName();
      const std::uint64_t type = this->ReadType();
      this->Skip(this->ReadCount() * GetSize(type));
    }
  }

private:
  std::ifstream File;
  int Version = 0;
};

struct Variable
{
  std::uint64_t Begin = 0;
  std::uint64_t Size = 0;
  bool HasRecords = false;
};

Variable ReadVariable(Header& header, const std::vector<std::uint64_t>& lengths)
{
  Variable variable;
  variable.Size = 1;
  header.SkipName();
  for (std::uint64_t left = header.ReadCount(); left > 0 && !header.Failed(); --left)
  {
    const std::uint64_t dimension = header.ReadCount();
    const std::uint64_t length = dimension < lengths.size() ? lengths[dimension] : 1;
    variable.HasRecords = variable.HasRecords || length == 0;
    variable.Size *= std::max<std::uint64_t>(length, 1);
  }
  header.SkipAttributes();
  variable.Size *= Header::GetSize(header.ReadType());
  header.ReadCount(); // the size in the file is not used: it overflows for large variables
  variable.Begin = header.ReadOffset();
  return variable;
}
}

bool IsNetcdfCutOff(const std::string& path)
{
  Header header(path);
  if (header.GetVersion() != 1 && header.GetVersion() != 2 && header.GetVersion() != 5)
  {
    return false;
  }
  std::uint64_t records = header.ReadCount();
  if (records == 0xffffffff || records == ~std::uint64_t(0))
  {
    records = 0; // the writer did not know their number
  }
  std::vector<std::uint64_t> lengths;
  for (std::uint64_t left = header.ReadListSize(); left > 0 && !header.Failed(); --left)
  {
    header.SkipName();
    lengths.push_back(header.ReadCount());
  }
  header.SkipAttributes();
  std::vector<Variable> variables;
  for (std::uint64_t left = header.ReadListSize(); left > 0 && !header.Failed(); --left)
  {
    variables.push_back(ReadVariable(header, lengths));
  }
  // A record holds a part of each variable with records. If only one variable has records, its
  // parts are not padded.
  std::uint64_t record = 0;
  std::uint64_t parts = 0;
  for (const Variable& variable : variables)
  {
    record += variable.HasRecords ? Header::Pad(variable.Size) : 0;
    parts += variable.HasRecords ? 1 : 0;
  }
  std::uint64_t end = 0;
  for (const Variable& variable : variables)
  {
    if (!variable.HasRecords)
    {
      end = std::max(end, variable.Begin + variable.Size);
    }
    else if (records > 0)
    {
      end = std::max(end,
        variable.Begin + variable.Size + (records - 1) * (parts == 1 ? variable.Size : record));
    }
  }
  return header.Failed() || vtksys::SystemTools::FileLength(path) < end;
}
