// SPDX-License-Identifier: BSD-3-Clause
#ifndef DeformVolumeBodyReading_h
#define DeformVolumeBodyReading_h

#include "ElasticBody.h"
#include "MidSideNodes.h"
#include "Stamp.h"

#include "vtkType.h"

#include <array>
#include <cstddef>
#include <cstdint>
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

///@{
/// Point arrays with what acts on nodes.
constexpr const char* FixedName = "Fixed";
constexpr const char* ForceName = "Force";
constexpr const char* PrescribedDisplacementName = "PrescribedDisplacement";
constexpr const char* SlidingNormalName = "SlidingNormal";
constexpr const char* SecondSlidingNormalName = "SecondSlidingNormal";
///@}

/// The tetrahedra of a grid, and the cell that each of them is.
struct GridTetrahedra
{
  std::vector<Tetrahedron> Tetrahedra;
  /// Of each tetrahedron, -1 where the cell has none; empty where ten-node tetrahedra are errors.
  std::vector<MidSideNodes> MidSides;
  std::vector<vtkIdType> Cells;
};

/// Cells of fewer than three dimensions are left out. Throws an Error for other cells, and for
/// tetrahedra without four points of the grid. takesQuadratic: vtkQuadraticTetra is no error.
GridTetrahedra ReadTetrahedra(vtkUnstructuredGrid* grid, bool takesQuadratic);

/// What says how a body is read.
struct BodySettings
{
  /// Of tetrahedra that have none in cell arrays.
  ElasticMaterial Material;
  /// Metres of a unit of the mesh.
  double UnitLength = 1.0;
  /// Whether the body is one of ten-node tetrahedra: linear cells get mid-side nodes.
  bool IsQuadratic = false;
};

/// An elastic body as VTK has it.
struct BodyMesh
{
  ElasticBody Body;               // its first nodes are the points of the grid
  std::vector<glm::dvec3> Forces; // of nodes, in N; empty: none
  /// Of nodes, in m, which only those that are fixed have; empty: none.
  std::vector<glm::dvec3> PrescribedDisplacements;
  /// Of each mid-side node behind the points of the grid the ends of its edge.
  std::vector<std::array<std::int32_t, 2>> MidSideEnds;
  /// Whether the tetrahedra have the nodes of their cells, and no others.
  bool HasNodesOfCells = true;
  /// The cell that each tetrahedron is.
  std::vector<vtkIdType> Cells;
  std::vector<unsigned char> IsUsed; // nodes: by a tetrahedron
  double Size = 0.0;                 // of the diagonal of its box, in m
};

/// What ReadBody depends on.
Stamp GetBodyStamp(vtkUnstructuredGrid* grid);

/// The tetrahedra of a grid, with the cell and point arrays that are named above, where there are
/// such. Cells of fewer than three dimensions are left out. Throws an Error for other cells, arrays
/// of another shape, what springs cannot do where the body is not quadratic, and what CheckBody
/// refuses.
///
/// A mid-side node that is made here has no force, is fixed where both ends of its edge are, with
/// the mean of their displacements, and slides where its edge lies in the plane in which an end
/// slides while the other one is fixed or slides in the same plane.
BodyMesh ReadBody(vtkUnstructuredGrid* grid, const BodySettings& settings);

/// Which nodes of tetrahedra handles hold, and where: those within a radius of the rest position of
/// a handle, or the nearest one where the radius is 0. Lengths are those of the mesh. The first
/// handle counts where several hold a node; fixed nodes stay. Throws an Error where a handle holds
/// no node.
std::vector<HeldNode> ReadHandles(
  vtkPointSet* handles, double radius, const BodyMesh& mesh, const BodySettings& settings);

} // namespace deformvolume

#endif
