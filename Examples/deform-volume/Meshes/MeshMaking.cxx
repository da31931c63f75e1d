// SPDX-License-Identifier: BSD-3-Clause
#include "MeshMaking.h"

#include "ChainMail.h"
#include "ElasticModel.h"
#include "Failure.h"
#include "FieldReading.h"
#include "MeshContents.h"
#include "MeshReading.h"
#include "Messages.h"
#include "OptionChecks.h"
#include "OutputFile.h"
#include "ProgressBar.h"
#include "VTKWriting.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkMath.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTetGenMesher.h>
#include <vtkTetra.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <algorithm>
#include <cmath>
#include <iomanip>

namespace
{
// Returns the edge length in world units; 0: the default of the mesher. Without --edge-length,
// --model fem uses twice the default of the mesher: finite elements have mid-side nodes, so that
// edges twice as long give as many nodes.
double GetEdgeLength(const Options& options, vtkImageData* volume)
{
  if (options.EdgeLength != 0.0 || !options.HasMidSideNodes())
  {
    return options.EdgeLength;
  }
  constexpr double partOfDiagonal = 0.1; // twice that of the mesher
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    const double length = (volume->GetDimensions()[axis] - 1) * volume->GetSpacing()[axis];
    square += length * length;
  }
  return partOfDiagonal * std::sqrt(square);
}

// Whether voxels around the body have a material of their own. Air has the least value.
bool HasMaterialOfAir(const Options& options, vtkDataArray* values)
{
  double range[2];
  values->GetFiniteRange(range, 0);
  return std::any_of(options.Materials.begin(), options.Materials.end(),
    [&](const MaterialOfValues& material)
    {
      const double air = material.IsOfLabel ? 0.0 : range[0];
      return material.Minimum <= air && air < material.Maximum;
    });
}

// Describes how large the simulated body is, and warns if it is much larger than the voxels show.
void CompareVolumes(const Options& options, vtkImageData* volume, vtkTetGenMesher* mesher,
  Messages& messages, Deformation& deformation)
{
  constexpr double cubicMillimeters = 1e3; // of a milliliter
  const double* spacing = volume->GetSpacing();
  const double body = std::abs(spacing[0] * spacing[1] * spacing[2]) / cubicMillimeters *
    double(mesher->GetNumberOfBodyVoxels() - mesher->GetNumberOfBodyVoxelsOutside());
  double mesh = 0.0;
  for (vtkIdType cell = 0; cell < mesher->GetOutput()->GetNumberOfCells(); ++cell)
  {
    mesh += GetVolume(mesher->GetOutput(), cell) / cubicMillimeters;
  }
  deformation.Body += MakeText(std::setprecision(4), "; mesh ", mesh, " ml, body ", body, " ml");
  constexpr double tooLarge = 1.3;
  if (mesh > tooLarge * body && !HasMaterialOfAir(options, volume->GetPointData()->GetScalars()))
  {
    messages.Warn(MakeText(std::setprecision(3), "The mesh has ", mesh / body,
      " times the volume of the body, because tetrahedra are large, or because it fills cavities "
      "of the body. All of it is simulated as tissue. Use a smaller --edge-length, and give voxels "
      "that are no tissue a soft and light --material, such as MINIMUM:MAXIMUM=100,0.3,1 for "
      "air."));
  }
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
  const bool isOfLabels =
    !options.Isovalue && options.AreLabels(volume->GetPointData()->GetScalars());
  if (isOfLabels)
  {
    mesher->SetBodyModeToLabels();
  }
  if (options.Isovalue)
  {
    mesher->AutomaticIsovalueOff();
    mesher->SetIsovalue(*options.Isovalue);
  }
  mesher->SetPieceMode(
    options.Pieces == "largest" ? vtkTetGenMesher::LARGEST_PIECE : vtkTetGenMesher::ALL_PIECES);
  mesher->SetTargetEdgeLength(GetEdgeLength(options, volume));
  for (const Push& push : options.Pushes)
  {
    mesher->AddRefinementSphere(
      push.Center[0], push.Center[1], push.Center[2], push.Radius, push.GetEdgeLength());
  }
  for (const Pull& pull : options.Pulls)
  {
    if (pull.Radius > 0.0)
    {
      const double edgeLength = Push{ {}, {}, pull.Radius }.GetEdgeLength();
      mesher->AddRefinementSphere(pull.Point[0], pull.Point[1], pull.Point[2], pull.Radius,
        options.HasMidSideNodes() ? 2.0 * edgeLength : edgeLength);
    }
  }
  mesher->SetRadiusEdgeRatio(options.RadiusEdgeRatio);
  if (options.HasElasticModel())
  {
    // With the default, the simulated body would be half an edge length larger on each side.
    mesher->SetMargin(0.1);
  }
  mesher->SetTetGenExecutable(options.TetGenExecutable);
  const ProgressBar bar(mesher, "meshing", !options.Quiet);
  mesher->Update();
  messages.Check("cannot mesh the body");
  deformation.Body = MakeText(mesher->GetNumberOfBodyVoxels(), " voxels in ",
    mesher->GetNumberOfPieces(), " pieces, ", mesher->GetNumberOfBodyVoxelsOutside(),
    " voxels outside the mesh; ", mesher->GetNumberOfSpeckVoxels(), " voxels in specks left out");
  if (options.HasElasticModel())
  {
    CompareVolumes(options, volume, mesher, messages, deformation);
  }
  deformation.Edges.push_back(MakeText(std::setprecision(3), "about ",
    mesher->GetUsedTargetEdgeLength(), options.Pushes.empty() ? "" : " away from pushes"));
  if (!isOfLabels)
  {
    deformation.Isovalue = mesher->GetUsedIsovalue();
  }
  return mesher->GetOutput();
}

