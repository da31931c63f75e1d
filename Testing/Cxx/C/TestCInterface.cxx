// SPDX-License-Identifier: BSD-3-Clause
// Results of the interface for C are equal to those of vtkDeformVolumeFilter, to the last bit.
#include "ArrayMaking.h"
#include "CTesting.h"
#include "FilterTesting.h"

#include <vtkAlgorithm.h>
#include <vtkCell.h>
#include <vtkCellType.h>
#include <vtkCellTypeSource.h>
#include <vtkDoubleArray.h>
#include <vtkIdList.h>

#include <glm/common.hpp>

#include <algorithm>
#include <limits>
#include <random>
#include <thread>
#include <vector>

using namespace filterTesting;

namespace
{

/// An irregular mesh, as a mesher makes it: a lattice whose nodes are moved and renumbered at
/// random.
vtkSmartPointer<vtkUnstructuredGrid> MakeIrregularMesh(vtkImageData* volume, double margin)
{
  auto lattice = MakeMesh(volume, 6, margin);
  std::mt19937 random(7);
  std::vector<vtkIdType> newIds(static_cast<std::size_t>(lattice->GetNumberOfPoints()));
  for (std::size_t i = 0; i < newIds.size(); ++i)
  {
    newIds[i] = static_cast<vtkIdType>(i);
  }
  std::shuffle(newIds.begin(), newIds.end(), random);
  std::uniform_real_distribution<double> between(-0.3, 0.3);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(lattice->GetNumberOfPoints());
  for (std::size_t i = 0; i < newIds.size(); ++i)
  {
    const glm::dvec3 point = GetPoint(lattice, static_cast<vtkIdType>(i)) +
      glm::dvec3(between(random), between(random), between(random));
    points->SetPoint(newIds[i], &point.x);
  }
  auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
  mesh->SetPoints(points);
  mesh->Allocate(lattice->GetNumberOfCells());
  for (vtkIdType cell = 0; cell < lattice->GetNumberOfCells(); ++cell)
  {
    vtkIdType count = 0;
    const vtkIdType* nodes = nullptr;
    lattice->GetCellPoints(cell, count, nodes);
    vtkIdType renumbered[4];
    for (int i = 0; i < 4; ++i)
    {
      renumbered[i] = newIds[static_cast<std::size_t>(nodes[i])];
    }
    mesh->InsertNextCell(VTK_TETRA, 4, renumbered);
  }
  return mesh;
}

vtkSmartPointer<vtkImageData> MakeReference(bool isMirrored)
{
  const double z = isMirrored ? -1.0 : 1.0;
  auto reference = MakeImage(
    { { 5, 44, -2, 43, 10, 51 } }, glm::dvec3(0.9, 0.8, 1.1), glm::dvec3(-24.0, -12.0, -34.0 * z));
  const double direction[9] = { 0.96, 0.28, 0.0, -0.28, 0.96, 0.0, 0.0, 0.0, z };
  reference->SetDirectionMatrix(direction);
  return reference;
}

TEST(CInterface, Types)
{
  const auto volume = MakeManyArrays();
  auto mesh = MakeMesh(volume, 4);
  SetDisplacements(mesh, Bend);
  Deformed deformed(volume, mesh);
  deformed.Filter->SetBackgroundValue(-7.4);
  deformed.Filter->AddCategoricalArray("labels");
  InC inC;
  inC.SetVolume(volume, -7.4, { "labels" });
  inC.SetMesh(mesh);
  inC.Compare(deformed);
}

TEST(CInterface, Meshes)
{
  const auto volume = MakeTwoArrays();
  for (const bool isIrregular : { false, true })
  {
    // The irregular mesh ends inside the volume.
    auto mesh = isIrregular ? MakeIrregularMesh(volume, -2.0) : MakeMesh(volume, 4);
    SetDisplacements(mesh, Bend);
    Deformed deformed(volume, mesh);
    InC inC;
    inC.SetVolume(volume, 0.0);
    inC.SetMesh(mesh);
    inC.Compare(deformed);
    deformed.Filter->SetInterpolation(vtkDeformVolumeFilter::CUBIC_INTERPOLATION);
    inC.Interpolation = DV_CUBIC;
    inC.Compare(deformed);
    deformed.Filter->SetInterpolation(vtkDeformVolumeFilter::NEAREST_INTERPOLATION);
    inC.Interpolation = DV_NEAREST;
    inC.Compare(deformed);
    deformed.Filter->SetInterpolation(vtkDeformVolumeFilter::LINEAR_INTERPOLATION);
    inC.Interpolation = DV_LINEAR;
    // Other displacements, as doubles.
    SetDisplacements(mesh, Shift(1.25, -2.5, 0.3));
    vtkNew<vtkDoubleArray> doubles;
    doubles->DeepCopy(mesh->GetPointData()->GetVectors());
    mesh->GetPointData()->SetVectors(doubles);
    mesh->Modified();
    inC.SetDisplacements(mesh);
    inC.Compare(deformed);
    // The outside modes.
    SetDisplacements(mesh, Bend);
    mesh->Modified();
    inC.SetDisplacements(mesh);
    deformed.Filter->SetOutsideMode(vtkDeformVolumeFilter::EXTRAPOLATE);
    Check(dv_set_outside(inC.Deformer, DV_OUTSIDE_EXTRAPOLATE, 0.0));
    inC.Compare(deformed);
    deformed.Filter->SetOutsideMode(vtkDeformVolumeFilter::KEEP);
    deformed.Filter->SetFadeDistance(3.5);
    Check(dv_set_outside(inC.Deformer, DV_OUTSIDE_KEEP, 3.5));
    inC.Compare(deformed, isIrregular ? "fade distance" : "");
  }
}

TEST(CInterface, Grids)
{
  const auto volume = MakeTwoArrays();
  auto mesh = MakeIrregularMesh(volume, 1.0);
  SetDisplacements(mesh, Bend);
  Deformed deformed(volume, mesh);
  InC inC;
  inC.SetVolume(volume, 0.0);
  inC.SetMesh(mesh);
  // Modes of bounds and spacing.
  dv_output output = {};
  output.struct_size = sizeof(output);
  output.bounds_mode = DV_BOUNDS_VOLUME;
  output.padding = 2;
  deformed.Filter->SetOutputBoundsMode(vtkDeformVolumeFilter::VOLUME_BOUNDS);
  deformed.Filter->SetPadding(2);
  Check(dv_set_output(inC.Deformer, &output));
  inC.Compare(deformed);
  const double spacing[3] = { 1.3, 0.8, 0.45 };
  std::copy_n(spacing, 3, output.spacing);
  deformed.Filter->SetOutputSpacingMode(vtkDeformVolumeFilter::CUSTOM_SPACING);
  deformed.Filter->SetCustomSpacing(1.3, 0.8, 0.45);
  Check(dv_set_output(inC.Deformer, &output));
  inC.Compare(deformed);
  output.bounds_mode = DV_BOUNDS_CUSTOM;
  const double box[6] = { -5.0, 9.0, -20.0, 3.0, -20.0, 12.0 };
  std::copy_n(box, 6, output.custom_bounds);
  deformed.Filter->SetOutputBoundsMode(vtkDeformVolumeFilter::CUSTOM_BOUNDS);
  deformed.Filter->SetCustomBounds(box);
  Check(dv_set_output(inC.Deformer, &output));
  inC.Compare(deformed);
  output.bounds_mode = DV_BOUNDS_DEFORMED;
  deformed.Filter->SetOutputBoundsMode(vtkDeformVolumeFilter::DEFORMED_BOUNDS);
  Check(dv_set_output(inC.Deformer, &output));
  inC.Compare(deformed);
  Check(dv_set_output(inC.Deformer, nullptr));
  deformed.Filter->SetOutputSpacingMode(vtkDeformVolumeFilter::VOLUME_SPACING);
  deformed.Filter->SetPadding(0);
  inC.Compare(deformed);
  // Reference grids: rotated, and left-handed.
  for (const bool isMirrored : { false, true })
  {
    const auto reference = MakeReference(isMirrored);
    deformed.Filter->SetReferenceData(reference);
    inC.SetReference(reference);
    inC.Compare(deformed);
  }
  deformed.Filter->SetInterpolation(vtkDeformVolumeFilter::CUBIC_INTERPOLATION);
  inC.Interpolation = DV_CUBIC;
  inC.Compare(deformed);
}

TEST(CInterface, Fields)
{
  const auto volume = MakeTwoArrays();
  // A field on another grid, one with a point at each voxel, and one with twice as many points on
  // each axis.
  for (int kind = 0; kind < 3; ++kind)
  {
    vtkSmartPointer<vtkImageData> field;
    if (kind == 0)
    {
      field = MakeImage(
        { { 2, 14, -3, 12, 0, 11 } }, glm::dvec3(3.1, 2.9, 3.3), glm::dvec3(-20.0, -10.0, -28.0));
    }
    else
    {
      field = vtkSmartPointer<vtkImageData>::New();
      field->CopyStructure(volume);
      if (kind == 2)
      {
        int extent[6];
        volume->GetExtent(extent);
        std::for_each(extent, extent + 6, [](int& index) { index *= 2; });
        double steps[3];
        volume->GetSpacing(steps);
        field->SetExtent(extent);
        field->SetSpacing(0.5 * steps[0], 0.5 * steps[1], 0.5 * steps[2]);
      }
    }
    for (const bool isInverse : { false, true })
    {
      SetDisplacements(field, Bend);
      for (vtkIdType id = 0; kind == 2 && !isInverse && id < field->GetNumberOfPoints(); ++id)
      {
        // Points between voxels are never read.
        int dimensions[3];
        field->GetDimensions(dimensions);
        const vtkIdType x = id % dimensions[0];
        const vtkIdType y = id / dimensions[0] % dimensions[1];
        const vtkIdType z = id / dimensions[0] / dimensions[1];
        if ((x | y | z) % 2 != 0)
        {
          field->GetPointData()->GetVectors()->SetComponent(
            id, 1, std::numeric_limits<double>::quiet_NaN());
        }
      }
      field->Modified();
      Deformed deformed(volume, field);
      deformed.Filter->SetFieldIsInverse(isInverse);
      InC inC;
      inC.SetVolume(volume, 0.0);
      inC.SetField(field, isInverse);
      inC.Compare(deformed);
      deformed.Filter->SetOutsideMode(vtkDeformVolumeFilter::EXTRAPOLATE);
      deformed.Filter->SetOutputBoundsMode(vtkDeformVolumeFilter::VOLUME_BOUNDS);
      dv_output output = {};
      output.struct_size = sizeof(output);
      output.bounds_mode = DV_BOUNDS_VOLUME;
      Check(dv_set_output(inC.Deformer, &output));
      Check(dv_set_outside(inC.Deformer, DV_OUTSIDE_EXTRAPOLATE, 0.0));
      inC.Compare(deformed);
      deformed.Filter->SetOutsideMode(vtkDeformVolumeFilter::KEEP);
      deformed.Filter->SetFadeDistance(60.0);
      Check(dv_set_outside(inC.Deformer, DV_OUTSIDE_KEEP, 60.0));
      inC.Compare(deformed);
      const auto reference = MakeReference(true);
      deformed.Filter->SetReferenceData(reference);
      deformed.Filter->SetOutputBoundsMode(vtkDeformVolumeFilter::DEFORMED_BOUNDS);
      inC.SetReference(reference);
      inC.Compare(deformed);
    }
  }
}

TEST(CInterface, ExtraAndMasks)
{
  auto volume = MakeTwoArrays();
  const auto ghosts = MakeArray<vtkUnsignedCharArray>("vtkGhostType", volume->GetNumberOfPoints());
  for (vtkIdType i = 0; i < ghosts->GetNumberOfTuples(); i += 37)
  {
    ghosts->SetValue(i, 2);
  }
  volume->GetPointData()->AddArray(ghosts);
  auto mesh = MakeIrregularMesh(volume, 1.0);
  SetDisplacements(
    mesh, [](const glm::dvec3& p) { return Bend(p) + glm::dvec3(0.0, 0.0, 4.0 * std::sin(p.x)); });
  Deformed deformed(volume, mesh);
  deformed.Filter->SetBackgroundValue(-3.0);
  InC inC;
  inC.SetVolume(volume, -3.0);
  inC.SetMesh(mesh);
  inC.Compare(deformed);
  deformed.Filter->GenerateRestPositionsOn();
  deformed.Filter->GenerateJacobianOn();
  deformed.Filter->GenerateFoldCountOn();
  inC.WithExtra = inC.WithFolds = true;
  inC.Compare(deformed);
  EXPECT_GT(inC.Report.number_of_inverted_tetrahedra, 0);
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(volume);
  SetDisplacements(field, Bend);
  deformed.Filter->SetDeformationData(field);
  inC.SetField(field, false);
  inC.Compare(deformed);
  deformed.Filter->GenerateFoldCountOff();
  deformed.Filter->FieldIsInverseOn();
  inC.WithFolds = false;
  inC.SetField(field, true);
  inC.Compare(deformed);
}

// Densities, which are divided by the Jacobian, of several types.
TEST(CInterface, TypesOfDensities)
{
  const auto volume = MakeManyArrays();
  // Labels and one other array are not densities.
  const std::set<std::string> densities{ "int8", "uint16", "int64", "double", "vectors" };
  auto mesh = MakeMesh(volume, 4);
  SetDisplacements(mesh, Bend);
  Deformed deformed(volume, mesh);
  deformed.Filter->SetBackgroundValue(-2.6);
  for (const std::string& name : densities)
  {
    deformed.Filter->AddDensityArray(name.c_str());
  }
  InC inC;
  inC.Densities = densities;
  inC.SetVolume(volume, -2.6);
  inC.SetMesh(mesh);
  inC.Compare(deformed);
  EXPECT_EQ(deformed.Update()->GetPointData()->GetArray("uint16")->GetDataType(), VTK_FLOAT);
}

// Densities with meshes, fields and folds.
TEST(CInterface, Densities)
{
  const auto volume = MakeTwoArrays();
  auto mesh = MakeIrregularMesh(volume, 1.0);
  SetDisplacements(mesh, Bend);
  Deformed deformed(volume, mesh);
  deformed.Filter->SetBackgroundValue(-2.6);
  deformed.Filter->AddDensityArray("int16");
  InC inC;
  inC.Densities = { "int16" };
  inC.SetVolume(volume, -2.6);
  inC.SetMesh(mesh);
  inC.Compare(deformed);
  // Request the Jacobian. The second call has no changes.
  deformed.Filter->GenerateJacobianOn();
  deformed.Filter->GenerateRestPositionsOn();
  inC.WithExtra = true;
  inC.Compare(deformed);
  inC.Compare(deformed);
  deformed.Filter->SetInterpolation(vtkDeformVolumeFilter::CUBIC_INTERPOLATION);
  inC.Interpolation = DV_CUBIC;
  inC.Compare(deformed);
  deformed.Filter->SetInterpolation(vtkDeformVolumeFilter::LINEAR_INTERPOLATION);
  inC.Interpolation = DV_LINEAR;
  deformed.Filter->GenerateJacobianOff();
  deformed.Filter->GenerateRestPositionsOff();
  inC.WithExtra = false;
  // Other displacements.
  SetDisplacements(mesh, [](const glm::dvec3& p) { return p * glm::dvec3(0.8, 1.1, 0.9); });
  inC.SetDisplacements(mesh);
  inC.Compare(deformed);
  // Folds, with hidden and inverted tetrahedra.
  double center[3];
  volume->GetCenter(center);
  SetDisplacements(mesh,
    [&](const glm::dvec3& p)
    {
      const double r = (p.x - center[0]) / 8.0;
      const double within = std::abs(r) < 1.0 ? 1.0 - r * r : 0.0;
      return p - glm::dvec3(24.0 * r * within * within, 0.0, 0.0);
    });
  inC.SetDisplacements(mesh);
  inC.Compare(deformed, "The sums of density arrays lack the ");
  EXPECT_GT(inC.Report.number_of_inverted_tetrahedra, 0);
  const auto reference = MakeReference(true);
  deformed.Filter->SetReferenceData(reference);
  inC.SetReference(reference);
  SetDisplacements(mesh, Bend);
  inC.SetDisplacements(mesh);
  inC.Compare(deformed);
  // Fields.
  auto field = vtkSmartPointer<vtkImageData>::New();
  field->CopyStructure(volume);
  SetDisplacements(field, Bend);
  deformed.Filter->SetDeformationData(field);
  inC.SetField(field, false);
  inC.Compare(deformed);
  deformed.Filter->FieldIsInverseOn();
  inC.SetField(field, true);
  inC.Compare(deformed);
  deformed.Filter->ClearDensityArrays();
  inC.Densities.clear();
  inC.SetVolume(volume, -2.6);
  inC.Compare(deformed);
}

/// The hexahedra of a mesh as polyhedra.
vtkSmartPointer<vtkUnstructuredGrid> MakePolyhedra(vtkUnstructuredGrid* hexahedra)
{
  auto polyhedra = vtkSmartPointer<vtkUnstructuredGrid>::New();
  polyhedra->SetPoints(hexahedra->GetPoints());
  for (vtkIdType cell = 0; cell < hexahedra->GetNumberOfCells(); ++cell)
  {
    vtkCell* hexahedron = hexahedra->GetCell(cell);
    vtkNew<vtkIdList> stream;
    stream->InsertNextId(hexahedron->GetNumberOfFaces());
    for (int face = 0; face < hexahedron->GetNumberOfFaces(); ++face)
    {
      vtkIdList* ids = hexahedron->GetFace(face)->GetPointIds();
      stream->InsertNextId(ids->GetNumberOfIds());
      for (const vtkIdType id : *ids)
      {
        stream->InsertNextId(id);
      }
    }
    polyhedra->InsertNextCell(VTK_POLYHEDRON, stream);
  }
  return polyhedra;
}

// All types of cells that are split into tetrahedra. In each mesh the cells of one type fill the
// volume.
TEST(CInterface, Cells)
{
  const auto volume = MakeTwoArrays();
  double bounds[6];
  volume->GetBounds(bounds);
  for (const int type : { VTK_TETRA, VTK_HEXAHEDRON, VTK_VOXEL, VTK_WEDGE, VTK_PYRAMID,
         VTK_PENTAGONAL_PRISM, VTK_HEXAGONAL_PRISM, VTK_QUADRATIC_TETRA, VTK_QUADRATIC_HEXAHEDRON,
         VTK_QUADRATIC_WEDGE, VTK_QUADRATIC_PYRAMID, VTK_TRIQUADRATIC_HEXAHEDRON,
         VTK_LAGRANGE_TETRAHEDRON, VTK_LAGRANGE_HEXAHEDRON, VTK_LAGRANGE_WEDGE, VTK_POLYHEDRON })
  {
    vtkNew<vtkCellTypeSource> source;
    source->SetCellType(type == VTK_POLYHEDRON ? VTK_HEXAHEDRON : type);
    source->SetCellOrder(3);
    source->SetBlocksDimensions(2, 2, 2);
    source->SetOutputPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    source->Update();
    auto mesh = vtkSmartPointer<vtkUnstructuredGrid>::New();
    mesh->ShallowCopy(source->GetOutput());
    // Scale the mesh to the bounds of the volume, and 5 % more on each side.
    double box[6];
    mesh->GetBounds(box);
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(mesh->GetNumberOfPoints());
    for (vtkIdType id = 0; id < mesh->GetNumberOfPoints(); ++id)
    {
      glm::dvec3 point = GetPoint(mesh, id);
      for (int axis = 0; axis < 3; ++axis)
      {
        const double size = bounds[2 * axis + 1] - bounds[2 * axis];
        point[axis] = bounds[2 * axis] - 0.05 * size +
          1.1 * size * (point[axis] - box[2 * axis]) / (box[2 * axis + 1] - box[2 * axis]);
      }
      points->SetPoint(id, &point.x);
    }
    mesh->SetPoints(points);
    if (type == VTK_POLYHEDRON)
    {
      mesh = MakePolyhedra(mesh);
    }
    SetDisplacements(mesh, Bend);
    Deformed deformed(volume, mesh);
    InC inC;
    inC.SetVolume(volume, 0.0);
    inC.SetMesh(mesh);
    SCOPED_TRACE(testing::Message() << "cells of the type " << type);
    inC.Compare(deformed);
  }
  // Warnings: cells that are ignored, and a mid-side node that is far from the middle of its edge.
  auto mesh = MakeMesh(volume, 3);
  const vtkIdType corners[10] = { 0, 1, 3, 9, 20, 21, 22, 23, 24, 25 };
  mesh->InsertNextCell(VTK_TRIANGLE, 3, corners);
  mesh->InsertNextCell(VTK_QUADRATIC_TETRA, 10, corners);
  SetDisplacements(mesh, Bend);
  for (const char* words : { "are ignored: 1 triangle.", "1 of 1 quadratic cells" })
  {
    Deformed deformed(volume, mesh);
    InC inC;
    inC.SetVolume(volume, 0.0);
    inC.SetMesh(mesh);
    inC.Compare(deformed, words);
  }
}

// Without a deformation the volume at rest is resampled.
TEST(CInterface, AtRest)
{
  const auto volume = MakeTwoArrays();
  Deformed deformed;
  deformed.Filter->SetInputData(volume);
  InC inC;
  inC.SetVolume(volume, 0.0);
  inC.Compare(deformed);
  const auto reference = MakeReference(false);
  deformed.Filter->SetReferenceData(reference);
  inC.SetReference(reference);
  inC.Compare(deformed);
  inC.Interpolation = DV_CUBIC;
  deformed.Filter->SetInterpolation(vtkDeformVolumeFilter::CUBIC_INTERPOLATION);
  inC.Compare(deformed);
}

// Two dv_deformers in two threads at the same time.
TEST(CInterface, TwoThreads)
{
  const auto volume = MakeTwoArrays();
  auto mesh = MakeMesh(volume, 4);
  SetDisplacements(mesh, Bend);
  Deformed deformed(volume, mesh);
  deformed.Update();
  std::array<InC, 2> inC;
  for (InC& one : inC)
  {
    one.SetVolume(volume, 0.0);
    one.SetMesh(mesh);
  }
  std::array<std::string, 2> errors;
  std::array<std::thread, 2> threads;
  for (std::size_t i = 0; i < 2; ++i)
  {
    threads[i] = std::thread(
      [&inC, &errors, i]
      {
        for (int time = 0; time < 3; ++time)
        {
          inC[i].Deform();
        }
        // dv_last_error() returns the error of this thread.
        dv_set_outside(inC[i].Deformer, i == 0 ? 8 : 9, 0.0);
        errors[i] = dv_last_error();
      });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  EXPECT_TRUE(HasPart(errors[0], "is 8"));
  EXPECT_TRUE(HasPart(errors[1], "is 9"));
  for (InC& one : inC)
  {
    one.Compare(deformed);
  }
}

} // namespace
