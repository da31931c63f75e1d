// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeItkImage_h
#define DeformVolumeItkImage_h

#include <itkImageIOBase.h>

#include <vtkDataArray.h>
#include <vtkSmartPointer.h>

#include <string>

/// What ITK's readers and writers of images have for all formats. Functions throw a Failure that
/// names the file.

/// Reads the header of a file. Refuses values that are no real numbers, and files without voxels.
/// reason: what is wrong with a file whose header ITK cannot read.
void ReadHeader(itk::ImageIOBase* io, const std::string& path, const std::string& reason);

/// What is said where data cannot be read.
inline constexpr const char* DataMissing = "its data are missing, damaged, or not complete";

/// Reads all values of a file whose header has been read, in the type of the file. complaints: what
/// the libraries have written to std::cerr, which is not shown.
vtkSmartPointer<vtkDataArray> ReadValues(itk::ImageIOBase* io, std::string& complaints);

/// The type of an array's values. Throws a Failure for a type that no image of ITK has.
itk::IOComponentEnum GetComponentType(vtkDataArray* values);

/// Writes a file whose header has been set.
void WriteValues(itk::ImageIOBase* io, const void* values);

#endif
