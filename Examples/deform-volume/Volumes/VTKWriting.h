// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVTKWriting_h
#define DeformVolumeVTKWriting_h

#include <vtkDataObject.h>

#include <string>

/// Writes a file with one of VTK's writers. Returns false if it cannot be written.
template <typename Writer>
bool Write(Writer* writer, vtkDataObject* data, const std::string& path)
{
  writer->SetInputDataObject(data);
  writer->SetFileName(path.c_str());
  return writer->Write() != 0;
}

/// Writes a file with one of VTK's XML writers. Returns false if it cannot be written.
template <typename Writer>
bool WriteXML(Writer* writer, vtkDataObject* data, const std::string& path)
{
  // Not appended: with recent versions of libexpat, ParaView 5.11 cannot read appended data.
  writer->SetDataModeToBinary();
  return Write(writer, data, path);
}

#endif
