// SPDX-License-Identifier: BSD-3-Clause
// Results of the interface for C are equal to those of vtkDeformVolumeFilter, to the last bit.
// Testing/Python/TestPackage.py compares those of the Python package, which calls this interface.
#include "ArrayMaking.h"
#include "CTesting.h"
#include "FilterTesting.h"

#include <vtkCellType.h>
#include <vtkDoubleArray.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <limits>
#include <thread>
#include <vector>

using namespace filterTesting;

namespace
{

// A rotated, left-handed grid.
vtkSmartPointer<vtkImageData> MakeReference()
{
  auto reference = MakeImage(
    { { 5, 44, -2, 43, 10, 51 } }, glm::dvec3(0.9, 0.8, 1.1), glm::dvec3(-24.0, -12.0, 34.0));
  const double direction[9] = { 0.96, 0.28, 0.0, -0.28, 0.96, 0.0, 0.0, 0.0, -1.0 };
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

// Other displacements, as doubles, of a mesh that ends inside the volume.
TEST(CInterface, Displacements)
{
  const auto volume = MakeTwoArrays();
  auto mesh = MakeMesh(volume, 6, -2.0);
  SetDisplacements(mesh, Bend);
  Deformed deformed(volume, mesh);
  InC inC;
  inC.SetVolume(volume, 0.0);
  inC.SetMesh(mesh);
  inC.Compare(deformed);
  SetDisplacements(mesh, Shift(1.25, -2.5, 0.3));
  vtkNew<vtkDoubleArray> doubles;
  doubles->DeepCopy(mesh->GetPointData()->GetVectors());
  mesh->GetPointData()->SetVectors(doubles);
  mesh->Modified();
  inC.SetDisplacements(mesh);
  inC.Compare(deformed);
  deformed.Filter->SetOutsideMode(vtkDeformVolumeFilter::KEEP);
  deformed.Filter->SetFadeDistance(0.5);
  Check(dv_set_outside(inC.Deformer, DV_OUTSIDE_KEEP, 0.5));
  inC.Compare(deformed, "fade distance");
}

TEST(CInterface, Grids)
{
  const auto volume = MakeTwoArrays();
  auto mesh = MakeMesh(volume, 6, 1.0);
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
    for (int trial = 0; trial < 4; ++trial)
    {
      const bool isInverse = trial % 2 != 0;
      const bool hasGaps = trial >= 2;
      SetDisplacements(field, Bend);
      vtkNew<vtkUnsignedCharArray> ghosts;
      ghosts->SetName("vtkGhostType");
      for (vtkIdType id = 0; hasGaps && id < field->GetNumberOfPoints(); ++id)
      {
        ghosts->InsertNextValue(id % 97 == 5 ? vtkDataSetAttributes::HIDDENPOINT : 0);
        if (id % 97 == 5)
        {
          field->GetPointData()->GetVectors()->SetComponent(
            id, 2, std::numeric_limits<double>::quiet_NaN());
        }
      }
      if (hasGaps)
      {
        field->GetPointData()->AddArray(ghosts);
      }
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
      deformed.Filter->SetGenerateJacobian(hasGaps);
      deformed.Filter->SetGenerateRestPositions(hasGaps);
      inC.WithExtra = hasGaps;
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
      const auto reference = MakeReference();
      deformed.Filter->SetReferenceData(reference);
      deformed.Filter->SetOutputBoundsMode(vtkDeformVolumeFilter::DEFORMED_BOUNDS);
      inC.SetReference(reference);
      inC.Compare(deformed);
      if (hasGaps)
      {
        field->GetPointData()->RemoveArray("vtkGhostType");
        SetDisplacements(field, Bend);
        inC.SetField(field, isInverse);
        inC.Compare(deformed);
      }
    }
  }
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
  auto mesh = MakeMesh(volume, 6, 1.0);
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
  const auto reference = MakeReference();
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

// Warnings: cells that are ignored, and a mid-side node that is far from the middle of its edge.
TEST(CInterface, Warnings)
{
  const auto volume = MakeTwoArrays();
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
