// SPDX-License-Identifier: BSD-3-Clause
// A minimal program that deforms a volume: minimal IN.vti OUT.vti
// bends the volume along x by a sine of z. The amplitude is a tenth of the height of the volume.
#include <vtkArrayCalculator.h>
#include <vtkDeformVolumeFilter.h>
#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkNew.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLImageDataWriter.h>

#include <iostream>
#include <string>

int main(int argc, char* argv[])
{
  if (argc != 3)
  {
    std::cerr << "usage: minimal IN.vti OUT.vti\n";
    return 2;
  }
  vtkNew<vtkXMLImageDataReader> reader;
  reader->SetFileName(argv[1]);

  vtkNew<vtkLatticeTetrahedraSource> mesh;
  mesh->SetInputConnection(reader->GetOutputPort());
  mesh->SetNumberOfNodes(20, 20, 20);

  reader->Update();
  const double* bounds = reader->GetOutput()->GetBounds();
  const std::string height = std::to_string(bounds[5] - bounds[4]);
  vtkNew<vtkArrayCalculator> displacement;
  displacement->SetInputConnection(mesh->GetOutputPort());
  displacement->AddCoordinateScalarVariable("z", 2);
  displacement->SetFunction(
    ("0.1 * " + height + " * sin(6.2832 * z / " + height + ") * iHat").c_str());
  displacement->SetResultArrayName("Displacement");

  vtkNew<vtkDeformVolumeFilter> deform;
  deform->SetInputConnection(reader->GetOutputPort());
  deform->SetDeformationConnection(displacement->GetOutputPort());
  deform->SetInputArrayToProcess(0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Displacement");

  vtkNew<vtkXMLImageDataWriter> writer;
  writer->SetDataModeToBinary();
  writer->SetInputConnection(deform->GetOutputPort());
  writer->SetFileName(argv[2]);
  const bool written = writer->Write() != 0;
  return written && deform->GetNumberOfCoveredVoxels() > 0 ? 0 : 1;
}
