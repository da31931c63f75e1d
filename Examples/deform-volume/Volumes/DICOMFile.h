// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeDICOMFile_h
#define DeformVolumeDICOMFile_h

#include <cstdint>
#include <fstream>
#include <map>
#include <string>

/// The elements of a DICOM file that describe its contents and its position. ITK's GDCM decodes the
/// pixels, but Debian's GDCM exits the program by an assertion if a file is truncated, and uses a
/// spacing of 1 if there is none.
class DICOMFile
{
public:
  explicit DICOMFile(const std::string& path);

  /// Whether the file begins like a DICOM file. Other files are not read any further.
  bool IsDICOM() const { return this->Begin >= 0; }
  /// False if the file ends within an element or a sequence.
  bool IsComplete() const { return this->Complete; }
  /// Whether all elements after the first ones (group 2) are compressed. Compressed
  /// elements are not read.
  bool IsDeflated() const;
  bool HasPixels() const { return this->Pixels; }
  /// Whether values are to be looked up in a table (modality LUT sequence, PS3.3 C.11.1).
  bool HasModalityTable() const { return this->ModalityTable; }

  /// Get an element by its tag: 0x00200032 is (0020,0032). "" or 0 if it is missing or empty.
  std::string GetText(std::uint32_t tag) const;
  int GetShort(std::uint32_t tag) const;
  /// Get numbers with backslashes between them. Returns false unless there are exactly `count`
  /// numbers, all finite.
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
  bool ModalityTable = false;
  std::map<std::uint32_t, std::string> Texts;
};

#endif
