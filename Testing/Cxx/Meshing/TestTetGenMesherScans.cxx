// SPDX-License-Identifier: BSD-3-Clause
// MRI scans: the mesh contains all voxels of a head and of a brain.
#include "vtkTetGenMesher.h"

#include "BodyChecks.h"
#include "MeshChecks.h"

#include <vtkNIFTIImageReader.h>
#include <vtksys/SystemTools.hxx>

#include <cstdlib>

using namespace meshChecks;

int TestTetGenMesherScans(int, char*[])
{
  for (const char* name : { "ch2", "ch2better" })
  {
    const std::string file = std::string("/usr/share/mricron/templates/") + name + ".nii.gz";
    if (!vtksys::SystemTools::FileExists(file))
    {
      std::cout << "skipped: " << file << " is missing, install the package mricron-data\n";
      return 125; // VTK_SKIP_RETURN_CODE
    }
    vtkNew<vtkNIFTIImageReader> reader;
    reader->SetFileName(file.c_str());
    vtkNew<vtkTetGenMesher> mesher;
    FailureCheck check(mesher);
    mesher->SetInputConnection(reader->GetOutputPort());
    for (const double length : { 0.0, 9.0 })
    {
      mesher->SetTargetEdgeLength(length);
      check.Succeeds();
      const bodyChecks::Count count = bodyChecks::CountVoxels(
        reader->GetOutput(), mesher->GetUsedIsovalue(), mesher->GetOutput());
      std::cout << name << ": " << mesher->GetOutput()->GetNumberOfCells() << " tetrahedra, "
                << count.Outside << " of " << count.Body << " voxels outside, of specks "
                << mesher->GetNumberOfSpeckVoxels() << '\n';
      VERIFY(mesher->GetNumberOfBodyVoxels() + mesher->GetNumberOfSpeckVoxels() == count.Body);
      VERIFY(mesher->GetNumberOfSpeckVoxels() < 1e-3 * count.Body);
      VERIFY(mesher->GetNumberOfBodyVoxelsOutside() == 0);
      VERIFY(count.Outside <= mesher->GetNumberOfSpeckVoxels());
    }
  }
  return Failures() ? EXIT_FAILURE : EXIT_SUCCESS;
}
