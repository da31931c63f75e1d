// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellNumbers_h
#define DeformVolumeCellNumbers_h

#include "DeformVolumeExport.h"

#include <string>

namespace deformvolume
{

/// The numbers of three-dimensional cell types. The numbers and the order of the points of cells
/// are those of VTK (vtkCellType.h).
namespace cellNumbers
{
/// Cell types.
enum Types : int
{
  Tetrahedron = 10,
  Voxel = 11,
  Hexahedron = 12,
  Wedge = 13,
  Pyramid = 14,
  PentagonalPrism = 15,
  HexagonalPrism = 16,
  QuadraticTetrahedron = 24,
  QuadraticHexahedron = 25,
  QuadraticWedge = 26,
  QuadraticPyramid = 27,
  TriQuadraticHexahedron = 29,
  QuadraticLinearWedge = 31,
  BiQuadraticQuadraticWedge = 32,
  BiQuadraticQuadraticHexahedron = 33,
  TriQuadraticPyramid = 37,
  Polyhedron = 42,
  LagrangeTetrahedron = 71,
  LagrangeHexahedron = 72,
  LagrangeWedge = 73,
  BezierTetrahedron = 78,
  BezierHexahedron = 79,
  BezierWedge = 80,
  BezierPyramid = 81
};
} // namespace cellNumbers

/// Returns the name of a cell type of VTK, such as "quadratic hexahedron".
DEFORMVOLUME_EXPORT std::string GetCellName(int type);

} // namespace deformvolume

#endif
