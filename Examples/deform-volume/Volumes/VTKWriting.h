// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeVTKWriting_h
#define DeformVolumeVTKWriting_h

#include "Messages.h"

#include <vtkDataObject.h>

#include <string>

/// Writes a file with one of VTK's writers. Throws a Failure if it cannot be written.
template <typename Writer>
void Write(Writer* writer, vtkDataObject* data, const std::string& path, Messages& messages)
{
  writer->SetInputDataObject(data);
  writer->SetFileName(path.c_str());
  const bool written = writer->Write() != 0;
  messages.Check("cannot write " + path, written);
}

/// Writes a file with one of VTK's XML writers. Throws a Failure if it cannot be written.
template <typename Writer>
void WriteXML(Writer* writer, vtkDataObject* data, const std::string& path, Messages& messages)
{
  // Not appended: with recent versions of libexpat, ParaView 5.11 cannot read appended data.
  writer->SetDataModeToBinary();
  Write(writer, data, path, messages);
}

#endif
