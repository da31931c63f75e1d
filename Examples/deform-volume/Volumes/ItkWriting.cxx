// SPDX-License-Identifier: BSD-3-Clause
#include "ItkWriting.h"

#include "Files.h"
#include "ItkImage.h"

#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>

#include <vector>

std::string WriteByITK(vtkImageData* image, vtkMatrix4x4* axes, const std::string& path)
{
  itk::ImageIOBase::Pointer io;
  if (HasSuffix(path, { ".nrrd", ".nhdr" }))
  {
    io = itk::NrrdImageIO::New();
  }
  else
  {
    io = itk::MetaImageIO::New();
  }
  vtkDataArray* const values = image->GetPointData()->GetScalars();
  io->SetFileName(path);
  io->SetNumberOfDimensions(3);
  itk::ImageIORegion region(3);
  for (int axis = 0; axis < 3; ++axis)
  {
    io->SetDimensions(axis, image->GetDimensions()[axis]);
    io->SetSpacing(axis, image->GetSpacing()[axis]);
    io->SetOrigin(axis, axes->GetElement(axis, 3));
    io->SetDirection(axis,
      std::vector<double>{
        axes->GetElement(0, axis), axes->GetElement(1, axis), axes->GetElement(2, axis) });
    region.SetIndex(axis, 0);
    region.SetSize(axis, image->GetDimensions()[axis]);
  }
  io->SetIORegion(region);
  io->SetComponentType(GetComponentType(values));
  io->SetNumberOfComponents(values->GetNumberOfComponents());
  io->SetPixelType(
    values->GetNumberOfComponents() == 1 ? itk::IOPixelEnum::SCALAR : itk::IOPixelEnum::VECTOR);
  return WriteValues(io, values->GetVoidPointer(0));
}
