// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeItkImage_h
#define DeformVolumeItkImage_h

#include <itkImageIOBase.h>

#include <vtkDataArray.h>
#include <vtkSmartPointer.h>

#include <string>

/// Functions for all image formats of ITK. They throw a Failure that names the file.

/// Reads the header of a file. Throws a Failure if the values are not real numbers, or if the file
/// has no voxels. reason: the message for a file whose header ITK cannot read.
void ReadHeader(itk::ImageIOBase* io, const std::string& path, const std::string& reason);

/// The message if data cannot be read.
inline constexpr const char* DataMissing = "its data are missing, damaged, or not complete";

/// Reads all values, in the type of the file, after ReadHeader(). complaints: the text that
/// libraries have written to std::cerr. It is not printed.
vtkSmartPointer<vtkDataArray> ReadValues(itk::ImageIOBase* io, std::string& complaints);

/// The ITK type of the values of an array. Throws a Failure if ITK has no such type.
itk::IOComponentEnum GetComponentType(vtkDataArray* values);

/// Writes a file. The header must have been set. Returns what went wrong, or "".
std::string WriteValues(itk::ImageIOBase* io, const void* values);

#endif
