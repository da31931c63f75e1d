// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDICOMFile_h
#define DeformVolumeDICOMFile_h

#include <cstdint>
#include <fstream>
#include <map>
#include <string>

/// The elements of a DICOM file that say what it holds and where that lies. Debian's GDCM, which
/// decodes the pixels, ends the program by an assertion where a file is truncated, and takes a
/// spacing of 1 where it finds none.
class DICOMFile
{
public:
  explicit DICOMFile(const std::string& path);

  /// Whether the file begins as DICOM files do. The rest is known of these only.
  bool IsDICOM() const { return this->Begin >= 0; }
  /// False where the file ends within an element or a sequence.
  bool IsComplete() const { return this->Complete; }
  /// Whether all but its first elements is compressed, so that nothing else is known of it.
  bool IsDeflated() const;
  bool HasPixels() const { return this->Pixels; }

  /// Elements by tag: 0x00200032 is (0020,0032). What is missing or empty is "", or 0.
  std::string GetText(std::uint32_t tag) const;
  int GetShort(std::uint32_t tag) const;
  /// Numbers with a backslash between them. False unless there are so many, all finite.
  bool GetNumbers(std::uint32_t tag, int count, double* numbers) const;

private:
  struct Element;

  void FindBegin();
  void Read();
  bool ReadElement(Element& element);
  std::uint32_t ReadNumber(int bytes);
  void SetEncoding(const Element& next);

  std::ifstream File;
  std::streamoff Size = 0;
  std::streamoff Begin = -1;
  bool IsImplicit = false;
  bool IsBigEndian = false;
  bool Complete = true;
  bool Pixels = false;
  std::map<std::uint32_t, std::string> Texts;
};

#endif
