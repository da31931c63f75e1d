// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeItkImage_h
#define DeformVolumeItkImage_h

#include <itkImageIOBase.h>

#include <vtkDataArray.h>
#include <vtkSmartPointer.h>

#include <map>
#include <string>

/// What ITK's readers and writers of images have for all formats. Functions throw a Failure that
/// names the file.

/// Reads the header of a file. Refuses values that are no real numbers.
void ReadHeader(itk::ImageIOBase* io, const std::string& path);

/// Reads all values of a file whose header has been read, in the type of the file.
vtkSmartPointer<vtkDataArray> ReadValues(itk::ImageIOBase* io);

/// The fields of the header that ITK keeps as texts.
std::map<std::string, std::string> GetTexts(itk::ImageIOBase* io);

/// The type of an array's values. Throws a Failure for a type that no image of ITK has.
itk::IOComponentEnum GetComponentType(vtkDataArray* values);

/// Writes a file whose header has been set.
void WriteValues(itk::ImageIOBase* io, const void* values);

#endif
