// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBodyReading_h
#define DeformVolumeBodyReading_h

#include "DeformationMesh.h" // for Stamp
#include "ElasticBody.h"

#include "vtkType.h"

#include <vector>

class vtkPointSet;
class vtkUnstructuredGrid;

namespace deformvolume
{

///@{
/// Cell arrays with the material of each tetrahedron.
constexpr const char* YoungModulusName = "YoungModulus";
constexpr const char* PoissonRatioName = "PoissonRatio";
constexpr const char* DensityName = "Density";
///@}

/// The tetrahedra of a grid, and the cell that each of them is.
struct GridTetrahedra
{
  std::vector<Tetrahedron> Tetrahedra;
  std::vector<vtkIdType> Cells;
};

/// Cells of fewer than three dimensions are left out. Throws an Error for other cells, and for
/// tetrahedra without four points of the grid.
GridTetrahedra ReadTetrahedra(vtkUnstructuredGrid* grid);

/// What says how a body is read.
struct BodySettings
{
  /// Of tetrahedra that cell arrays tell nothing of.
  ElasticMaterial Material;
  /// Metres of a unit of the mesh.
  double UnitLength = 1.0;
};

/// An elastic body as VTK has it.
struct BodyMesh
{
  ElasticBody Body;
  std::vector<glm::dvec3> Forces; // of nodes, in N; empty: none
  /// The cell that each tetrahedron is.
  std::vector<vtkIdType> Cells;
  std::vector<unsigned char> IsUsed; // nodes: by a tetrahedron
  double Size = 0.0;                 // of the diagonal of its box, in m
};

/// What ReadBody depends on.
Stamp GetBodyStamp(vtkUnstructuredGrid* grid);

/// The tetrahedra of a grid, with the cell arrays YoungModulus, PoissonRatio and Density and the
/// point arrays Fixed and Force, where there are such. Cells of fewer than three dimensions are
/// left out. Throws an Error for other cells, arrays of another shape, and what CheckBody refuses.
BodyMesh ReadBody(vtkUnstructuredGrid* grid, const BodySettings& settings);

/// Which nodes of tetrahedra handles hold, and where: those within a radius of the rest position of
/// a handle, or the nearest one where the radius is 0. Lengths are those of the mesh. The first
/// handle counts where several hold a node; fixed nodes stay. Throws an Error where a handle holds
/// no node.
std::vector<HeldNode> ReadHandles(
  vtkPointSet* handles, double radius, const BodyMesh& mesh, const BodySettings& settings);

} // namespace deformvolume

#endif
