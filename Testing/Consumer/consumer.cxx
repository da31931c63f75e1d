// SPDX-License-Identifier: BSD-3-Clause
// Shifts a small volume by whole voxels along x, y and z, and compares every voxel.
#include <vtkDeformVolumeFilter.h>
#ifdef HAS_INTERACTION
#include <vtkDeformVolumeSession.h>
#endif
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkLatticeTetrahedraSource.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <iostream>

namespace
{
const int Size[3] = { 12, 10, 8 };
const int Shift[3] = { 3, -2, 1 };

unsigned short GetValue(int i, int j, int k)
{
  return static_cast<unsigned short>(1 + i + 37 * j + 1009 * k);
}
}

int main()
{
  vtkNew<vtkImageData> volume;
  volume->SetDimensions(Size);
  volume->AllocateScalars(VTK_UNSIGNED_SHORT, 1);
  for (int k = 0; k < Size[2]; ++k)
  {
    for (int j = 0; j < Size[1]; ++j)
    {
      for (int i = 0; i < Size[0]; ++i)
      {
        *static_cast<unsigned short*>(volume->GetScalarPointer(i, j, k)) = GetValue(i, j, k);
      }
    }
  }

  vtkNew<vtkLatticeTetrahedraSource> lattice;
  lattice->SetInputData(volume);
  lattice->SetNumberOfNodes(4, 3, 5);
  lattice->EqualSpacingOff();
  lattice->Update();

  vtkNew<vtkUnstructuredGrid> mesh;
  mesh->ShallowCopy(lattice->GetOutput());
  vtkNew<vtkFloatArray> displacement;
  displacement->SetName("displacement");
  displacement->SetNumberOfComponents(3);
  displacement->SetNumberOfTuples(mesh->GetNumberOfPoints());
  for (int axis = 0; axis < 3; ++axis)
  {
    displacement->FillComponent(axis, Shift[axis]);
  }
  mesh->GetPointData()->AddArray(displacement);

  vtkNew<vtkDeformVolumeFilter> deform;
  deform->SetInputData(volume);
  deform->SetDeformationData(mesh);
  deform->SetInputArrayToProcess(
    0, 1, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, displacement->GetName());
  deform->Update();

  vtkImageData* output = deform->GetOutput();
  int extent[6];
  output->GetExtent(extent);
  for (int axis = 0; axis < 3; ++axis)
  {
    if (extent[2 * axis] != Shift[axis] || extent[2 * axis + 1] != Shift[axis] + Size[axis] - 1)
    {
      std::cerr << "The extent of the output on axis " << axis << " is " << extent[2 * axis]
                << " to " << extent[2 * axis + 1] << " instead of " << Shift[axis] << " to "
                << Shift[axis] + Size[axis] - 1 << ".\n";
      return 1;
    }
  }
  int wrong = 0;
  for (int k = 0; k < Size[2]; ++k)
  {
    for (int j = 0; j < Size[1]; ++j)
    {
      for (int i = 0; i < Size[0]; ++i)
      {
        const auto* value = static_cast<const unsigned short*>(
          output->GetScalarPointer(i + Shift[0], j + Shift[1], k + Shift[2]));
        wrong += *value != GetValue(i, j, k);
      }
    }
  }
#ifdef HAS_INTERACTION
  vtkNew<vtkDeformVolumeSession> session;
  if (!session->SetInputs(volume))
  {
    std::cerr << "vtkDeformVolumeSession::SetInputs() fails.\n";
    return 1;
  }
#endif
  std::cout << wrong << " of " << volume->GetNumberOfPoints() << " voxels are wrong.\n";
  return wrong == 0 ? 0 : 1;
}
