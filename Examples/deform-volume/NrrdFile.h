// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeNrrdFile_h
#define DeformVolumeNrrdFile_h

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// An NRRD file with vectors: three axes of space and one axis of components, at any place.
/// vtkNrrdReader reads one slice of such a file only. Encodings raw and gzip, little and big
/// endian, data in the file or in one other file. Every failure is a Failure.
class NrrdFile
{
public:
  /// Reads the header.
  explicit NrrdFile(const std::string& path);

  /// The value of a field of the header, or of a key (key:=value); "" where it is missing.
  std::string Get(const std::string& field) const;

  int GetNumberOfAxes() const { return static_cast<int>(this->Sizes.size()); }

  /// Reads the data: the axes of space become those of the image, in their order, and the fourth
  /// axis its components. Origin, spacing and direction are left to the caller.
  vtkSmartPointer<vtkImageData> ReadVectors() const;

private:
  int FindVectorAxis() const;
  std::vector<unsigned char> ReadBytes(std::uint64_t size) const;
  [[noreturn]] void Fail(const std::string& reason) const;

  std::string Path;
  std::map<std::string, std::string> Fields;
  std::vector<int> Sizes;
  std::uint64_t HeaderSize = 0;
};

#endif
