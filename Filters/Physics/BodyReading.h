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
/// Names of the cell arrays with the material of each tetrahedron.
constexpr const char* YoungModulusName = "YoungModulus";
constexpr const char* PoissonRatioName = "PoissonRatio";
constexpr const char* DensityName = "Density";
///@}

///@{
/// Names of the point arrays with boundary conditions and forces of nodes.
constexpr const char* FixedName = "Fixed";
constexpr const char* ForceName = "Force";
constexpr const char* PrescribedDisplacementName = "PrescribedDisplacement";
constexpr const char* SlidingNormalName = "SlidingNormal";
constexpr const char* SecondSlidingNormalName = "SecondSlidingNormal";
///@}

/// The tetrahedra of a grid, and the index of the cell of each tetrahedron.
struct GridTetrahedra
{
  std::vector<Tetrahedron> Tetrahedra;
  /// Mid-side nodes of each tetrahedron, -1 if the cell has none; empty if takesQuadratic was
  /// false.
  std::vector<MidSideNodes> MidSides;
  std::vector<vtkIdType> Cells;
};

/// Reads the tetrahedra of a grid. Cells of fewer than three dimensions are ignored. Throws an
/// Error for other cells, and for tetrahedra with a wrong number of points or with points that do
/// not exist. takesQuadratic: whether vtkQuadraticTetra is accepted.
GridTetrahedra ReadTetrahedra(vtkUnstructuredGrid* grid, bool takesQuadratic);

/// Settings for reading a body.
struct BodySettings
{
  /// Material of tetrahedra without cell arrays of materials.
  ElasticMaterial Material;
  /// Length of a unit of the mesh in meters.
  double UnitLength = 1.0;
  /// Whether the body has ten-node tetrahedra. Linear cells then get mid-side nodes.
  bool IsQuadratic = false;
};

/// An elastic body that was read from a grid.
struct BodyMesh
{
  ElasticBody Body;               // its first nodes are the points of the grid
  std::vector<glm::dvec3> Forces; // of nodes, in N; empty: none
  /// Prescribed displacements of nodes, in m. Only those of fixed nodes are used. Empty: none.
  std::vector<glm::dvec3> PrescribedDisplacements;
  /// The ends of the edge of each mid-side node that is not a point of the grid.
  std::vector<std::array<std::int32_t, 2>> MidSideEnds;
  /// Whether all nodes of the tetrahedra are points of the grid.
  bool HasNodesOfCells = true;
  /// The index of the cell of each tetrahedron.
  std::vector<vtkIdType> Cells;
  std::vector<unsigned char> IsUsed; // whether a tetrahedron uses the node
  double Size = 0.0;                 // diagonal of the bounding box, in m
};

/// Differs if ReadBody() may give another result.
Stamp GetBodyStamp(vtkUnstructuredGrid* grid);

/// Reads the tetrahedra of a grid, and the cell and point arrays with the names above, if they
/// exist. Cells of fewer than three dimensions are ignored. Throws an Error for other cells, for
/// arrays of another shape, for boundary conditions that mass-spring dynamics does not support if
/// the body is not quadratic, and for bodies that CheckBody() rejects.
///
/// Forces at corners are passed on to mid-side nodes as in AddMidSideNodes(). A mid-side node that
/// is added here is fixed if both ends of its edge are fixed, with the mean of their prescribed
/// displacements. It slides in the plane of an end if the edge lies in this plane, and the other
/// end is fixed or slides in the same plane.
BodyMesh ReadBody(vtkUnstructuredGrid* grid, const BodySettings& settings);

/// Name of the point array of handles with the node that each one holds.
constexpr const char* HeldNodeName = "HeldNode";

/// Finds the nodes that handles hold, and their displacements. A handle holds the node that the
/// array HeldNodeName names. Without the array, or if the number is negative, it holds the nodes of
/// tetrahedra within a radius of its rest position. If none of these can move, it holds those of
/// the tetrahedron that contains the position. If the radius is 0, it holds the nearest node.
/// Lengths are in units of the mesh. If several handles hold a node, the first one is used. Fixed
/// nodes cannot be held. Throws an Error if the array names a node that cannot be held, or if a
/// handle without such a number holds no node.
std::vector<HeldNode> ReadHandles(
  vtkPointSet* handles, double radius, const BodyMesh& mesh, const BodySettings& settings);

} // namespace deformvolume

#endif