// Warns of tetrahedra that are too large for a push, which are visible as facets.
void CheckEdges(
  const Push& push, vtkUnstructuredGrid* mesh, Messages& messages, Deformation& deformation)
{
  const double longest = GetLongestEdge(push, mesh);
  deformation.Edges.push_back(
    MakeText(std::setprecision(3), "up to ", longest, " within the push of radius ", push.Radius));
  if (longest > push.GetEdgeLength() * (1.0 + 1e-9))
  {
    messages.Warn(MakeText(std::setprecision(3), "Edges of tetrahedra are up to ", longest,
      " long within a push of radius ", push.Radius,
      ". Edges longer than a sixth of the radius can be visible as facets. Give --lattice more "
      "nodes, or use --tetgen."));
  }
}

// Moves the nodes of a mesh by the pushes.
void PushNodes(const Options& options, const vtkSmartPointer<vtkUnstructuredGrid>& mesh,
  Messages& messages, Deformation& deformation)
{
  for (const Push& push : options.Pushes)
  {
    if (push.Folds())
    {
      messages.Warn(MakeText("The displacement of a --push is ",
        vtkMath::Norm(push.Displacement.data()), " long, which is too large for its radius ",
        push.Radius, ": the volume folds over itself."));
    }
    CheckEdges(push, mesh, messages, deformation);
  }
  if (ApplyPushes(options.Pushes, mesh) == 0 && !options.Pushes.empty())
  {
    messages.Warn("No node of the mesh is within the radius of a push, so nothing "
                  "moves. Are X,Y,Z of --push world coordinates of the volume?");
  }
  deformation.Data = mesh;
  deformation.Displacement = PushArrayName;
}

// Throws a Failure if the files of --mesh and --rest cannot be used with the other options.
void CheckMeshOptions(const Options& options, const Deformation& deformation)
{
  const bool isField = vtkImageData::SafeDownCast(deformation.Data);
  if (isField && options.OpenSplits)
  {
    throw Failure(
      "--open-splits requires a mesh, but " + options.Mesh + " is a displacement field");
  }
  if (isField || vtkImageData::SafeDownCast(deformation.Rest))
  {
    if (deformation.Rest || options.PointsAreDeformed)
    {
      throw Failure(std::string(deformation.Rest ? "--rest" : "--points-are-deformed") +
        " requires a mesh, but " + (isField ? options.Mesh : options.Rest) +
        " is a displacement field, whose points are always at rest");
    }
    CheckResampler(options, true);
  }
}
}

double GetVolume(vtkUnstructuredGrid* mesh, vtkIdType tetrahedron)
{
  vtkPoints* points = mesh->GetCell(tetrahedron)->GetPoints();
  double corners[4][3];
  for (int i = 0; i < 4; ++i)
  {
    points->GetPoint(i, corners[i]);
  }
  return std::abs(vtkTetra::ComputeVolume(corners[0], corners[1], corners[2], corners[3]));
}

Deformation MakeDeformation(const Options& options, const Volume& volume,
  [[maybe_unused]] vtkImageData* grid, Messages& messages, const FrameTaker& takeFrame)
{
  Deformation deformation;
  if (!options.Mesh.empty())
  {
    deformation.Data =
      ReadMesh(options.Mesh, options.Displacement, false, options, volume, messages);
    deformation.Displacement = options.Displacement;
    if (!options.Rest.empty())
    {
      deformation.Rest = ReadMesh(options.Rest, "", true, options, volume, messages);
    }
    CheckMeshOptions(options, deformation);
  }
  else if (!options.Field.empty())
  {
    const vtkSmartPointer<vtkImageData> field = ReadField(options.Field, volume,
      { options.FieldIsInverse, options.FieldSpace }, messages, !options.Quiet);
    CheckField(
      field, IsVTKFile(options.Field) ? options.Displacement : FieldArrayName, options.Field);
    deformation.Data = field;
    deformation.Displacement = IsVTKFile(options.Field) ? options.Displacement : FieldArrayName;
  }
#ifdef DEFORMVOLUME_HAVE_ITK
  else if (!options.Transforms.empty())
  {
    vtkNew<vtkImageData> padded; // the grid of the result
    padded->CopyStructure(grid);
    int extent[6];
    grid->GetExtent(extent);
    for (int side = 0; side < 6; ++side)
    {
      extent[side] += side % 2 == 0 ? -options.Padding : options.Padding;
    }
    padded->SetExtent(extent);
    deformation.Data = ReadTransforms(options.Transforms, volume, padded, messages, !options.Quiet);
    deformation.Displacement = FieldArrayName;
  }
#endif
  else if (options.Model == "chainmail")
  {
    PullByChainMail(options, volume, messages, deformation, takeFrame);
  }
  else if (!options.TetGen && !options.HasLattice())
  {
    return deformation; // the volume is cut or carved, but not deformed
  }
  else
  {
    const vtkSmartPointer<vtkUnstructuredGrid> mesh =
      Mesh(options, volume.Image, messages, deformation);
    if (options.HasElasticModel())
    {
      DeformByElasticModel(options, volume, mesh, messages, deformation, takeFrame);
    }
    else
    {
      PushNodes(options, mesh, messages, deformation);
    }
    if (!options.MeshOutput.empty())
    {
      vtkNew<vtkXMLUnstructuredGridWriter> writer;
      OutputFile file(options.MeshOutput);
      file.Finish(messages, WriteXML(writer.Get(), deformation.Data, file.GetPath()));
    }
  }
  return deformation;
}
