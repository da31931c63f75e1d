// SPDX-License-Identifier: BSD-3-Clause
// Counts the voxels of a body that are inside a mesh of tetrahedra, independently of the tested
// code.
#ifndef DeformVolumeBodyChecks_h
#define DeformVolumeBodyChecks_h

#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace bodyChecks
{

struct Count
{
  vtkIdType Body = 0;    // voxels with at least the isovalue
  vtkIdType Outside = 0; // voxels of the body that no tetrahedron contains
};

inline Count CountVoxels(vtkImageData* volume, double isovalue, vtkUnstructuredGrid* mesh)
{
  int extent[6];
  int size[3];
  volume->GetExtent(extent);
  volume->GetDimensions(size);
  std::vector<unsigned char> covered(volume->GetNumberOfPoints(), 0);
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfCells(); ++cell)
  {
    vtkIdType count;
    const vtkIdType* ids;
    mesh->GetCellPoints(cell, count, ids);
    glm::dvec3 nodes[4];
    int low[3];
    int high[3];
    for (int k = 0; k < 4; ++k)
    {
      double world[3];
      double index[3];
      mesh->GetPoint(ids[k], world);
      volume->TransformPhysicalPointToContinuousIndex(world, index);
      nodes[k] = glm::dvec3(index[0] - extent[0], index[1] - extent[2], index[2] - extent[4]);
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      const auto [least, greatest] =
        std::minmax({ nodes[0][axis], nodes[1][axis], nodes[2][axis], nodes[3][axis] });
      low[axis] = std::max(0, static_cast<int>(std::ceil(least)));
      high[axis] = std::min(size[axis] - 1, static_cast<int>(std::floor(greatest)));
    }
    const glm::dmat3 toWeights =
      glm::inverse(glm::dmat3(nodes[1] - nodes[0], nodes[2] - nodes[0], nodes[3] - nodes[0]));
    for (int z = low[2]; z <= high[2]; ++z)
    {
      for (int y = low[1]; y <= high[1]; ++y)
      {
        for (int x = low[0]; x <= high[0]; ++x)
        {
          // The tolerance avoids gaps between tetrahedra by rounding.
          constexpr double tolerance = 1e-6;
          const glm::dvec3 w = toWeights * (glm::dvec3(x, y, z) - nodes[0]);
          if (w.x >= -tolerance && w.y >= -tolerance && w.z >= -tolerance &&
            w.x + w.y + w.z <= 1.0 + tolerance)
          {
            covered[(vtkIdType(z) * size[1] + y) * size[0] + x] = 1;
          }
        }
      }
    }
  }
  Count result;
  vtkDataArray* values = volume->GetPointData()->GetScalars();
  for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i)
  {
    const bool body = values->GetComponent(i, 0) >= isovalue;
    result.Body += body;
    result.Outside += body && !covered[i];
  }
  return result;
}

} // namespace bodyChecks

#endif
