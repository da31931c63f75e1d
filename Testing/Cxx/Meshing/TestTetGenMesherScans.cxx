// SPDX-License-Identifier: BSD-3-Clause
// MRI scans: the mesh contains all voxels of a head and of a brain.
#include "vtkTetGenMesher.h"

#include "BodyChecks.h"
#include "MeshChecks.h"

#include <vtkNIFTIImageReader.h>
#include <vtksys/SystemTools.hxx>

using namespace meshChecks;

TEST(TetGenMesherScans, Heads)
{
  for (const char* name : { "ch2", "ch2better" })
  {
    const std::string file = std::string("/usr/share/mricron/templates/") + name + ".nii.gz";
    if (!vtksys::SystemTools::FileExists(file))
    {
      GTEST_SKIP() << file << " is missing, install the package mricron-data";
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
      EXPECT_EQ(mesher->GetNumberOfBodyVoxels() + mesher->GetNumberOfSpeckVoxels(), count.Body);
      EXPECT_LT(mesher->GetNumberOfSpeckVoxels(), 1e-3 * count.Body);
      EXPECT_EQ(mesher->GetNumberOfBodyVoxelsOutside(), 0);
      EXPECT_LE(count.Outside, mesher->GetNumberOfSpeckVoxels());
    }
  }
}
