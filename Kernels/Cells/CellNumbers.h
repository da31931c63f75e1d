// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeCellNumbers_h
#define DeformVolumeCellNumbers_h

#include "DeformVolumeExport.h"

#include <string>

namespace deformvolume
{

/// The numbers of three-dimensional cells, which are VTK's (vtkCellType.h); and the order of the
/// points of these is VTK's as well.
namespace cellNumbers
{
/// Types of cells.
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

/// The name of any type of cells of VTK, such as "quadratic hexahedron".
DEFORMVOLUME_EXPORT std::string GetCellName(int type);

} // namespace deformvolume

#endif
