// SPDX-License-Identifier: BSD-3-Clause
#include "DICOMFile.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace
{
constexpr std::uint32_t TransferSyntax = 0x00020010;
constexpr std::uint32_t PixelData = 0x7FE00010;
constexpr std::uint32_t Item = 0xFFFEE000;
constexpr std::uint32_t ItemEnd = 0xFFFEE00D;
constexpr std::uint32_t SequenceEnd = 0xFFFEE0DD;
constexpr std::uint32_t Undefined = 0xFFFFFFFF;

bool IsMeta(std::uint32_t tag)
{
  return tag >> 16 == 2;
}

bool IsOfSequence(std::uint32_t tag)
{
  return tag == Item || tag == ItemEnd || tag == SequenceEnd;
}

// Types whose length has four bytes, which follow two unused bytes.
bool IsLong(const std::string& type)
{
  const std::string types = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
  return types.find(type) != std::string::npos;
}
}

struct DICOMFile::Element
{
  std::uint32_t Tag = 0;
  std::string Type;
  std::uint32_t Length = 0;
};

DICOMFile::DICOMFile(const std::string& path)
  : File(path, std::ios::binary)
{
  this->File.seekg(0, std::ios::end);
  this->Size = this->File.tellg();
  this->FindBegin();
  if (this->IsDICOM())
  {
    this->File.clear();
    this->File.seekg(this->Begin);
    this->Read();
  }
}

void DICOMFile::FindBegin()
{
  constexpr std::streamoff preamble = 128;
  char magic[4] = {};
  this->File.seekg(preamble);
  this->File.read(magic, sizeof(magic));
  if (std::string(magic, sizeof(magic)) == "DICM")
  {
    this->Begin = preamble + static_cast<std::streamoff>(sizeof(magic));
    return;
  }
  // Old files have no preamble. They begin with an element of group 8 or 2.
  char start[4] = {};
  this->File.clear();
  this->File.seekg(0);
  this->File.read(start, sizeof(start));
  if (this->File && (start[0] == 8 || start[0] == 2) && start[1] == 0 && start[3] == 0)
  {
    this->Begin = 0;
  }
}

std::uint32_t DICOMFile::ReadNumber(int bytes)
{
  unsigned char read[4] = {};
  this->File.read(reinterpret_cast<char*>(read), bytes);
  std::uint32_t number = 0;
  for (int i = 0; i < bytes; ++i)
  {
    number |= static_cast<std::uint32_t>(read[this->IsBigEndian ? bytes - 1 - i : i]) << (8 * i);
  }
  return number;
}

bool DICOMFile::ReadElement(Element& element)
{
  const std::uint32_t group = this->ReadNumber(2);
  element.Tag = group << 16 | this->ReadNumber(2);
  element.Type.clear();
  if (this->IsImplicit || IsOfSequence(element.Tag))
  {
    element.Length = this->ReadNumber(4);
  }
  else
  {
    element.Type.resize(2);
    this->File.read(&element.Type[0], 2);
    if (IsLong(element.Type))
    {
      this->ReadNumber(2);
    }
    element.Length = this->ReadNumber(IsLong(element.Type) ? 4 : 2);
  }
  return static_cast<bool>(this->File);
}

// Sets the encoding of all elements after the first ones (group 2), which are always explicit and
// little endian. next: the first of these elements, read as explicit and little endian.
void DICOMFile::SetEncoding(const Element& next)
{
  const std::string syntax = this->GetText(TransferSyntax);
  const bool hasType = std::all_of(next.Type.begin(), next.Type.end(),
    [](char character) { return character >= 'A' && character <= 'Z'; });
  this->IsImplicit = syntax.empty() ? !hasType : syntax == "1.2.840.10008.1.2";
  this->IsBigEndian = syntax == "1.2.840.10008.1.2.2";
}

void DICOMFile::Read()
{
  // Number of open elements of undefined length: sequences, their items, and compressed pixels.
  int depth = 0;
  // Depth of the element of the type UN, whose contents are implicit; 0: there is none.
  int implicitDepth = 0;
  bool isMeta = true;
  constexpr std::streamoff shortestElement = 8;
  while (this->File.tellg() + shortestElement <= this->Size)
  {
    const std::streamoff begin = this->File.tellg();
    Element element;
    this->Complete = this->ReadElement(element);
    if (!this->Complete)
    {
      return;
    }
    if (isMeta && !IsMeta(element.Tag))
    {
      isMeta = false;
      this->SetEncoding(element);
      if (this->IsDeflated())
      {
        return;
      }
      this->File.clear();
      this->File.seekg(begin);
      continue;
    }
    this->Pixels = this->Pixels || (element.Tag == PixelData && depth == 0);
    constexpr std::uint32_t modalityTable = 0x00283000;
    this->ModalityTable =
      this->ModalityTable || (element.Tag == modalityTable && depth == 0 && element.Length > 0);
    if (element.Tag == ItemEnd || element.Tag == SequenceEnd)
    {
      --depth;
      if (depth < implicitDepth)
      {
        this->IsImplicit = false;
        implicitDepth = 0;
      }
      continue;
    }
    if (element.Length == Undefined)
    {
      ++depth;
      if (element.Type == "UN")
      {
        this->IsImplicit = true;
        implicitDepth = depth;
      }
      continue;
    }
    const std::streamoff end = this->File.tellg() + static_cast<std::streamoff>(element.Length);
    this->Complete = end <= this->Size;
    if (!this->Complete)
    {
      return;
    }
    constexpr std::uint32_t longest = 1024;
    if (depth == 0 && element.Length <= longest && element.Tag < PixelData)
    {
      std::string& text = this->Texts[element.Tag];
      text.resize(element.Length);
      this->File.read(&text[0], element.Length);
    }
    this->File.seekg(end);
  }
  // Some writers append zeros.
  char rest[shortestElement] = {};
  this->File.read(rest, shortestElement);
  this->Complete = depth <= 0 && std::count(rest, rest + shortestElement, 0) == shortestElement;
}

bool DICOMFile::IsDeflated() const
{
  return this->GetText(TransferSyntax) == "1.2.840.10008.1.2.1.99";
}

std::string DICOMFile::GetText(std::uint32_t tag) const
{
  const auto found = this->Texts.find(tag);
  std::string text = found == this->Texts.end() ? "" : found->second;
  text.erase(text.find_last_not_of(std::string(" \0", 2)) + 1);
  return text;
}

int DICOMFile::GetShort(std::uint32_t tag) const
{
  const auto found = this->Texts.find(tag);
  if (found == this->Texts.end() || found->second.size() < 2)
  {
    return 0;
  }
  const auto first = static_cast<unsigned char>(found->second[0]);
  const auto second = static_cast<unsigned char>(found->second[1]);
  return this->IsBigEndian ? first << 8 | second : second << 8 | first;
}

bool DICOMFile::GetNumbers(std::uint32_t tag, int count, double* numbers) const
{
  std::istringstream text(this->GetText(tag));
  std::string part;
  int read = 0;
  while (std::getline(text, part, '\\'))
  {
    std::istringstream number(part);
    if (read == count || !(number >> numbers[read]) || !std::isfinite(numbers[read]) ||
      !(number >> std::ws).eof())
    {
      return false;
    }
    ++read;
  }
  return read == count;
}
