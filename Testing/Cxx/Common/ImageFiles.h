// SPDX-License-Identifier: BSD-3-Clause
#ifndef ImageFiles_h
#define ImageFiles_h

#include "RunTests.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLImageDataWriter.h>

#include <gtest/gtest.h>

#include <string>

/// Writes an image to a .vti file in the folder of the test, and returns what a reader finds there.
inline vtkSmartPointer<vtkImageData> WriteAndRead(vtkImageData* image, const std::string& file)
{
  const std::string path = GetTestArgument("-T") + "/" + file;
  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(path.c_str());
  EXPECT_EQ(writer->Write(), 1);
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

#endif
