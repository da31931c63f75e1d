// SPDX-License-Identifier: BSD-3-Clause
#include "MeshMaking.h"

#include "Failure.h"
#include "Messages.h"
#include "ProgressBar.h"

#include <vtkCompositeDataSet.h>
#include <vtkDataSet.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkNew.h>
#include <vtkTetGenMesher.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLGenericDataObjectReader.h>
#include <vtkXMLUnstructuredGridWriter.h>
#include <vtksys/SystemTools.hxx>

namespace
{
vtkSmartPointer<vtkDataObject> ReadMesh(
  const std::string& path, const Options& options, Messages& messages)
{
  if (!vtksys::SystemTools::FileExists(path, true))
  {
    throw Failure("cannot read " + path + ": there is no such file");
  }
  vtkNew<vtkXMLGenericDataObjectReader> reader;
  reader->SetFileName(path.c_str());
  const ProgressBar bar(reader, "reading mesh", !options.Quiet);
  reader->Update();
  messages.Check("cannot read " + path);
  vtkSmartPointer<vtkDataObject> mesh = reader->GetOutputDataObject(0);
  if (!mesh || mesh->GetNumberOfElements(vtkDataObject::POINT) == 0)
  {
    throw Failure("cannot read " + path + ": it holds no points");
  }
  return mesh;
}

vtkSmartPointer<vtkUnstructuredGrid> Mesh(
  const Options& options, vtkImageData* volume, Messages& messages, Deformation& deformation)
{
  if (options.HasLattice())
  {
    vtkNew<vtkLatticeTetrahedraSource> lattice;
    lattice->SetInputData(volume);
    lattice->SetNumberOfNodes(options.Lattice[0], options.Lattice[1], options.Lattice[2]);
    const ProgressBar bar(lattice, "lattice", !options.Quiet);
    lattice->Update();
    messages.Check("cannot make the lattice");
    return lattice->GetOutput();
  }
  vtkNew<vtkTetGenMesher> mesher;
  mesher->SetInputData(volume);
  if (options.Labels)
  {
    mesher->SetBodyModeToLabels();
  }
  if (options.Isovalue)
  {
    mesher->AutomaticIsovalueOff();
    mesher->SetIsovalue(*options.Isovalue);
  }
  mesher->SetTargetEdgeLength(options.EdgeLength);
  mesher->SetRadiusEdgeRatio(options.RadiusEdgeRatio);
  mesher->SetTetGenExecutable(options.TetGenExecutable);
  const ProgressBar bar(mesher, "meshing", !options.Quiet);
  mesher->Update();
  messages.Check("cannot mesh the body");
  if (!options.Labels)
  {
    deformation.Isovalue = mesher->GetUsedIsovalue();
  }
  return mesher->GetOutput();
}

void WriteMesh(vtkUnstructuredGrid* mesh, const std::string& path, Messages& messages)
{
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetInputData(mesh);
  writer->SetFileName(path.c_str());
  const bool written = writer->Write() != 0;
  messages.Check("cannot write " + path, written);
}
}

Deformation MakeDeformation(const Options& options, vtkImageData* volume, Messages& messages)
{
  Deformation deformation;
  if (!options.Mesh.empty())
  {
    deformation.Data = ReadMesh(options.Mesh, options, messages);
    deformation.Displacement = options.Displacement;
    if (!options.Rest.empty())
    {
      deformation.Rest = ReadMesh(options.Rest, options, messages);
    }
  }
  else
  {
    const vtkSmartPointer<vtkUnstructuredGrid> mesh = Mesh(options, volume, messages, deformation);
    for (const Push& push : options.Pushes)
    {
      if (push.Folds())
      {
        messages.DisplayWarningText("A push is too strong for its radius: the volume folds over.");
      }
    }
    if (ApplyPushes(options.Pushes, mesh) == 0)
    {
      messages.DisplayWarningText("No node of the mesh lies within the radius of a push, so that "
                                  "nothing moves. Are the coordinates those of the file?");
    }
    if (!options.MeshOutput.empty())
    {
      WriteMesh(mesh, options.MeshOutput, messages);
    }
    deformation.Data = mesh;
    deformation.Displacement = PushArrayName;
  }
  deformation.NumberOfNodes = deformation.Data->GetNumberOfElements(vtkDataObject::POINT);
  deformation.NumberOfCells = deformation.Data->GetNumberOfElements(vtkDataObject::CELL);
  return deformation;
}
